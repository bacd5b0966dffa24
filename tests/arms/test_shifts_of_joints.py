"""Shifts of the logs of an arm's joints: one logger writes all joints in one row."""

from __future__ import annotations

import numpy as np
import pytest
from arms.arm_simulator import random_arm, write_experiment

import teleopdesign as td
from teleopdesign.blocks import Value
from teleopdesign.diagnose.error import force_error
from teleopdesign.diagnose.parts import prepare_parts
from teleopdesign.diagnose.parts_fit import estimate_parts
from teleopdesign.effects import EFFECTS
from teleopdesign.model import Model

#: s between rows
ROW = 0.01


@pytest.mark.slow
def test_the_links_are_those_of_the_shift_that_is_held(tmp_path):
    """They were those of an estimated shift, and the held one left far more than it must."""
    generator = np.random.default_rng(5)
    experiment = td.load_experiment(
        write_experiment(tmp_path, random_arm(generator, 1), generator, seconds=1.5)
    )
    known = {n: EFFECTS[n] for n in ("coulomb", "viscous")}
    stated = Model.from_experiment(experiment, known)
    held = stated.with_record_shift({"joint1": Value(-0.8 * ROW, fixed=True)})
    prepared = prepare_parts(experiment)
    arm = estimate_parts({"joint1": held.with_links(prepared.initial)}, prepared)
    model, records = arm.fits["joint1"].model, prepared.parts["joint1"].of("fit")
    assert model.log_late("joint1") == pytest.approx(-0.8 * ROW)
    least = force_error(model, records)
    for k in range(len(arm.links)):
        for part in (-0.02, 0.02):
            links = [x * (1 + part * (i == k)) for i, x in enumerate(arm.links)]
            assert force_error(model.with_links(tuple(links)), records) > 0.999 * least


def rows_late(diagnosis):
    """Joint -> rows by which its log is late."""
    return {j: d.model.log_late(j) / ROW for j, d in diagnosis.joints.items()}


@pytest.mark.slow
def test_a_joint_that_its_reversals_mislead_has_the_shift_of_the_other(tmp_path):
    """Alone it says 0.67 +- 0.04 rows early, and leaves 1.24 noise floors."""
    generator = np.random.default_rng([260113, 30, 1])
    folder = write_experiment(tmp_path, random_arm(generator, 2), generator, late=-1.0)
    diagnosis = td.find_missing(td.load_experiment(folder), among=("actuator_lag",))
    assert diagnosis.verdict == "model_adequate"
    for rows in rows_late(diagnosis).values():
        assert rows == pytest.approx(-1.0, abs=0.15)
    assert diagnosis.joints["joint1"].left < 1.15
    assert "as at the other joints" in str(diagnosis)


@pytest.mark.slow
def test_a_joint_of_an_arm_whose_drive_is_late_is_adequate_with_its_shift(tmp_path):
    generator = np.random.default_rng([900, 1])
    late = np.array([0.5, 0.5, -0.5])
    folder = write_experiment(tmp_path, random_arm(generator, 3), generator, late=late)
    diagnosis = td.find_missing(td.load_experiment(folder), among=("actuator_lag",))
    assert diagnosis.verdict == "model_adequate"
    assert rows_late(diagnosis)["joint3"] == pytest.approx(-0.5, abs=0.15)
    assert rows_late(diagnosis)["joint1"] == pytest.approx(0.5, abs=0.15)
