"""Diagnoses of shared measurements, simulated and real, against what is known of them."""

import json

import pytest
from shared_data import shared_folder

from teleopdesign import Model, find_missing, load_experiment
from teleopdesign.diagnose.fit import estimate
from teleopdesign.measurement.prepare import prepare


def one_body_cases():
    """(folder, truth) of every shared case with one body."""
    cases = shared_folder("hidden/cases")
    truths = (json.loads(p.read_text()) for p in sorted((cases.parent / "truth").glob("*.json")))
    return [(cases / t["case"], t) for t in truths if t["kind"] == "device"]


@pytest.mark.slow
def test_the_models_re_estimated_error_is_that_of_the_reference():
    """Within 5 %: the reference knows the true motion, the diagnosis an encoder's.

    The diagnosis finds a shift of the logger as well, which takes up a part of what is missing:
    all of a row of a delay or a lag, some of a force that the controller's own resembles.
    """
    far = {}
    for folder, truth in one_body_cases():
        experiment = load_experiment(folder)
        fit = estimate(Model.from_experiment(experiment), prepare(experiment)).check_error
        ratio = fit / truth["check_error_base"]
        late = {e["effect"] for e in truth["effects"]} & {"actuation_delay", "actuator_lag"}
        least = 0.0 if late else 0.9
        if truth["level"] in ("clear", "weak") and not least < ratio < 1.05:
            far[truth["case"]] = ratio
    assert not far


#: of friction and of a drive: long records are searched for these alone
DRIVE = (
    "stribeck", "presliding", "shear_thinning", "coulomb_asymmetry", "load_dependent_friction",
    "actuator_saturation", "actuator_lag",
)  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "among", "documented", "excluded"),
    [
        # friction at rest is well above sliding friction; the drive reports more than any limit
        ("dm8009", DRIVE, {"stribeck"}, {"actuator_saturation", "actuator_lag"}),
        # friction flattens with speed; one sine, whose places are passed at one speed each
        (
            "ur10e_joint1",
            (*DRIVE, "position_dependent_friction"),
            {"shear_thinning"},
            {"actuator_saturation", "position_dependent_friction"},
        ),
    ],
    ids=["dm8009", "ur10e_joint1"],
)
def test_a_real_recording_has_the_names_that_its_authors_give(name, among, documented, excluded):
    diagnosis = find_missing(load_experiment(shared_folder("data") / name), among=among)
    named = {c.effect.name for c in diagnosis.missing}
    listed = {c.effect.name for group in diagnosis.groups for c in group}
    assert documented <= named | listed
    assert not excluded & (named | {r.added.effect.name for r in diagnosis.rungs if r.added})
    errors = [r.check_error for r in diagnosis.rungs]
    assert errors == sorted(errors, reverse=True)
