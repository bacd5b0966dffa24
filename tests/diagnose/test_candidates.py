"""Which effects are tried, where their search starts, and what a bound means."""

import shutil
from dataclasses import replace

import numpy as np
import pytest
from diagnose.made_records import write_made

from teleopdesign import Model, load_experiment
from teleopdesign.base.errors import ExperimentError
from teleopdesign.diagnose.candidates import (
    Candidate,
    bodies_with_measured_force,
    candidates,
    make_starts,
)
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.identifiability import is_identifiable
from teleopdesign.diagnose.rank import rank_candidates
from teleopdesign.effects import CONTACT_ROLES, EFFECTS, catalogue
from teleopdesign.measurement.bandwidth import scales
from teleopdesign.measurement.prepare import prepare
from teleopdesign.measurement.saving import write_experiment


@pytest.fixture(scope="module")
def model(experiment):
    return Model.from_experiment(experiment)


@pytest.fixture(scope="module")
def prepared(experiment):
    return prepare(experiment)


def names(model):
    return {c.effect.name for c in candidates(model)}


def test_an_effect_that_needs_another_waits_for_it(model):
    bare = model.without_effect("coulomb")
    needing = {n for n, e in EFFECTS.items() if "coulomb" in e.needs}
    assert needing
    assert needing.isdisjoint(names(bare))
    assert "coulomb" in names(bare)


LATE = '''"""Acts late, and weaker the more is asked for."""
from sympy import tanh
from teleopdesign.effects import Effect, Parameter

def law(now, p):
    return p.limit * tanh(now.command / p.limit)

EFFECT = Effect(
    role="actuation", law=law, absent={"limit": float("inf")},
    parameters={"limit": Parameter("force", "F")},
)
'''


def test_no_limit_lag_or_delay_is_sought_in_a_force_that_was_measured(model, tmp_path):
    """Nor a user's own: only the scale of what was measured may be wrong."""
    path = tmp_path / "soft_limit.py"
    path.write_text(LATE)
    model = replace(model, known=catalogue([path]))
    measured = {c.effect.name for c in candidates(model, measured={"device"})}
    stages = {n for n, e in model.known.items() if e.role == "actuation"}
    scales_only = {"actuator_gain", "position_dependent_gain", "torque_ripple"}
    assert stages - measured == stages - scales_only and "soft_limit" in stages - measured
    assert names(model) - measured == stages - scales_only


def test_a_channel_says_that_its_force_was_measured(experiment, tmp_path):
    shutil.copytree(experiment.folder, tmp_path / "case")
    path = tmp_path / "case" / "experiment.toml"
    lines = path.read_text().splitlines()
    (n,) = (i for i, line in enumerate(lines) if line.startswith("actuator_force"))
    lines[n] = lines[n].replace("{", "{ measured = true,", 1)
    path.write_text("\n".join(lines))
    read = load_experiment(path.parent)
    assert (
        bodies_with_measured_force(read) == {"device"}
        and bodies_with_measured_force(experiment) == set()
    )
    saved = write_experiment(read, tmp_path / "saved")
    assert bodies_with_measured_force(load_experiment(saved)) == {"device"}
    path.write_text(path.read_text().replace("measured = true", 'measured = "yes"'))
    with pytest.raises(ExperimentError, match="measured.*expected true or false"):
        load_experiment(path.parent)


def needs_of(name):
    """What an effect needs, and what that needs, in the order in which it can be added."""
    needs = sorted(EFFECTS[name].needs)
    return list(dict.fromkeys([*(n for need in needs for n in needs_of(need)), *needs]))


@pytest.mark.parametrize("slower", [1.0, 1e4], ids=["as recorded", "in a band 10^4 times narrower"])
@pytest.mark.parametrize(
    "name", sorted(n for n, e in EFFECTS.items() if e.role not in CONTACT_ROLES)
)
def test_a_search_starts_within_bounds_at_every_combination(name, slower, model, prepared):
    effect = EFFECTS[name]
    base = model
    for other in ("coulomb", "viscous"):
        base = base.without_effect(other)
    for need in needs_of(name):
        base = base.with_effect(need, values=dict.fromkeys(EFFECTS[need].parameters, 1.0))
    unit = scales([s.motion for s in prepared.of("fit")], prepared.bandwidth / slower)
    starts = make_starts(base.with_effect(name), unit)
    if slower == 1.0:
        every = [len(p.search.starts) for p in effect.parameters.values()]
        assert len(starts) >= np.prod(every)
    for start in starts:
        values = start.body("device").parameters
        for parameter, declared in effect.parameters.items():
            value = values[f"{name}.{parameter}"].value
            assert np.isfinite(value)
            assert declared.lower <= value <= declared.upper


