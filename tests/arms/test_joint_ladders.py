"""What the ladder of an arm asks of an effect at a joint beyond what one body asks."""

import numpy as np
import pytest
from arms.arm_simulator import random_arm, write_experiment

import teleopdesign as td


@pytest.mark.slow
def test_a_log_that_is_early_by_a_row_makes_no_delay_beside_what_is_hidden(tmp_path):
    """The links had stood for a spring that took nine tenths of the force of its joint."""
    generator = np.random.default_rng([77, 3, 1])
    arm = random_arm(generator, 2)
    folder = write_experiment(tmp_path, arm, generator, ("spring", 1, 1.35), late=-1.0)
    among = ("spring", "actuation_delay", "actuator_lag")
    diagnosis = td.find_missing(td.load_experiment(folder), among=among)
    assert {c.key for c in diagnosis.missing} == {("spring", "joint2")}
    (late,) = (v.value for v in diagnosis.joints["joint2"].model.record_shift.values())
    assert late == pytest.approx(-0.01, abs=0.002)  # a row; joint 1 hardly tells it
