"""Prescribed motions: position with the velocity and acceleration that belong to it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

Function = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Motion:
    """A motion as functions of time (s): position (m or rad) and its two derivatives."""

    position: Function
    velocity: Function
    acceleration: Function

    @property
    def all(self) -> tuple[Function, Function, Function]:
        return self.position, self.velocity, self.acceleration


def sine(*, amplitude: float, frequency: float, phase: float = 0.0) -> Motion:
    """amplitude * sin(2 pi frequency t + phase); frequency in Hz, phase in rad."""
    omega = 2 * np.pi * frequency
    return Motion(
        lambda t: amplitude * np.sin(omega * t + phase),
        lambda t: omega * amplitude * np.cos(omega * t + phase),
        lambda t: -(omega**2) * amplitude * np.sin(omega * t + phase),
    )


def sampled_motion(time: np.ndarray, position: np.ndarray) -> Motion:
    """A measured motion: quintic spline through the samples (n,), constant beyond the ends."""
    from scipy.interpolate import make_interp_spline

    spline = make_interp_spline(time, position, k=5)
    first, second = spline.derivative(1), spline.derivative(2)

    def inside(f: Function, outside: float) -> Function:
        def value(t: np.ndarray) -> np.ndarray:
            found = f(np.clip(t, time[0], time[-1]))
            out = (t < time[0]) | (t > time[-1])
            return found if np.isnan(outside) else np.where(out, outside, found)

        return value

    return Motion(inside(spline, np.nan), inside(first, 0.0), inside(second, 0.0))
