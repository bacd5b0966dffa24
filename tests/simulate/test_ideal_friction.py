"""Ideal friction against a computation that holds and releases the mass at events."""

import math

import numpy as np
import pytest

import teleopdesign as td

MASS, LEVEL = 0.2, 0.5


def device(damping=0.0):
    body = td.Body("prismatic", {"inertia": MASS}).with_effect(
        td.EFFECTS["coulomb"], {"level": LEVEL}
    )
    return body.with_effect(td.EFFECTS["viscous"], {"damping": damping}) if damping else body


def by_events(force, damping, duration, number=200_000):
    """Positions (number + 1,): the mass is held where it turns, unless the force exceeds LEVEL."""
    h, x, v, course = duration / number, 0.0, 0.0, np.zeros(number + 1)
    for i in range(number):
        f = force((i + 0.5) * h)
        if v == 0.0:
            v = max(abs(f) - LEVEL, 0.0) * math.copysign(1.0, f) / MASS * h
        else:
            later = v + (f - math.copysign(LEVEL, v) - damping * v) / MASS * h
            v = 0.0 if later * v < 0.0 and abs(f) <= LEVEL else later
        x += v * h
        course[i + 1] = x
    return course


@pytest.mark.parametrize(
    ("force", "damping", "duration", "error"),
    [
        (lambda t: math.sin(10 * t), 0.0, 1.0, 0.02),
        (lambda t: 3 * math.sin(30 * t), 2.0, 1.0, 0.005),
    ],
    ids=["holds twice in a cycle", "turns without a hold"],
)
def test_a_driven_mass_moves_as_by_events(force, damping, duration, error):
    """The spring returns energy when the motion turns; the damper takes most: 1.4 %, 0.3 % off."""
    diagram = td.haptic_interface(device(damping))
    run = td.simulate_diagram(
        diagram, duration=duration, inputs={"R_D": np.vectorize(force)}, computer="continuous"
    )
    course = by_events(force, damping, duration)
    there = np.interp(run.data["time"], np.linspace(0.0, duration, len(course)), course)
    assert np.abs(run["L"].values - there).max() < error * np.ptp(course)
    assert "give" not in run.data.attrs["scheme"]


def test_a_vibration_below_the_level_does_not_move_a_loaded_mass():
    """A bristle that creeps carried it 0.4 mm in these 2 s."""
    run = td.simulate_diagram(
        td.haptic_interface(device()),
        duration=2.0,
        inputs={"R_D": lambda t: 0.35 + 0.1 * np.sin(60 * t)},
        computer="continuous",
    )
    assert np.abs(run["L"].values).max() < 1e-5
    assert "give" in run.data.attrs["scheme"]


def test_a_fit_says_that_ideal_friction_moves_its_values():
    time = np.linspace(0.0, 1.0, 1001)
    course = by_events(lambda t: 1.5 * math.sin(9 * t), 0.0, 1.0)
    data = {"time": time, "L": np.interp(time, np.linspace(0.0, 1.0, len(course)), course)}
    fitted = td.fit_simulation(
        td.haptic_interface(device()),
        data,
        {"Z_M.inertia": (0.1, 0.4)},
        inputs={"R_D": lambda t: 1.5 * np.sin(9 * t)},
        computer="continuous",
        starts=1,
    )
    assert fitted.by_give["L"] > 0.3
    assert any("give" in remark for remark in fitted.remarks)
