"""The most energy that any motion can take out of friction beside a compensator."""

from dataclasses import replace

import numpy as np
import pytest

from teleopdesign.base.errors import ModelError
from teleopdesign.passivity import Coulomb, Dahl, DahlBehindSpring, Spring, available_storage
from teleopdesign.passivity.rate_independent import Cycle, symmetric_cycle

CABLE = [Coulomb(1.0), Spring(2.0, 1e4)]


def test_without_compensation_beyond_friction_the_storage_is_what_the_springs_hold():
    """Beside f_D = 0.5 N <= f_1 nothing but the cable's energy, and the bristle's, comes out."""
    storage = available_storage(Dahl(0.5, 1e4), CABLE, points=31)
    assert storage.is_finite
    assert storage.evidence().holds
    cable = 2.0**2 / (2 * 1e4)
    # released towards its rest the cable has to move the motor against 1 N: less comes out
    assert 0 < storage.storage.max() < cable + 0.5**2 / (2 * 1e4)
    assert storage.storage.min() >= 0


@pytest.mark.parametrize(("level", "is_finite"), [(1.2, True), (1.4, False), (3.2, False)])
def test_storage_settles_below_the_limit_of_cycles_and_grows_above(level, is_finite):
    """sigma_D = 3 k: cycles give out energy from (3 - sqrt 3) f_1 on."""
    storage = available_storage(Dahl(level, 3e4), CABLE, points=31)
    assert storage.is_finite is is_finite
    refuted = any(
        symmetric_cycle(Dahl(level, 3e4), CABLE, a).energy > 0 for a in np.geomspace(1e-5, 1e0, 60)
    )
    assert refuted is not is_finite


def test_a_gain_is_what_a_sliding_motor_gives_out_per_travel():
    storage = available_storage(Dahl(3.5, 3e3), CABLE, points=31)
    # so soft a bristle gives most by sliding one way for ever: f_D - f_1 - f_2
    assert storage.gain == pytest.approx(0.5, rel=1e-6)


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


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Dahl(1.0, -1e3), "Dahl: stiffness = -1000, expected above 0"),
        (lambda: Dahl(0.0, 1e3), "Dahl: level = 0, expected above 0"),
        (lambda: Spring(1.0, np.inf), "Spring: stiffness = inf"),
        (lambda: Coulomb(-0.5), "Coulomb: level = -0.5"),
        (lambda: available_storage(Dahl(1.0, 1e3), CABLE, points=1), "expected 3 points"),
        (lambda: available_storage(Dahl(1.0, 1e9), [Spring(1.0, 1e-3)]), "would take minutes"),
    ],
)
def test_what_is_no_friction_or_takes_for_ever_is_reported_in_one_line(make, words):
    with pytest.raises(ModelError) as caught:
        make()
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_a_round_that_springs_still_feed_counts_for_no_more_than_all_rounds():
    """Ten times too short a stroke for a bristle to forget its start within three rounds."""
    rng = np.random.default_rng(1)
    for _ in range(200):
        friction = (Spring(rng.uniform(0.5, 2.0), 10 ** rng.uniform(2, 4)),)
        points = tuple(float(x) for x in 1e-4 * rng.standard_normal(4))
        cycle = Cycle(Dahl(1.0, 1e3), friction, points, rounds=3)
        forces, here, total = [0.0, 0.0], points[-1], 0.0
        for point in points * 3:
            for k, (element, sign) in enumerate(((cycle.compensator, 1), (friction[0], -1))):
                forces[k], work = element.leg(forces[k], point - here)
                total += sign * work
            here = point
        assert cycle.energy <= max(total, 0.0) + 1e-15


def test_a_storage_that_still_grows_is_no_evidence_for_a_limit():
    """After few moves the gain is below its tolerance, for what comes out comes out slowly."""
    storage = available_storage(Dahl(1.27, 3e4), CABLE, points=31, moves=200)
    storage = replace(storage, round_trip=0.0)  # as for motions of more than two turns
    final_storage = replace(storage, growth=0.0)
    slow = replace(storage, gain=storage.tolerance / 2, growth=float(storage.storage.max()) / 10)
    assert replace(final_storage, gain=storage.tolerance / 2).is_finite
    assert not slow.is_finite
    assert "still growing, by" in slow.evidence().searched
    assert not slow.evidence().holds
