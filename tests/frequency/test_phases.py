"""The phase of a response begins where a reader of Bode plots expects it."""

import control
import numpy as np
import pytest

from teleopdesign.frequency.response import phase_of

S = control.tf("s")
#: response, and its phase (deg) at the lowest frequency
STARTS = {
    "a mass": (1 / S**2, -180.0),
    "a damped mass": (1 / (S**2 + 100 * S), -90.0),
    "a damped mass above its corner": (1 / (S**2 + 1e-3 * S), -180.0),
    "the inertia of a mass": (0.2 * S**2, 180.0),
    "a damper": (3 * S, 90.0),
    "a spring": (400 / (S + 400), 0.0),
    "a gain below 0": (-4 / (S + 1000), 180.0),
    "an integrator with a gain below 0": (-4 / S, 90.0),
    "a damper with a sign": (-3 * S, -90.0),
    "a third power": (1 / S**3, -270.0),
    "a double integrator with a lag": (1 / (S**2 * (1 + S)), -180.0),
    "the rising side of a resonance": (1 / (S**2 + 1e-4 * S + 2 * 0.0628**2), 0.0),
    "the falling side of a resonance": (1 / (S**2 + 1e-4 * S + 0.5 * 0.0628**2), -180.0),
}


@pytest.mark.parametrize("name", STARTS)
def test_a_phase_begins_on_the_turn_of_its_slope(name):
    system, start = STARTS[name]
    f = np.geomspace(0.01, 10.0, 300)
    values = np.atleast_2d(system(2j * np.pi * f))
    phase = phase_of(values, f)[0]
    assert phase[0] == pytest.approx(start, abs=6)
    np.testing.assert_allclose(np.exp(1j * np.radians(phase)), values[0] / np.abs(values[0]))


@pytest.mark.parametrize("noise", [1e-16, -1e-16])
@pytest.mark.parametrize(("power", "start"), [(-2, -180.0), (2, 180.0), (-3, -270.0)])
def test_rounding_does_not_turn_a_phase_round(power, start, noise):
    f = np.array([1.0, 2.0, 4.0])
    values = (1j * f) ** power * (1 + 1j * noise)
    phase = phase_of(values[None], f)
    np.testing.assert_allclose(phase, start)


@pytest.mark.parametrize("f", [[1.0], [0.0, 1.0], [0.0], [2.0, 2.0, 3.0]])
@pytest.mark.parametrize("size", [0.0, 1.0, np.inf])
def test_any_frequencies_and_sizes_are_taken(f, size):
    phase = phase_of(np.full((1, len(f)), size + 0j), np.array(f))
    np.testing.assert_allclose(phase[0], 0.0)
