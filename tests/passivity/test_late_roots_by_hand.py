"""Rightmost roots with a dead time and their proof, against Lambert's function."""

from fractions import Fraction

import numpy as np
import pytest
from scipy.special import lambertw

from teleopdesign.passivity.intervals.late import holds_root, rightmost_root


def exact(late):
    return {Fraction(t): [Fraction(c) for c in p] for t, p in late.items()}


@pytest.mark.parametrize("time", [1e-3, 0.2, 1.0, 50.0])
@pytest.mark.parametrize("gain", [0.1, 0.3, 1.0, 2.0, 6.0, -0.5])
def test_the_rightmost_root_of_an_integrator_with_a_late_gain_is_lamberts(gain, time):
    """s + (g/T) e^(-s T) is zero at W(-g)/T, whatever the unit of time."""
    late = {0.0: np.array([1.0, 0.0]), time: np.array([gain / time])}
    root, expected = rightmost_root(late), complex(lambertw(-gain)) / time
    assert root.real == pytest.approx(expected.real, rel=1e-6)
    assert abs(root.imag) == pytest.approx(abs(expected.imag), rel=1e-6, abs=1e-9 / time)
    radius = holds_root(exact(late), root)
    assert radius is not None
    nearest = min(abs(root - expected), abs(root - expected.conjugate()))
    assert nearest <= radius < 0.1 * abs(root)
    # a disc is shown about no point that is further from every root than it is wide
    other = holds_root(exact(late), root * 1.5)
    assert other is None or abs(root * 0.5) <= other


def test_a_root_is_followed_from_where_there_is_no_dead_time():
    """A spring of 291 N/m that is 0.076 s late, beside what damps: at T = 0 its roots decay."""
    late = {0.0: np.array([1.0, 3.452, 2.443, 0.3395]), 0.07643: np.array([291.1, 209.3])}
    root = rightmost_root(late)
    assert root.real > 1 and holds_root(exact(late), root) is not None