def test_the_period_of_teeth_is_known_however_many_turns_a_rotor_makes(tmp_path):
    """36 teeth over 5 turns are 180 cycles over the travel: more than its parts that are tried."""

    def there_and_back(t):
        return 10.0 * np.pi * np.sin(2 * np.pi * 0.03 * t) ** 2 + 0.5 * np.sin(2 * np.pi * 0.4 * t)

    def needed(t, x, v):
        return 0.2 * np.sign(v) + 0.05 * v + 0.1 * np.sin(36 * x + 1.0)

    records = {"fit": [(20.0, there_and_back)], "check": [(15.0, there_and_back)]}
    believed = "coulomb = {}\nviscous = {}"
    write_made(
        tmp_path, records, needed, effects=believed, step=1e-4, noise=0.01, bandwidth=30, rate=200
    )
    experiment = load_experiment(tmp_path)
    prepared = prepare(experiment)
    base = estimate(Model.from_experiment(experiment), prepared)
    (one,) = rank_candidates(base, prepared, among=[Candidate(EFFECTS["cogging"], "device")]).ranked
    assert one.fit.check_error < 0.3 * base.check_error
    period = one.fit.model.parameters["device.cogging.period"].value
    assert period == pytest.approx(2 * np.pi / 36, rel=1e-3)


def test_an_effect_that_is_not_there_ends_at_its_bound_and_says_so(model, prepared):
    """A friction that only ever helps the motion cannot be: its level ends at zero."""
    truth = estimate(model, prepared)
    reversed_force = [
        replace(s, motion=replace(s.motion, direction=-s.motion.direction))
        for s in prepared.stretches
    ]
    fit = estimate(
        truth.model.without_effect("viscous"), replace(prepared, stretches=tuple(reversed_force))
    )
    assert fit.at_bound == ("device.coulomb.level",)
    assert fit.model.parameters["device.coulomb.level"].value == pytest.approx(0.0, abs=1e-6)


def test_where_a_body_only_goes_on_what_does_not_repeat_is_no_candidate(model, prepared):
    there_and_back = [s.motion for s in prepared.of("fit")]
    onward = [replace(m, position=np.linspace(0.0, 1.0, len(m.time))) for m in there_and_back]
    of_place = {"spring", "hardening_spring"}
    names = {c.effect.name for c in candidates(replace(model, known=EFFECTS), there_and_back)}
    assert of_place <= names
    left = {c.effect.name for c in candidates(replace(model, known=EFFECTS), onward)}
    assert not of_place & left
    # what repeats comes back to the same place of its period; stretch does not depend on the place
    assert {"quadratic_drag", "cogging", "torque_ripple", "transmission_compliance"} <= left


def test_inertia_beside_a_free_inertia_cannot_be_determined(model, prepared):
    base = estimate(model, prepared)
    twice = estimate(base.model.with_effect("added_inertia", values={"inertia": 1e-4}), prepared)
    assert not is_identifiable(twice, base)
    absent = estimate(base.model.with_effect("spring", values={"stiffness": 1e-4}), prepared)
    assert not is_identifiable(absent, base), "no spring is there: its stiffness is not determined"
    less = estimate(base.model.without_effect("coulomb"), prepared)
    whole = estimate(less.model.with_effect("coulomb", values={"level": 0.1}), prepared)
    assert is_identifiable(whole, less)


def test_without_check_records_blocks_are_held_out(experiment, model):
    only = prepare(replace(experiment, records=experiment.fit_records))
    fit = estimate(model, only)
    assert np.isfinite(fit.check_error)
    # blocks that a fit has not seen are fitted a little worse than those it has
    assert fit.fit_error < fit.check_error < 1.5 * fit.fit_error
    assert len(fit.check_residual) == len(fit.check_blocks) == len(fit.fit_residual)
