"""Effects beside those that they are mistaken for: the right one is named, and none where none is.

The machines come from the truth simulator, which shares no law with the package.
"""

import pytest
from diagnose.simulated_cases import truth_of, write_simulated
from effects.recorded import write_recorded

from teleopdesign import Model, find_missing, load_experiment
from teleopdesign.effects import EFFECTS

#: effect -> those that it is mistaken for
MISTAKEN_FOR = {
    "shear_thinning": ("quadratic_drag", "stribeck", "actuator_saturation", "actuator_gain"),
    "maxwell_slip": ("presliding", "stribeck", "actuation_delay", "spring"),
    "gravity": ("bias", "spring", "cogging", "coulomb_asymmetry"),
}


def diagnosed(folder, effect):
    """The diagnosis among an effect, its look-alikes and what they need."""
    names = {"coulomb", "viscous", effect, *MISTAKEN_FOR[effect]}
    names |= {n for name in names for n in EFFECTS[name].needs}
    known = {n: EFFECTS[n] for n in EFFECTS if n in names}
    experiment = load_experiment(folder)
    return find_missing(experiment, Model.from_experiment(experiment, known))


@pytest.mark.slow
@pytest.mark.parametrize("effect", MISTAKEN_FOR)
def test_a_planted_effect_is_distinguished_from_those_that_it_is_mistaken_for(effect, tmp_path):
    folder = write_simulated(tmp_path / effect, effect)
    diagnosis = diagnosed(folder, effect)
    named = {c.effect.name for c in diagnosis.missing}
    alike = [{e["effect"] for e in group} for group in truth_of(folder)["indistinguishable"]]
    assert named == {effect} or (not named and any(effect in group for group in alike))


GEAR = {"has_tip": 1.0, "tip_inertia": 0.06, "tip_stiffness": 800.0, "tip_damping": 1.0}
RUBBING = {"level": 0.2, "damping": 0.5}
BELIEVED = "coulomb = { level = 0.3 }\nviscous = { damping = 0.5 }\ntransmission_compliance = {}"


@pytest.mark.slow
@pytest.mark.parametrize("level", [0.3, 0.0])
def test_friction_of_a_tip_is_distinguished_from_that_of_the_body_and_from_presliding(
    level, tmp_path
):
    folder = write_recorded(tmp_path / "gear", BELIEVED, tip_level=level, **GEAR, **RUBBING)
    names = {"coulomb", "viscous", "transmission_compliance", "tip_friction", "presliding"}
    known = {n: e for n, e in EFFECTS.items() if n in names}
    experiment = load_experiment(folder)
    diagnosis = find_missing(experiment, Model.from_experiment(experiment, known))
    assert [c.effect.name for c in diagnosis.missing] == (["tip_friction"] if level else [])
    if level:
        fitted = diagnosis.model.parameters
        # five standard errors; measured: 0.29978 +- 0.00765
        assert fitted["device.tip_friction.level"].value == pytest.approx(level, rel=0.1)
        assert diagnosis.after.check_error < 0.02 * diagnosis.before.check_error
