"""Prescribed motions: a position with its velocity and acceleration."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any

import numpy as np

from ..base.arguments import check_types
from ..base.errors import ModelError
from ..base.frozen import ByValue

_FEWEST = 6  # samples that a quintic spline needs

TimeFunction = Callable[[np.ndarray], np.ndarray]


@check_types
@dataclass(frozen=True)
class Trajectory:
    """A motion as functions of time (s): position (m or rad) and its two derivatives.

    Each function takes and returns arrays (n,). `sine` and `sampled_motion` return a Trajectory. As
    an input of a simulation, a Trajectory is a force that varies like its position.
    """

    position: TimeFunction
    velocity: TimeFunction
    acceleration: TimeFunction

    def __call__(self, t: np.ndarray) -> np.ndarray:
        return self.position(t)

    @property
    def all(self) -> tuple[TimeFunction, TimeFunction, TimeFunction]:
        return self.position, self.velocity, self.acceleration


@dataclass(frozen=True)
class _Sinusoid:
    """size * sin(rate t + phase)"""

    size: float
    rate: float
    phase: float

    def __call__(self, t: np.ndarray) -> np.ndarray:
        return np.asarray(self.size * np.sin(self.rate * t + self.phase))


@dataclass(frozen=True)
class _Cosinusoid(_Sinusoid):
    """size * cos(rate t + phase)"""

    def __call__(self, t: np.ndarray) -> np.ndarray:
        return np.asarray(self.size * np.cos(self.rate * t + self.phase))


@dataclass(frozen=True, eq=False, repr=False)
class _Sampled(ByValue):
    """A derivative of the quintic spline through samples (n,), at rest beyond its ends."""

    time: np.ndarray
    position: np.ndarray
    order: int

    @cached_property
    def _spline(self) -> TimeFunction:
        from scipy.interpolate import make_interp_spline

        spline = make_interp_spline(self.time, self.position, k=5)
        function: TimeFunction = spline.derivative(self.order) if self.order else spline
        return function

    def __call__(self, t: np.ndarray) -> np.ndarray:
        first, last = self.time[0], self.time[-1]
        inside = self._spline(np.clip(t, first, last))
        return inside if self.order == 0 else np.where((t < first) | (t > last), 0.0, inside)

    def __getstate__(self) -> dict[str, Any]:
        return {f.name: getattr(self, f.name) for f in fields(self)}  # the spline is made anew

    def __repr__(self) -> str:
        return f"spline of {len(self.time)} samples, derivative {self.order}"


def sine(*, amplitude: float, frequency: float, phase: float = 0.0) -> Trajectory:
    """amplitude * sin(2 pi frequency t + phase); frequency in Hz, phase in rad.

    amplitude: of the position, m or rad;  frequency: Hz;  phase: rad, of the position
    returns: position, velocity and acceleration over time (s); `.position` is a signal for `inputs`

        >>> td.sine(amplitude=0.01, frequency=2.0).velocity(np.array([0.0])).round(4)
        array([0.1257])
    """
    omega = 2 * np.pi * frequency
    return Trajectory(
        _Sinusoid(amplitude, omega, phase),
        _Cosinusoid(omega * amplitude, omega, phase),
        _Sinusoid(-(omega**2) * amplitude, omega, phase),
    )


def sampled_motion(time: np.ndarray, position: np.ndarray) -> Trajectory:
    """A measured motion: quintic spline through the samples (n,), constant beyond the ends.

    time: s, increasing;  position: m or rad
    returns: position, velocity and acceleration over time (s), to be prescribed in `simulate`
    raises ModelError: other shapes, too few samples, or time that does not increase
    """
    time, position = np.asarray(time, dtype=float), np.asarray(position, dtype=float)
    if time.ndim != 1 or time.shape != position.shape or len(time) < _FEWEST:
        raise ModelError(
            f"sampled_motion: expected time and position (n,) with n >= {_FEWEST}, found shapes "
            f"{time.shape} and {position.shape}"
        )
    if not (np.all(np.diff(time) > 0) and np.all(np.isfinite(position))):
        raise ModelError("sampled_motion: expected times that grow and positions without NaN")
    return Trajectory(*(_Sampled(time, position, order) for order in range(3)))
