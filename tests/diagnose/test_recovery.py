"""Plant an effect, diagnose, find it. Plant none, find none. Plant a look-alike, hear so."""

import numpy as np
import pytest
from cases import make_case, write_case
from diagnose.simulated_cases import FEW, truth_of, write_simulated

from teleopdesign import Model, find_missing, load_experiment
from teleopdesign.diagnose.noise_floor import noise_floor
from teleopdesign.effects import EFFECTS

pytestmark = pytest.mark.slow  # diagnoses of whole cases

CATALOGUE = ("coulomb", "viscous", "stribeck", "bias", "cogging")
LOOK_ALIKES = {"bias", "coulomb_asymmetry"}


def diagnosed(folder, known):
    experiment = load_experiment(folder)
    return find_missing(experiment, Model.from_experiment(experiment, known))


def first_named(diagnosis):
    """What the diagnosis names first: an effect, or the group that it cannot tell apart."""
    if diagnosis.groups and not diagnosis.missing:
        return {c.effect.name for c in diagnosis.groups[0]}
    return {diagnosis.missing[0].effect.name} if diagnosis.missing else set()


def test_a_planted_effect_is_detected(diagnosis, stribeck_case):
    check_diagnosis(diagnosis, stribeck_case, "stribeck")


def test_a_planted_effect_of_another_kind_is_detected(tmp_path):
    folder = write_simulated(tmp_path / "presliding", "presliding")
    check_diagnosis(diagnosed(folder, FEW), folder, "presliding")


def check_diagnosis(diagnosis, folder, effect):
    """The effect that this case hides is named, with its values, and explains what was left."""
    truth = truth_of(folder)
    assert effect in first_named(diagnosis)
    assert diagnosis.after.check_error < 0.5 * diagnosis.before.check_error
    # a true model reaches the reference but for what reversals cost along an encoder
    assert diagnosis.after.check_error < 1.6 * truth["check_error_true"]
    for name, value in truth["effects"][0]["parameters"].items():
        # the clear level leaves four floors without it: a tenth is a generous band
        fitted = diagnosis.model.parameters[f"device.{effect}.{name}"]
        assert fitted.value == pytest.approx(
            value["value"], rel=0.1 if effect != "presliding" else 0.2
        )


def test_where_nothing_is_missing_nothing_is_named(tmp_path):
    diagnosis = diagnosed(write_simulated(tmp_path / "null", None, seed=4), FEW)
    assert diagnosis.verdict == "model_adequate"
    assert not diagnosis.missing and not diagnosis.groups
    assert len(diagnosis.rungs) == 1


def test_one_of_two_look_alikes_is_undecided_between_them(tmp_path):
    diagnosis = diagnosed(write_simulated(tmp_path / "bias", "bias"), FEW)
    assert diagnosis.verdict == "undecided"
    assert {c.effect.name for c in diagnosis.groups[0]} == LOOK_ALIKES
    assert not diagnosis.missing


def test_two_effects_are_both_named_though_each_masks_the_other(tmp_path):
    """Among what resembles one of the two: a pair is tried with every candidate."""
    pair = "actuator_gain+load_dependent_friction"
    alike = ("coulomb_asymmetry", "viscous_asymmetry", "quadratic_drag", "added_inertia")
    folder = write_simulated(tmp_path / pair, pair, seed=12, level="double")
    diagnosis = find_missing(load_experiment(folder), among=(*pair.split("+"), *alike))
    assert {c.effect.name for c in diagnosis.missing} == set(pair.split("+"))


def test_a_parameter_led_astray_does_not_make_what_is_missing_pass_for_noise(tmp_path):
    # without cogging and without the largest force as limit, this machine's Stribeck level goes to
    # 100 kN within 0.1 mm/s, where sensor noise would ask for five times the measured force
    case = make_case(np.random.default_rng([59183, 138]), "clear", ["cogging"])
    write_case(case, tmp_path / "case")
    diagnosis = diagnosed(tmp_path / "case", {n: EFFECTS[n] for n in CATALOGUE})
    alone = noise_floor(diagnosis.before.model, diagnosis.prepared, np.random.default_rng(0))
    assert alone.value < 0.02
    assert [str(c) for c in diagnosis.missing] == ["cogging at device"]
    assert diagnosis.floor.value < 0.02


# the fit does not lean on the user's numbers


def test_starting_values_off_by_a_fifth_lead_to_the_same_fit(experiment, diagnosis):
    from teleopdesign import fit

    model = Model.from_experiment(experiment)
    off = fit(
        model.with_values({n: 0.8 * v.value for n, v in model.parameters.items()}), experiment
    )
    for name, value in diagnosis.before.model.parameters.items():
        # a tenth of what the record tells the parameter to
        assert off.parameters[name].value == pytest.approx(value.value, abs=0.1 * value.stderr)


def test_a_fit_alone_gives_what_a_diagnosis_that_adds_nothing_gives(experiment):
    from teleopdesign import fit

    known = {name: EFFECTS[name] for name in ("coulomb", "viscous", "stribeck")}
    stated = Model.from_experiment(experiment, known).with_effect("stribeck", at="device")
    diagnosed = find_missing(experiment, stated)
    assert diagnosed.missing == () and diagnosed.verdict == "model_adequate"
    alone = fit(stated, experiment)
    # value and standard error of each, to the last digit: the same steps on the same draws
    assert alone.parameters == diagnosed.model.parameters
    assert alone.parameters != diagnosed.estimated.parameters
