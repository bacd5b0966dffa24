"""A hand that is not logged makes the force of a virtual wall look late, or its sign look wrong."""

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.fitted_checks import check_experiment

H = 0.001
T = H * np.arange(2000)


def at_the_wall(seed):
    """Findings of a hand that moves a handle 25 mm to either side of the surface of a wall.

    The wall pushes with 100 N/m on the way in, and a passivity controller with a part of it that
    varies on the way out.
    """
    rng = np.random.default_rng(seed)
    parts = [(rng.uniform(0.3, 1.0), f, rng.uniform(0, 6.3)) for f in rng.uniform(0.4, 2.0, 3)]
    path = sum(size * np.sin(2 * np.pi * f * T + phase) for size, f, phase in parts)
    x = 0.025 * path / np.abs(path).max()
    held = np.repeat(rng.uniform(0.1, 1.0, len(T) // 50), 50)
    force = -100.0 * np.maximum(x, 0.0) * np.where(np.gradient(x) * np.sign(x) < 0, held, 1.0)
    return findings_on(x, force)


def findings_on(x, force):
    table = {"t": T, "x": np.round(x, 6), "u": force}
    channels = {"position": {"column": "x", "unit": "m"}, "actuator_force": "u"}
    return check_experiment(td.experiment(table, axis="prismatic", inertia=0.1, **channels))


def test_a_lateness_beyond_that_of_a_logger_is_no_advice_to_state_a_delay():
    (shift,) = [f for f in at_the_wall(53) if f.topic == "time shift"]
    assert shift.concern == "note"
    assert "lags the motion" in shift.sentence
    assert "write delay" not in shift.sentence


def test_a_sign_that_seems_wrong_may_be_that_of_a_hand():
    x = 0.025 * np.sin(2 * np.pi * 0.9 * T) + 0.004 * np.sin(2 * np.pi * 3.1 * T)
    v = np.gradient(x, T)
    force = 0.1 * np.gradient(v, T) + 2.0 * v + 0.002 * np.random.default_rng(1).normal(size=len(T))
    (sign,) = [f for f in findings_on(x, -force) if f.topic == "signs"]
    assert "has the opposite sign" in sign.sentence
    assert "A hand that moves the device and is not logged looks the same" in sign.sentence


@pytest.mark.slow
def test_friction_that_the_model_lacks_is_no_delay_of_a_log():
    """A Stribeck peak after each reversal looks like a position that lags the forces."""
    t = 1e-3 * np.arange(8000)
    x = 0.02 * np.sin(1.5 * t) + 0.01 * np.sin(4.5 * t + 1.0) + 0.003 * np.sin(18.0 * t)
    v = np.gradient(x, t)
    level = 0.5 + 0.5 * np.exp(-((v / 0.02) ** 2))
    force = 0.2 * np.gradient(v, t) + level * np.tanh(v / 1e-3) + v
    table = {"t": t, "x": np.round(x / 5e-6) * 5e-6, "u": force, "f": 0.01 * np.sin(7.0 * t)}
    channels = {"position": {"column": "x", "unit": "m"}, "actuator_force": "u"}
    experiment = td.experiment(
        table, axis="prismatic", inertia=0.2, interaction_force="f", **channels
    )
    shifts = [f for f in check_experiment(experiment) if f.topic == "time shift"]
    assert all(shift.concern == "note" for shift in shifts)
