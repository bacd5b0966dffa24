"""An effect that makes the recorded force unpredictable has not explained this force."""

import numpy as np
import pytest
from diagnose.simulated_cases import write_simulated
from diagnose.unexplained_texture import CHEATS, HIDES_THE_HAND
from diagnose.unexplained_texture import write_slide as write
from truth_effects import PUBLIC

from teleopdesign import Model, load_experiment
from teleopdesign.blocks import Value
from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.criteria import CRITERIA
from teleopdesign.diagnose.decision import is_better, is_supported, refusal
from teleopdesign.diagnose.error import force_error, refer_to_command
from teleopdesign.diagnose.evidence import gain_at_command
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.noise_floor import noise_floor
from teleopdesign.diagnose.rank import rank_candidates
from teleopdesign.effects import EFFECTS
from teleopdesign.measurement.prepare import prepare

ACTUATION = {n: e for n, e in EFFECTS.items() if e.role == "actuation"}
FROM_ACTING = {"load_dependent_friction": EFFECTS["load_dependent_friction"]}


# records whose unexplained force no effect knows


@pytest.fixture(scope="module")
def slid(tmp_path_factory):
    """(prepared records, the fit of the model without any cheat, its noise floor)"""
    experiment = write(tmp_path_factory.mktemp("slid") / "slide")
    prepared = prepare(experiment)
    base = base_of(experiment, prepared, CHEATS)
    return prepared, base, noise_floor(base.model, prepared, np.random.default_rng(0))


def base_of(experiment, prepared, known):
    return estimate(Model.from_experiment(experiment, {**EFFECTS, **known}), prepared)


def lowest(base, effect, values, prepared):
    """The fit with an effect held at these values, everything else estimated again."""
    held = {n: Value(v, fixed=True) for n, v in values.items()}
    model = base.model.with_effect(effect, at="device")
    return estimate(
        model.with_values({f"device.{effect.name}.{n}": v for n, v in held.items()}), prepared
    )


#: values of the first parameter over all that it may be, other parameters at some value
SWEEPS = {
    "actuator_gain": ("gain", (1e-3, 0.03, 0.3, 0.9, 1.1, 3.0, 30.0), {}),
    "actuator_lag": ("time_constant", (1e-3, 0.02, 0.1, 0.2), {}),
    "actuation_delay": ("delay", (1e-3, 0.02, 0.1, 0.2), {}),
    "actuator_dead_zone": ("half_width", (0.01, 0.1, 0.3, 1.0, 3.0), {}),
    "actuator_saturation": ("limit", (0.01, 0.3, 0.8, 1.0, 1.1, 1.3, 1.6), {}),
    "position_dependent_gain": ("fall", (0.1, 1.0, 10.0, 100.0, 1e4), {"centre": 0.0}),
    "torque_ripple": ("amplitude", (0.1, 0.5, 1.0), {"period": 0.3, "phase": 0.0}),
    "load_dependent_friction": ("coefficient", (0.1, 0.5, 0.9, 0.999), {}),
    "soft_limit": ("limit", (0.01, 0.5, 1.0, 2.0), {}),
    "forgets_what_lasts": ("part", (0.3, 0.9, 1.0), {"time_constant": 3.0}),
    "takes_up_what_acts": ("part", (0.1, 0.5, 0.9, 1.0), {}),
    "feeds_back_late": ("part", (0.3, 0.9, 1.0), {"time_constant": 0.1}),
}


def test_every_actuation_of_the_catalogue_is_swept():
    assert set(ACTUATION) | set(FROM_ACTING) | set(CHEATS) == set(SWEEPS)


@pytest.mark.parametrize("name", SWEEPS)
def test_the_figure_that_counts_does_not_fall_by_a_force_that_is_thrown_away(name, slid):
    """Over the whole range of an effect that the machine has not: no better, or refused."""
    prepared, base, floor = slid
    effect = {**EFFECTS, **CHEATS}[name]
    first, values, others = SWEEPS[name]
    plain = []
    for value in values:
        error = lowest(base, effect, {first: value, **others}, prepared)
        plain.append(error.check_error)
        # a texture drawn anew is matched by chance to a few percent, as any model's is
        lower = gain_at_command(base, error) > 2 * CRITERIA.relative_improvement
        assert refusal(base, error) == "blind" or not lower, (value, error.at_command)
        assert not is_better(base, error, floor)
    if name in ("actuator_saturation", "soft_limit", "takes_up_what_acts"):
        assert min(plain) < 0.5 * base.check_error, "the plain error could be cheated"


