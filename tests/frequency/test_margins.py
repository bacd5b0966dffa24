"""Gain and phase margins of a loop, dead times exact."""

import control as ct
import numpy as np
import pytest
import sympy as sp

from teleopdesign.base.errors import UnstableLoop
from teleopdesign.frequency import LoopGain, gain_margin, phase_margin
from teleopdesign.realise.lti import S

HALF = sp.Rational(1, 2)


def loop(gain):
    return LoopGain(sp.sympify(gain), "H", (), (), np.inf)


@pytest.mark.parametrize("k", [3, 30, 150])
def test_a_late_integrator_has_its_closed_forms(k):
    late = loop(k * sp.exp(-S / 100) / S)
    assert gain_margin(late) == pytest.approx(np.pi / 2 / (k / 100), rel=1e-9)
    assert phase_margin(late) == pytest.approx(90 - np.degrees(k / 100), rel=1e-9)


def test_a_dead_time_of_many_turns_is_followed():
    # 12 rad/s and 5 s are 60 rad: a Pade approximation of order 8 ends at some 20
    late = loop(sp.exp(-5 * S) / ((S / 12) ** 2 + S / 60 + 1) * HALF / 10)
    w = np.linspace(0.1, 40, 2_000_001)
    gain = 0.05 * np.exp(-5j * w) / (1 - (w / 12) ** 2 + 1j * w / 60)
    turns = np.flatnonzero((np.diff(np.sign(gain.imag)) != 0) & (gain.real[1:] < 0))
    assert gain_margin(late) == pytest.approx(1 / np.abs(gain[turns]).max(), rel=1e-3)


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
    factor, turn, *_ = ct.margin(ct.tf([k], [1, 3, 3, 1]))
    assert gain_margin(rational) == pytest.approx(factor, rel=1e-9)
    assert phase_margin(rational) == pytest.approx(turn, rel=1e-6)


def test_a_phase_margin_is_that_to_the_nearer_side():
    """At the lower crossing the phase is 180 degrees less three lags: more lead turns it over."""
    slower = 0.3438784  # rad/s, where 10 w^2 = (1 + w^2)^(3/2); at the faster one 107 degrees
    margin = phase_margin(loop(10 * S**2 / (S + 1) ** 3))
    assert margin == pytest.approx(3 * np.degrees(np.arctan(slower)), rel=1e-5)


def test_an_unstable_loop_has_no_margins():
    for margin in (gain_margin, phase_margin):
        with pytest.raises(UnstableLoop):
            margin(loop(20 / (S + 1) ** 3))
