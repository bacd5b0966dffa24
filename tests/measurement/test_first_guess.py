"""First values, turned signs and balances of forces that were made so."""

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.measurement.first_guess import balance_factor, explain_force, is_turned

H = 0.005
T = H * np.arange(4000)
SWING = np.sin(2 * np.pi * 0.6 * T) + 0.4 * np.sin(2 * np.pi * 1.7 * T + 1.0)


def rate_of(x, order=1):
    return np.gradient(x, H) if order == 1 else rate_of(np.gradient(x, H))


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("inertia", "level", "damping"),
    [(0.2, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 0.8), (0.2, 1.0, 0.5), (0.01, 1.0, 0.0)],
)
def test_a_force_that_would_drive_by_friction_or_inertia_is_turned(turned, inertia, level, damping):
    v = rate_of(SWING)
    force = inertia * rate_of(SWING, 2) + level * np.sign(v) + damping * v + 0.7
    assert is_turned(-force if turned else force, SWING, H) == turned
    assert is_turned(force, -SWING if turned else SWING, H) == turned


def test_what_makes_more_of_the_force_decides():
    """A little inertia of the wrong sign is what is late in slow motion; much of it is no such."""
    v, a = rate_of(SWING), rate_of(SWING, 2)
    assert not is_turned(1.0 * np.sign(v) - 0.002 * a, SWING, H)
    assert is_turned(0.1 * np.sign(v) - 0.2 * a, SWING, H)


def test_a_motion_in_one_direction_tells_a_constant_force_from_no_friction():
    """Only its inertia is told, and only if that is surely of one sign."""
    x = 10.0 * T + 0.2 * SWING
    a = rate_of(x, 2)
    assert not is_turned(0.1 * a - 3.0, x, H)
    assert is_turned(-0.1 * a + 3.0, x, H)


@pytest.mark.parametrize("factor", [0.3, 1.0, -2.0])
def test_the_force_that_balances_is_detected_whatever_the_body_is(factor):
    rng = np.random.default_rng(4)
    hand = np.convolve(rng.standard_normal(len(T)), np.hanning(80), "same")
    v, a = rate_of(SWING), rate_of(SWING, 2)
    force = 0.1 * a + 0.5 * np.sign(v) + 0.2 * v + 0.3 - factor * hand
    estimate, error = balance_factor(force, hand, SWING, H)
    assert estimate == pytest.approx(factor, abs=0.03) and 0 < error < 0.05
    assert balance_factor(force[:150], hand[:150], SWING[:150], H) == (0.0, np.inf)
    # while the body rests friction takes any force: these rows do not count
    still = np.where(T < 10.0, SWING, SWING[2000])
    held = np.where(T < 10.0, force, 5.0 * rng.standard_normal(len(T)))
    assert balance_factor(held, hand, still, H)[0] == pytest.approx(factor, abs=0.1)


@pytest.mark.parametrize("rate", [0.3, 1.8])
@pytest.mark.parametrize(("level", "seed"), [(0.2, 0), (0.4, 1)])
def test_a_spring_with_friction_at_one_frequency_is_no_turned_inertia(rate, level, seed):
    """A cyclic test: in cycles of one duration a spring is a negative inertia, but friction brakes.

    A frictionless body with the wrong sign is turned as before.
    """
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 13.0 / rate, 0.02)
    turns = np.interp(t, np.linspace(0.0, t[-1], 7), [0.4, 0.4, 0.7, 0.75, 1.0, 1.05, 1.0])
    x = turns * np.sin(2 * np.pi * rate * t + 0.3 * np.sin(0.7 * t))
    force = x + level * np.sign(np.gradient(x)) + 0.1 * rng.standard_normal(len(t))
    assert not is_turned(force, x, 0.02)
    body = np.gradient(np.gradient(x, t), t) / (2 * np.pi * rate) ** 2
    assert is_turned(-body + 0.1 * rng.standard_normal(len(t)), x, 0.02)


@pytest.mark.parametrize("rate", [0.05, 0.5])
@pytest.mark.parametrize("stiffness", [0.3, 10.0])
def test_a_pendulum_below_its_natural_frequency_is_no_turned_inertia(rate, stiffness):
    """Chirps from rest; by itself the body swings at up to 14 rad/s."""
    t = 0.01 * np.arange(1500)
    x = 0.8 * np.sin(rate * t**2)
    v = np.gradient(x, t)
    force = 0.05 * np.gradient(v, t) + stiffness * np.sin(x) + 0.1 * np.tanh(v / 0.01) + 0.01 * v
    force += 0.01 * np.random.default_rng(1).standard_normal(len(t))
    assert not is_turned(force, x, 0.01)
    assert is_turned(-force, x, 0.01)
    if rate > 0.1:  # slower, inertia is 3 % of the friction
        assert explain_force(force, x, 0.01).inertia == pytest.approx(0.05, rel=0.3)


def test_a_slow_motor_with_much_friction_gets_a_start_of_its_inertia():
    """Friction of 1 N m over 1 mN m of inertia: the estimate may come out negative."""
    t = np.arange(4000) / 200.0
    x = np.sin(0.5 * t)
    noise = 0.1 * np.random.default_rng(8).standard_normal(len(t))
    starts = []
    for sign in (1.0, -1.0):  # of the noise: one of the two estimates is too small
        u = np.tanh(50 * np.cos(0.5 * t)) - 4e-3 * 0.25 * x + sign * noise
        table = {"t": t, "x": x, "u": u}
        names = {"time": "t", "position": "x", "actuator_force": "u"}
        made = td.experiment(table, axis="revolute", **names)
        starts.append(made.bodies["device"].inertia.value)
    assert min(starts) > 0.0 and max(starts) < 1.0
