"""The most energy that any motion can take out of friction beside a compensator."""

import numpy as np
import pytest

from teleopdesign.errors import ModelError
from teleopdesign.passivity import Coulomb, Dahl, DahlBehindSpring, Spring, available_storage
from teleopdesign.passivity.rate_independent import Cycle, symmetric_cycle

CABLE = [Coulomb(1.0), Spring(2.0, 1e4)]


def test_without_compensation_beyond_friction_the_storage_is_what_the_springs_hold():
    """Beside f_D = 0.5 N <= f_1 nothing but the cable's energy, and the bristle's, comes out."""
    found = available_storage(Dahl(0.5, 1e4), CABLE, points=31)
    assert found.is_finite
    assert found.evidence().holds
    cable = 2.0**2 / (2 * 1e4)
    # released towards its rest the cable has to move the motor against 1 N: less comes out
    assert 0 < found.storage.max() < cable + 0.5**2 / (2 * 1e4)
    assert found.storage.min() >= 0


@pytest.mark.parametrize(("level", "settled"), [(1.2, True), (1.4, False), (3.2, False)])
def test_storage_settles_below_the_limit_of_cycles_and_grows_above(level, settled):
    """sigma_D = 3 k: cycles give out energy from 1.265 f_1 on."""
    found = available_storage(Dahl(level, 3e4), CABLE, points=31)
    assert found.is_finite is settled
    refuted = any(
        symmetric_cycle(Dahl(level, 3e4), CABLE, a).energy > 0 for a in np.geomspace(1e-5, 1e0, 60)
    )
    assert refuted is not settled


def test_a_gain_is_what_a_sliding_motor_gives_out_per_travel():
    found = available_storage(Dahl(3.5, 3e3), CABLE, points=31)
    # so soft a bristle gives most by sliding one way for ever: f_D - f_1 - f_2
    assert found.gain == pytest.approx(0.5, rel=1e-6)


def test_a_contact_pressed_by_the_cable_covers_more():
    assert not available_storage(Dahl(1.4, 3e4), CABLE, points=31).is_finite
    assert available_storage(Dahl(1.4, 3e4), CABLE, points=31, load_coefficient=0.2).is_finite


def test_more_than_three_forces_are_refused():
    with pytest.raises(ModelError, match="at most 3 forces"):
        available_storage(Dahl(1.0, 1e4), [Dahl(1.0, 1e4)] * 3)


@pytest.mark.parametrize("travel", [1e-5, -3e-4, 5e-3])
def test_a_contact_behind_a_spring_is_the_two_in_series(travel):
    """Against small steps of ds (1/k + 1/(sigma (1 - s/f))) = dx, by the midpoint rule."""
    element, force, work, n = DahlBehindSpring(2.0, 5e4, 1e4), 0.3, 0.0, 20000
    h, s = travel / n, np.sign(travel)

    def rate(f):
        return 1 / (1 / 1e4 + 1 / (5e4 * max(1 - s * f / 2.0, 1e-12)))

    f = force
    for _ in range(n):
        after = f + h * rate(f + h * rate(f) / 2)
        work, f = work + h * (f + after) / 2, after
    # midpoint and trapezoid: second order in 1/20000 of the way
    assert element.leg(force, travel) == pytest.approx((f, work), rel=1e-5)


def test_a_rigid_contact_behind_a_spring_is_the_spring_that_slides():
    rigid, plain = DahlBehindSpring(2.0, 1e10, 1e4), Spring(2.0, 1e4)
    points = (3e-4, -1e-4, 2e-4, -3e-4)
    soft, hard = (Cycle(Dahl(1.0, 1e4), (e,), points, rounds=20).energy for e in (rigid, plain))
    assert soft == pytest.approx(hard, rel=1e-4)  # the contact gives by f/sigma = 0.2 nm
