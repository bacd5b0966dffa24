"""Diagnoses of shared measurements, simulated and real, against what is known of them."""

import pytest
from shared_data import shared_folder

from teleopdesign import find_missing, load_experiment

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
