"""What an effect's parameters must obey to deserve its name stands in its own file."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from teleopdesign import Model
from teleopdesign.base.errors import ModelError
from teleopdesign.diagnose.decision import is_supported
from teleopdesign.diagnose.fit import estimate
from teleopdesign.diagnose.noise_floor import NoiseFloor
from teleopdesign.diagnose.plausibility import implausible_effects, record_facts
from teleopdesign.diagnose.rank import rank_candidates
from teleopdesign.effects import EFFECTS, RecordFacts, load_effect
from teleopdesign.measurement.prepare import prepare

TIME = np.linspace(0.0, 3.0, 3000)
FACTS = RecordFacts(
    axis="revolute",
    travel=1.0,
    sweep=1.0,
    step=1e-4,
    stroke=0.5,
    force=3.0,
    acting=3.0,
    stuck=0.01,
    resolved=0.02,
    speed=np.pi,
    film=0.2 * np.pi,
    body={
        "inertia": 0.1,
        "coulomb.level": 0.5,
        "viscous.damping": 0.2,
        "transmission_compliance.stiffness": 10.0,
        "gravity.phase": 0.3,
    },
    # three turns of one sine about zero
    places=0.5 * np.sin(2 * np.pi * TIME),
    speeds=np.pi * np.cos(2 * np.pi * TIME),
)
ELEMENTS = {"level_2": 0.1, "level_3": 0.1, "level_4": 0.0, "stiffness_3": 3e6, "stiffness_4": 1.0}
#: effect -> (parameters that deserve its name, those that do not, what these stand for)
MISFITS = {
    "stribeck": (
        {"extra_static_level": 0.2, "stribeck_velocity": 0.1},
        {"extra_static_level": 0.2, "stribeck_velocity": 0.001},
        "an error in the time of the force",
    ),
    "cogging": ({"period": 0.6}, {"period": 0.8}, "gravity"),
    "torque_ripple": ({"period": 0.6}, {"period": 3.0}, "friction that varies"),
    "presliding": ({"stiffness": 50.0}, {"stiffness": 0.03}, "a spring"),
    "friction_drift": (
        {"fraction": 0.5, "time_constant": 5.0},
        {"fraction": 0.5, "time_constant": 0.2},
        "the beginning of the records",
    ),
    "viscous_asymmetry": ({"half_difference": -0.1}, {"half_difference": 0.3}, "another force"),
    "coulomb_asymmetry": ({"half_difference": -0.1}, {"half_difference": -0.6}, "a constant force"),
    "transmission_compliance": (
        {"tip_inertia": 0.05, "stiffness": 10.0, "damping": 0.1},
        {"tip_inertia": 0.2, "stiffness": 10.0, "damping": 0.1},
        "lags behind",
    ),
    "backlash": (
        {"tip_inertia": 0.05, "stiffness": 10.0, "gap": 0.1},
        {"tip_inertia": 0.2, "stiffness": 10.0, "gap": 0.1},
        "lags behind",
    ),
    "maxwell_slip": (
        {**ELEMENTS, "stiffness_1": 50.0, "stiffness_2": 9.0},
        {**ELEMENTS, "stiffness_1": 3e6, "stiffness_2": 3e6},
        "sgn friction",
    ),
    "shear_thinning": (
        {"drag": 1.0, "exponent": 0.5},
        {"drag": 9.0, "exponent": 0.5},
        "a constant force",
    ),
    "smoothed_coulomb": (
        {"smoothing_velocity": 0.3},
        {"smoothing_velocity": 9.0},
        "a viscous friction",
    ),
    "stops": (
        {"lower": -0.3, "upper": 0.4},
        {"lower": -0.8, "upper": 0.9},
        "no motion reaches either end",
    ),
    "hardening_spring": ({"neutral": 0.1}, {"neutral": -2.0}, "a spring and a constant force"),
    "gravity": ({"amplitude": 2.0, "phase": 0.0}, {"amplitude": -40.0, "phase": 0.0}, "a spring"),
    "cogging_harmonic": ({"period": 0.5}, {"period": 2.0}, "varies slowly along the travel"),
    "position_dependent_gain": (
        {"fall": 0.1, "centre": 0.4},
        {"fall": 0.1, "centre": -7.0},
        "varies along the travel",
    ),
    "tip_friction": ({"level": 0.1}, {"level": 1e-5}, "friction of the actuator"),
    "viscous_temperature": ({"coefficient": 0.01}, {"coefficient": -0.01}, "a preload"),
    "position_dependent_friction": (
        {"period": 1.0, "phase": 0.0},
        {"period": 2.0, "phase": 0.5 * np.pi},
        "depends on the speed",
    ),
}


@pytest.mark.parametrize("name", sorted(MISFITS))
def test_parameters_that_do_not_fit_a_name_are_reported_with_what_they_stand_for(name):
    right, wrong, stands_for = MISFITS[name]
    plausible = EFFECTS[name].plausible
    assert plausible(SimpleNamespace(**right), FACTS) is None
    sentence = plausible(SimpleNamespace(**wrong), FACTS)
    assert stands_for in sentence and "\n" not in sentence


@pytest.mark.parametrize("name", sorted(n for n, e in EFFECTS.items() if e.plausible))
def test_every_check_answers_for_values_of_any_size(name):
    effect = EFFECTS[name]
    needed = {f"{n}.{p}": 0.3 for n in effect.needs for p in EFFECTS[n].parameters}
    facts = replace(FACTS, body={**FACTS.body, **needed})
    for size in (1e-12, 1e-3, 1.0, 1e6):
        for stroke in (0.5, float("inf")):
            p = SimpleNamespace(**dict.fromkeys(effect.parameters, size))
            sentence = effect.plausible(p, replace(facts, stroke=stroke))
            assert sentence is None or (isinstance(sentence, str) and sentence.strip())


#: effect -> (parameters that the records tell, those that they do not, what is known of these)
UNTOLD = {
    "stribeck": (
        {"extra_static_level": 1.0, "stribeck_velocity": 0.5},
        {"extra_static_level": 4.0, "stribeck_velocity": 0.04},
        "the fall from",
    ),
    "friction_drift": (
        {"fraction": 0.2, "time_constant": 10.0},
        {"fraction": 0.9, "time_constant": 200.0},
        "the rate d / tau = 0.0045 1/s",
    ),
    "gravity": (
        {"amplitude": 2.0, "phase": np.pi / 2},
        {"amplitude": 2.0, "phase": 0.1},
        "a spring and a constant force give this torque within",
    ),
    "position_dependent_friction": (
        {"amplitude": 0.5, "period": 1.0, "phase": 0.0},
        {"amplitude": 0.5, "period": 2.0, "phase": -0.2 * np.pi},
        "another load",
    ),
    "transmission_compliance": (
        {"tip_inertia": 0.02, "stiffness": 1000.0, "damping": 0.5},
        {"tip_inertia": 0.02, "stiffness": 2850.0, "damping": 0.5},
        "the tip rings at 60.1 Hz, close to the 60 Hz of the mains",
    ),
}


@pytest.mark.parametrize("name", sorted(UNTOLD))
def test_what_records_never_carried_is_undetermined(name):
    within, beyond, known = UNTOLD[name]
    effect, facts = EFFECTS[name], replace(FACTS, duration=60.0)
    assert effect.undetermined(SimpleNamespace(**within), facts) is None
    sentence = effect.undetermined(SimpleNamespace(**beyond), facts)
    assert known in sentence and "\n" not in sentence
    assert effect.plausible is None or effect.plausible(SimpleNamespace(**beyond), facts) is None


def test_every_effect_that_has_a_rule_on_undetermined_values_is_checked_on_both_sides():
    by_travel = {"spring"}  # not by its parameters: tests/effects/test_gravity.py
    always = {"actuator_gain", "actuation_delay"}  # an error of the log looks the same
    assert {n for n, e in EFFECTS.items() if e.undetermined} == set(UNTOLD) | by_travel | always
    for name in always:
        values = SimpleNamespace(gain=0.85, delay=3e-3)
        assert "looks the same" in EFFECTS[name].undetermined(values, FACTS)


def test_every_effect_with_a_check_is_tested_on_both_sides():
    assert {n for n, e in EFFECTS.items() if e.plausible} == set(MISFITS)


# in a diagnosis, a user's own effect among them

DAMPER = '''"""Own damper."""
from teleopdesign.effects import Effect, Parameter

def law(now, p):
    return p.damping * now.velocity

def plausible(p, facts):
    {body}

EFFECT = Effect(
    role="force", law=law, absent={{"damping": 0.0}}, plausible=plausible,
    parameters={{"damping": Parameter("damping", "B")}},
)
'''


def users_effect(tmp_path, name, body):
    path = tmp_path / f"{name}.py"
    path.write_text(DAMPER.format(body=body))
    return load_effect(path)


@pytest.fixture(scope="module")
def case(experiment):
    """The model without its friction, and the prepared records."""
    known = {"coulomb": EFFECTS["coulomb"], "viscous": EFFECTS["viscous"]}
    model = Model.from_experiment(experiment, known)
    return model.without_effect("coulomb").without_effect("viscous"), prepare(experiment)


@pytest.mark.parametrize("friction", ["viscous", "shear_thinning", "quadratic_drag"])
def test_the_friction_of_speed_is_that_of_every_law_of_speed(case, friction):
    model, prepared = case
    values = dict.fromkeys(EFFECTS[friction].parameters, 0.5)
    body = model.with_effect(EFFECTS[friction], values=values)
    facts = record_facts(body, "device", prepared)
    law = EFFECTS[friction].expression({"velocity": facts.speed}, values)
    assert facts.speed > 0.0 and facts.film == pytest.approx(float(law))
    # a force of the position, or a dry level, is none
    other = body.with_effect(EFFECTS["spring"], values={"stiffness": 3.0})
    other = other.with_effect(EFFECTS["coulomb"])
    assert record_facts(other, "device", prepared).film == facts.film


def test_an_effect_that_its_file_calls_implausible_is_not_supported(case, tmp_path):
    model, prepared = case
    strict = users_effect(
        tmp_path, "strict_damper", 'return "a brake" if p.damping < facts.force else None'
    )
    # the same law, but what it says is far from what is found
    never = users_effect(
        tmp_path, "never", "return f\"{facts.text(p.damping, 'damping')} is a brake\""
    )
    base = estimate(replace(model, known={strict.name: strict, never.name: never}), prepared)
    ranking = rank_candidates(base, prepared)
    floor = NoiseFloor(0.0, "", 0.0)
    by_name = {r.candidate.effect.name: r for r in ranking.ranked}
    refused = by_name["never"]
    assert refused.implausible.endswith("N*m*s/rad is a brake") and not refused.counts
    assert not is_supported(base, refused, floor)
    assert refused.note == refused.implausible
    believed = by_name["strict_damper"]
    assert believed.fit.check_error == pytest.approx(refused.fit.check_error, rel=1e-3)


def test_a_check_that_fails_is_an_error_of_its_file(case, tmp_path):
    model, prepared = case
    for body, words in (("return 1 / 0", "ZeroDivisionError"), ("return False", "None or a")):
        broken = users_effect(tmp_path, f"broken_{words[:4].strip()}", body)
        fitted = replace(model, known={broken.name: broken})
        fitted = fitted.with_effect(broken, values={"damping": 0.1})
        with pytest.raises(ModelError, match=words):
            implausible_effects(fitted, prepared)
