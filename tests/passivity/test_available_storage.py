"""The most energy that any motion can take out of friction beside a compensator."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.passivity import Coulomb, Dahl, DahlBehindSpring, Spring, available_storage
from teleopdesign.passivity.available_storage import loss_per_stroke, most_released
from teleopdesign.passivity.rate_independent import dahl_loss, symmetric_cycle

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


def test_a_contact_pressed_by_the_cable_covers_more():
    assert not available_storage(Dahl(1.4, 3e4), CABLE, points=31).is_finite
    assert available_storage(Dahl(1.4, 3e4), CABLE, points=31, load_coefficient=0.2).is_finite


STROKES = st.floats(-2.0, 2.0).map(lambda x: 10.0**x)


@given(stroke=STROKES)
def test_losses_are_those_of_closed_forms(stroke):
    """A Dahl bristle of length 1 m, a spring that slides from strokes of 2 m on, dry friction."""
    assert loss_per_stroke(Dahl(3.0, 3.0), stroke) == pytest.approx(
        dahl_loss(3.0, 3.0, stroke / 2) / 2, rel=1e-6
    )
    sliding = 3.0 * max(stroke - 2.0, 0.0)
    assert loss_per_stroke(Spring(3.0, 3.0), stroke) == pytest.approx(sliding, abs=1e-13 * stroke)
    assert loss_per_stroke(Coulomb(3.0), stroke) == pytest.approx(3.0 * stroke)


@pytest.mark.parametrize(("level", "passive"), [(1.267, True), (1.269, False)])
def test_the_limit_of_round_trips_is_the_theorems(level, passive):
    """sigma_D = 3 k: strokes of twice a spring's length give out energy from (3 - sqrt 3) f_1."""
    cable = [Coulomb(1.0), Spring(2.0, 1e4)]
    released, stroke = most_released(Dahl(level, 3e4), cable)
    assert (released == 0) is passive
    assert stroke == pytest.approx(4e-4, rel=1e-3)
    energy = symmetric_cycle(Dahl(level, 3e4), cable, stroke / 2).energy
    assert energy / (2 * stroke) == pytest.approx(released, rel=1e-3) or passive


def test_no_trip_is_too_short_beside_the_cells_of_a_grid():
    """Within a spring that sticks the compensator gives more than the contact behind it takes."""
    helps = Dahl(0.00279, 178.0)
    friction = [Spring(0.00418, 889.0), DahlBehindSpring(0.00785, 91.8, 72.4)]
    storage = available_storage(helps, friction, points=13)
    assert storage.gain <= storage.tolerance  # on the grid nothing comes out
    assert not storage.evidence().holds
    assert "strokes of 9.4e-06 m forth and back release 8.01e-05 N" in storage.evidence().searched
    assert symmetric_cycle(helps, friction, storage.stroke / 2).energy > 0
