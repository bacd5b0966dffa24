"""Sampled controllers: the condition of Colgate and Schenkel, exact, and the Z-width."""

import control
import numpy as np
import pytest
import sympy as sp

from teleopdesign.base.errors import ModelError
from teleopdesign.passivity import (
    read_record,
    required_damping,
    sampled_passivity,
    write_record,
    z_width,
)
from teleopdesign.passivity.theorems.sampled_data import Z

T, K, B = sp.Rational(1, 1000), 1000, sp.Rational(3, 10)
DIFFERENCE = (Z - 1) / (T * Z)

# law, spring of the body, least damping: Colgate and Schenkel 1997, and what follows from them
LIMITS = {
    "spring": (K, 0, K * T / 2),
    "spring and damper": (K + B * DIFFERENCE, 0, K * T / 2 + B),
    "spring and negative damper": (K - B * DIFFERENCE, 0, K * T / 2 + B),
    "negative damper": (-B * DIFFERENCE, 0, B),
    "spring one sample late": (K / Z, 0, 3 * K * T / 2),
    "compensator one sample late": (-500 / Z, 500, 500 * T / 2),
    "compensator two samples late": (-500 / Z**2, 500, sp.Rational(5, 8) * 500 * T),
}


@pytest.mark.parametrize("name", LIMITS)
def test_the_least_damping_is_met_exactly(name):
    """At the limit proved, equality included; 1 % of it less is refuted by a replayed motion."""
    law, spring, limit = LIMITS[name]
    assert required_damping(law, sample_time=T, stiffness=spring) == pytest.approx(float(limit))
    at = sampled_passivity(law, damping=limit, sample_time=T, stiffness=spring)
    assert at.status == "proved"
    assert at.verdict.equality
    below = limit - abs(limit) / 100
    claim = sampled_passivity(law, damping=below, sample_time=T, stiffness=spring)
    assert claim.status == "refuted"
    assert claim.record.replay() > 0


def test_a_compensator_near_rest_needs_no_damping_but_allows_none_that_drives():
    """The condition on the unit circle is met by b > -0.25 N s/m; between samples b < 0 drives."""
    assert required_damping(-500, sample_time=T, stiffness=500) == 0
    with pytest.raises(ModelError, match="damping: expected a number >= 0"):
        sampled_passivity(-500, damping=sp.Rational(-1, 5), sample_time=T, stiffness=500)


def test_a_refuting_motion_replays_from_its_file(tmp_path):
    claim = sampled_passivity(K / Z, damping=1, sample_time=T)
    write_record(claim.record, tmp_path / "motion.json")
    assert read_record(tmp_path / "motion.json").replay() == pytest.approx(claim.record.energy)


def test_the_z_width_of_a_wall_without_delay():
    """K = 2 (b - B)/T for wall dampings from 0 to b."""
    width = z_width(damping=5.0, sample_time=1e-3, inertia=0.15, wall_damping=np.linspace(0, 4, 5))
    assert width.verified
    assert width.stiffness == pytest.approx(2 * (5 - width.wall_damping) / 1e-3, rel=1e-7)
    assert width.stiffest == pytest.approx((1e4, 0.0))
    free = 5 + 0.15 * 2j * np.pi  # m s + b at 1 Hz, and the wall beside it
    wall = abs(free + 1e4 / (2j * np.pi)) / abs(free)
    assert width.width(1.0) == pytest.approx(20 * np.log10(wall))
    assert "K (N/m)" in width.graph().y_label


z = sp.Symbol("z")
PERIOD = 1e-3
#: wall of 500 N/m and 2 N s/m by the difference of two readings
WALL = 500 + 2 / sp.Rational(1, 1000) * (1 - 1 / z)
FORMS = {
    "transfer function": control.tf([2500.0, -2000.0], [1.0, 0.0], PERIOD),
    "state space": control.ss([[0.0]], [[1.0]], [[-2000.0]], [[2500.0]], PERIOD),
    "any period": control.tf([2500.0, -2000.0], [1.0, 0.0], True),
}


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("damping", [2.0, 2.25, 2.5, 9.0])
def test_the_claim_is_that_on_its_transfer_function(form, damping):
    """About the limit K T/2 + B = 2.25 N s/m of a wall."""
    known = sampled_passivity(WALL, damping=damping, sample_time=PERIOD)
    claim = sampled_passivity(FORMS[form], damping=damping, sample_time=PERIOD)
    assert (claim.status, claim.statement) == (known.status, known.statement)
    assert claim.status == ("proved" if damping >= 2.25 else "refuted")


@pytest.mark.parametrize("pole", [1.25, 0.5])
def test_a_mode_that_it_does_not_show_is_refused(pole):
    """Proved by its transfer function, a constant, while a state within may grow."""
    hidden = control.ss([[pole]], [[1.0]], [[0.0]], [[100.0]], PERIOD)
    cancelled = control.tf([100.0, -100.0 * pole], [1.0, -pole], PERIOD)
    for system in (hidden, cancelled):
        with pytest.raises(ModelError, match="a mode that its transfer function does not show"):
            sampled_passivity(system, damping=5.0, sample_time=PERIOD)
