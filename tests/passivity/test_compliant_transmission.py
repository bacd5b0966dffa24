"""Compensation at the motor, with friction also behind a compliant transmission."""

import math

import numpy as np
import pytest

from teleopdesign.passivity import (
    free_motion,
    free_motion_margin,
)
from teleopdesign.passivity.rate_independent import (
    Coulomb,
    Cycle,
    Dahl,
    Spring,
)

JOINT = {"motor_level": 1.0, "link_level": 2.0, "transmission_stiffness": 1e4}


def test_the_cables_stiffness_limits_that_of_the_compensator():
    """sigma_D <= k sqrt(3 f_1 f_D)/f_2 is always enough, since 1 - tanh(u)/u <= u^2/3."""
    for level in (1.2, 2.0, 3.0):
        enough = 1e4 * math.sqrt(3 * 1.0 * level) / 2.0
        assert (
            free_motion_margin(**JOINT, compensator_level=level, compensator_stiffness=enough) >= 0
        )


def test_steps_at_reversals_take_energy_out_where_plain_cycles_take_none():
    """f_D = sigma_D = f_2 = 1, k = 2, f_1 = 1/12 lies within the condition of plain cycles."""
    joint = {"motor_level": 1 / 12, "link_level": 1.0, "transmission_stiffness": 2.0}
    values = {**joint, "compensator_level": 1.0, "compensator_stiffness": 1.0}
    assert free_motion_margin(**values) > 0
    claim = free_motion(**values, rng=np.random.default_rng(1), paths=10)
    assert claim.status == "refuted"
    assert claim.record.replay() == pytest.approx(claim.record.energy, rel=1e-12)
    # with the link stuck: out on the way to the limit cycle's distance, exactly 0.0166 J at a = 0.5
    friction = (Coulomb(1 / 12), Spring(1.0, 2.0))
    points = (0.5, 0.4, 0.5, -0.5, -0.4, -0.5)
    assert Cycle(Dahl(1.0, 1.0), friction, points).energy == pytest.approx(0.0166, abs=5e-5)
