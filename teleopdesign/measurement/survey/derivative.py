"""How columns of a log go together: wraps, and what is the derivative of what."""

from __future__ import annotations

import math

import numpy as np

from ..filtering import spectrum
from ..first_guess import motion_columns
from .content import Array

#: correlation from which one column is the derivative of another
DERIVATIVE = 0.9


def unwrap_column(x: Array, jump: float | None) -> Array:
    """A column without its wraps."""
    return x if jump is None else np.asarray(np.unwrap(x, period=jump))


def wrap_of(x: Array) -> float | None:
    """Period at which a column wraps: that of jumps over most of its range; None: it does not."""
    reach = float(np.ptp(x))
    steps = np.diff(x)
    usual = float(np.quantile(np.abs(steps), 0.95))
    jumps = np.abs(steps[np.abs(steps) > max(0.6 * reach, 20.0 * usual)])
    if len(jumps) == 0 or reach == 0.0:
        return None
    jump = float(np.median(jumps))
    if np.any(np.abs(jumps - jump) > 0.1 * jump):
        return None
    turns = (360.0, 2 * math.pi, 1.0, 400.0, 180.0, math.pi)
    for period in (*turns, *(2.0**k for k in range(8, 33))):
        if abs(period - jump) < 0.1 * period and reach <= 1.001 * period:
            return period
    return None


def derivative_factor(x: Array, v: Array, sample_time: float) -> tuple[float, float]:
    """Factor and correlation of one column with the derivative of another."""
    s = spectrum(len(x), sample_time)
    low = s.lowpass(min(0.02 / sample_time, 20.0))
    rate = s.back(s.transform(x) * low * s.derivative(1))
    slow = s.multiply(v, low)
    inner = slice(len(x) // 50 + 1, -len(x) // 50 - 1)
    a, b = rate[inner] - rate[inner].mean(), slow[inner] - slow[inner].mean()
    power = float(a @ a)
    if power <= 0 or float(b @ b) <= 0:
        return 0.0, 0.0
    return float(a @ b) / power, float(a @ b) / math.sqrt(power * float(b @ b))


def follows_direction(x: Array, v: Array, sample_time: float) -> bool:
    """Whether a column goes by the direction of a motion rather than by its speed.

    So do friction, and the pressure that it needs.
    """
    velocity, _, direction = motion_columns(x, sample_time)
    inner = slice(len(x) // 50 + 1, -len(x) // 50 - 1)
    with np.errstate(invalid="ignore", divide="ignore"):
        alike = np.corrcoef([v[inner], velocity[inner], direction[inner]])[0]
    return bool(alike[2] > alike[1])