@pytest.mark.slow
def test_no_effect_is_accepted_for_less_force(slid):
    prepared, base, floor = slid
    # a period is sought on 150 starts, and hides nothing
    quick = {n: e for n, e in EFFECTS.items() if "period" not in e.parameters}
    among = [Candidate(e, "device") for e in {**quick, **CHEATS}.values()]
    ranking = rank_candidates(base, prepared, among=among)
    assert len(ranking.ranked) > 20
    assert [str(r.candidate) for r in ranking.ranked if is_supported(base, r, floor)] == []
    # those that leave next to nothing are refused, and stand behind those that count
    cheats = [r for r in ranking.ranked if r.fit.check_error < 0.3 * base.check_error]
    assert len(cheats) >= 2 and all(r.refused for r in cheats)
    places = {r.candidate.key: i for i, r in enumerate(ranking.ranked)}
    counting = [places[r.candidate.key] for r in ranking.ranked if r.counts]
    assert min(places[r.candidate.key] for r in cheats) > max(counting, default=-1)


@pytest.mark.parametrize("name", HIDES_THE_HAND)
def test_what_keeps_the_hand_from_the_body_explains_nothing(name, tmp_path):
    experiment = write(tmp_path / "pushed", by_hand=True)
    prepared = prepare(experiment)
    base = base_of(experiment, prepared, HIDES_THE_HAND)
    check = prepared.of("check")
    left = {}
    for part in (0.0, 0.5, 0.999):
        model = base.model.with_effect(HIDES_THE_HAND[name], at="device", values={"part": part})
        less = {n: (1.0 - part) * base.model.parameters[n].value for n in base.free}
        hidden = model.with_values(less)
        left[part] = force_error(hidden, check), refer_to_command(hidden, check).error
    assert left[0.999][0] < 0.1 * left[0.0][0], "the plain error could be cheated"
    assert left[0.999][1] > 0.9 * left[0.0][1] and left[0.5][1] > 0.9 * left[0.0][1]


def test_friction_that_balances_the_hand_explains_nothing_though_the_body_rests_at_times(tmp_path):
    """All carried force taken as friction: nothing is left, and at rest friction holds anyway."""
    experiment = write(tmp_path / "pushed", by_hand=True, pauses=True)
    prepared = prepare(experiment)
    base = base_of(experiment, prepared, {})
    check = prepared.of("check")
    assert 0.2 < np.mean(np.concatenate([s.motion.direction == 0 for s in check])) < 0.8
    before = refer_to_command(base.model, check).error
    for part in (0.5, 0.999):
        model = base.model.with_effect(
            EFFECTS["load_dependent_friction"],
            at="device",
            values={"coefficient": part, "output_share": 1.0},
        )
        friction = ("device.coulomb.level", "device.viscous.damping")
        model = model.with_values(
            {n: (1.0 - part) * base.model.parameters[n].value for n in friction}
        )
        assert refer_to_command(model, check).error > 0.9 * before
    assert force_error(model, check) < 0.1 * before, "the plain error could be cheated"


# machines that have the effect


@pytest.mark.slow
# a gain that falls along the stroke has records of its own: test_along_the_stroke.py
@pytest.mark.parametrize("name", [n for n in (*ACTUATION, *FROM_ACTING) if n in PUBLIC])
def test_a_machine_that_has_the_effect_is_still_believed(name, tmp_path):
    experiment = load_experiment(write_simulated(tmp_path / name, name))
    prepared, model = prepare(experiment), Model.from_experiment(experiment)
    base = estimate(model, prepared)
    floor = noise_floor(base.model, prepared, np.random.default_rng(0))
    (ranked,) = rank_candidates(base, prepared, among=[Candidate(EFFECTS[name], "device")]).ranked
    assert not ranked.refused and is_supported(base, ranked, floor)
    assert ranked.fit.at_command.error < 0.5 * base.at_command.error
