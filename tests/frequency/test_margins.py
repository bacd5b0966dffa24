"""Gain and phase margins of a loop, dead times exacontrol."""

import control
import numpy as np
import pytest
import sympy as sp

from teleopdesign.frequency import LoopGain, gain_margin, phase_margin
from teleopdesign.frequency.response import phase_of
from teleopdesign.realise.lti import S

HALF = sp.Rational(1, 2)


def loop(gain):
    return LoopGain(sp.sympify(gain), "H", (), (), np.inf)


@pytest.mark.parametrize("k", [3, 30, 150])
def test_a_late_integrator_has_its_closed_forms(k):
    late = loop(k * sp.exp(-S / 100) / S)
    assert gain_margin(late) == pytest.approx(np.pi / 2 / (k / 100), rel=1e-9)
    assert phase_margin(late) == pytest.approx(90 - np.degrees(k / 100), rel=1e-9)


@pytest.mark.parametrize(
    ("gain", "margin"),
    [
        (HALF / (S**2 + S), np.inf),
        (-HALF / (S + 1), 2.0),  # at rest
        (-HALF * S / (S + 1), 2.0),  # at high frequency
        (HALF * S / (S + 1) * sp.exp(-S / 100), 2.0),  # all phases come there
        # of a part at once and a late one -180 degrees come only where the late one is larger
        ((HALF / 4 + sp.exp(-S) / 4) * S / (S + 1), 8.0),
        ((HALF / 2 + sp.exp(-S) / 8) * S / (S + 1), np.inf),
        # 1 + exp(-s)/4 - g/2 is 0 far out from 1 - g/2 = 1/4 on
        (-HALF * S / (S + 1) / (1 + sp.exp(-S) / 4), 1.5),
    ],
)
def test_the_ends_of_the_axis_count(gain, margin):
    assert gain_margin(loop(gain)) == pytest.approx(margin, rel=1e-6)


@pytest.mark.parametrize("k", [0.5, 4.0, 7.5])
def test_without_dead_time_margins_are_those_of_python_control(k):
    rational = loop(sp.Rational(k) / (S + 1) ** 3)
    factor, turn, *_ = control.margin(control.tf([k], [1, 3, 3, 1]))
    assert gain_margin(rational) == pytest.approx(factor, rel=1e-9)
    assert phase_margin(rational) == pytest.approx(turn, rel=1e-6)


def test_a_phase_margin_is_that_to_the_nearer_side():
    """At the lower crossing the phase is 180 degrees less three lags: more lead turns it over."""
    slower = 0.3438784  # rad/s, where 10 w^2 = (1 + w^2)^(3/2); at the faster one 107 degrees
    margin = phase_margin(loop(10 * S**2 / (S + 1) ** 3))
    assert margin == pytest.approx(3 * np.degrees(np.arctan(slower)), rel=1e-5)


D = control.tf("s")
#: response, and its phase (deg) at the lowest frequency
STARTS = {
    "a mass": (1 / D**2, -180.0),
    "a damped mass": (1 / (D**2 + 100 * D), -90.0),
    "a damper": (3 * D, 90.0),
    "a gain below 0": (-4 / (D + 1000), 180.0),
    "an integrator with a gain below 0": (-4 / D, 90.0),
    "a third power": (1 / D**3, -270.0),
    "a double integrator with a lag": (1 / (D**2 * (1 + D)), -180.0),
    "the rising side of a resonance": (1 / (D**2 + 1e-4 * D + 2 * 0.0628**2), 0.0),
    "the falling side of a resonance": (1 / (D**2 + 1e-4 * D + 0.5 * 0.0628**2), -180.0),
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
