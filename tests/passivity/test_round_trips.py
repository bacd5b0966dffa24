"""Round trips that repeat: what they take, and that none is too short to be noticed."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.passivity import Coulomb, Dahl, DahlBehindSpring, Spring, available_storage
from teleopdesign.passivity.available_storage import loss_per_stroke, most_released
from teleopdesign.passivity.rate_independent import dahl_loss, symmetric_cycle

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


@given(stroke=st.floats(0.1, 10.0), stiff=st.floats(0.3, 100.0))
def test_a_contact_behind_a_spring_loses_what_many_rounds_lose(stroke, stiff):
    friction = DahlBehindSpring(2.0, 2.0, stiff)
    nothing = Dahl(1e-12, 1e-12)
    rounds = symmetric_cycle(nothing, [friction], stroke / 2)
    assert loss_per_stroke(friction, stroke) == pytest.approx(-rounds.energy / 2, rel=1e-4)


@pytest.mark.parametrize(("level", "passive"), [(1.267, True), (1.269, False), (3.5, False)])
def test_the_limit_of_round_trips_is_the_theorems(level, passive):
    """sigma_D = 3 k: strokes of twice a spring's length give out energy from (3 - sqrt 3) f_1."""
    cable = [Coulomb(1.0), Spring(2.0, 1e4)]
    released, stroke = most_released(Dahl(level, 3e4), cable)
    assert (released == 0) is passive
    assert stroke == pytest.approx(4e-4, rel=1e-3)
    energy = symmetric_cycle(Dahl(level, 3e4), cable, stroke / 2).energy
    assert energy / (2 * stroke) == pytest.approx(released, rel=1e-3) or passive


def test_friction_under_a_load_takes_its_share_of_the_way():
    """A spring under load: |force| over a stroke, by small steps."""
    spring, stroke = Spring(2.0, 1e4), 7e-4
    force, pressed = -2.0, 0.0
    for _ in range(7000):
        after, _ = spring.leg(force, 1e-7)
        pressed, force = pressed + abs(force + after) / 2 * 1e-7, after
    helps, rail = Dahl(3.5, 3e4), Coulomb(1.0)
    free, loaded = (loss_per_stroke(helps, stroke) - x for x in (0.0, 0.2 * pressed))
    takes = loss_per_stroke(rail, stroke) + loss_per_stroke(spring, stroke)
    most_free, most_loaded = (most_released(helps, [rail, spring], x)[0] for x in (0.0, 0.2))
    assert (free - takes) / stroke <= most_free
    assert (loaded - takes) / stroke <= most_loaded * (1 + 1e-6)
    # the best stroke ends where the spring begins to slide: on its way |force| is 1 N in the mean
    assert most_loaded == pytest.approx(most_free - 0.2 * 1.0, rel=1e-6)


def test_no_trip_is_too_short_beside_the_cells_of_a_grid():
    """Within a spring that sticks the compensator gives more than the contact behind it takes."""
    helps = Dahl(0.00279, 178.0)
    friction = [Spring(0.00418, 889.0), DahlBehindSpring(0.00785, 91.8, 72.4)]
    storage = available_storage(helps, friction, points=13)
    assert storage.gain <= storage.tolerance  # on the grid nothing comes out
    assert not storage.evidence().holds
    assert "strokes of 9.4e-06 m forth and back release 8.01e-05 N" in storage.evidence().searched
    assert symmetric_cycle(helps, friction, storage.stroke / 2).energy > 0


def test_friction_that_is_what_is_cancelled_gives_out_nothing():
    rng = np.random.default_rng(4)
    for level, stiffness in 10 ** rng.uniform(-3, 3, (20, 2)):
        same = Dahl(float(level), float(stiffness))
        assert most_released(same, [same])[0] == 0
        assert most_released(Dahl(1.001 * float(level), float(stiffness)), [same])[0] > 0


def test_a_load_is_the_force_of_the_last_element_whatever_stands_before_it():
    helps, rail, spring = Dahl(3.5, 3e4), Coulomb(1.0), Spring(2.0, 1e4)
    two = most_released(helps, [rail, spring], 0.2)
    three = most_released(helps, [rail, Coulomb(1e-12), spring], 0.2)
    assert three == pytest.approx(two, rel=1e-6)
    with_more = most_released(helps, [rail, Coulomb(0.3), spring], 0.2)
    assert with_more[0] == pytest.approx(two[0] - 0.3, rel=1e-6)
