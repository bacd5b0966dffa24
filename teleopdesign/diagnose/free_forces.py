"""Free functions of the motion, as sums of forces with unknown factors.

Each is a set of ridge splines or of memories: of the velocity in each direction, of the position,
and of the past since the last reversal. Their knots come from the motion of the fit records.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline

from ..measurement.filtering import Array
from ..measurement.motion import Motion

#: splines over a variable that has both signs, or none
SPLINES = 8
#: splines over the speed, in each direction
OF_SPEED = 6
#: travels and times over which the past is forgotten
MEMORIES = 4


@dataclass(frozen=True)
class MotionRanges:
    """Ranges of the motion of one body on its fit records, for the knots of splines.

    position: least and largest;  speed: largest
    step: of a reading of the position;  fast: s, shortest memory
    """

    position: tuple[float, float]
    speed: float
    step: float
    fast: float

    @classmethod
    def of(cls, motions: Sequence[Motion]) -> MotionRanges:
        if not motions:
            return cls((0.0, 1.0), 1.0, 1.0, 1.0)
        low = min(float(m.position.min()) for m in motions)
        high = max(float(m.position.max()) for m in motions)
        speed = max(float(np.abs(m.velocity).max()) for m in motions)
        first = motions[0]
        fast = 1.0 / (2.0 * np.pi * first.bandwidth)
        return cls((low, high), speed or 1.0, max(m.step for m in motions), fast)

    @property
    def travel(self) -> float:
        """Largest change of the position."""
        return max(self.position[1] - self.position[0], self.step)


#: (motion, ranges) -> forces (c, n) that a free function is a sum of
FreeForce = Callable[[Motion, MotionRanges], Array]


def _splines(u: Array, low: float, high: float, count: int) -> Array:
    """Cubic splines (count, n) over low to high; constant beyond."""
    knots = np.linspace(low, high, count - 2)
    step = knots[1] - knots[0]
    knots = np.concatenate([low - step * np.arange(3, 0, -1), knots, high + step * np.arange(1, 4)])
    inside = np.clip(u, low, high - 1e-9 * (high - low))
    basis = BSpline.design_matrix(inside, knots, 3).toarray()
    return np.array(basis.T, dtype=float)


def _curve_of_position(motion: Motion, ranges: MotionRanges) -> Array:
    low, high = ranges.position
    return _splines(motion.position, low, max(high, low + ranges.step), SPLINES)


def _curve_of_velocity(motion: Motion, ranges: MotionRanges) -> Array:
    """A curve over the speed in each direction; finer at low speeds, where friction changes."""
    over = _splines(np.sqrt(np.abs(motion.velocity) / ranges.speed), 0.0, 1.0, OF_SPEED)
    return np.vstack([(motion.direction == 1) * over, (motion.direction == -1) * over])


def _memory(motion: Motion, ranges: MotionRanges) -> Array:
    """Forces in the direction of motion that fade with travel, or time, since it last turned."""
    direction = motion.direction.astype(float)
    turned = np.flatnonzero(np.diff(direction, prepend=0.0) != 0.0)
    last = np.zeros(len(direction), dtype=np.intp)
    last[turned] = turned
    last = np.maximum.accumulate(last)
    travel = np.abs(motion.position - motion.position[last])
    elapsed = motion.time - motion.time[last]
    travels = np.geomspace(max(ranges.step, 1e-3 * ranges.travel), ranges.travel, MEMORIES)
    times = ranges.fast * np.geomspace(1.0, 100.0, MEMORIES)
    fading: Array = np.vstack(
        [np.exp(-travel[None] / travels[:, None]), np.exp(-elapsed[None] / times[:, None])]
    )
    return direction * fading


def _memory_and_derivatives(motion: Motion, ranges: MotionRanges) -> Array:
    command = motion.at_rows(motion.command)
    spectrum = motion.spectrum
    more = [
        motion.acceleration,
        spectrum.multiply(motion.acceleration, spectrum.derivative(1)),
        spectrum.multiply(command, spectrum.derivative(1)),
        spectrum.multiply(command, spectrum.derivative(2)),
    ]
    return np.vstack([_memory(motion, ranges), *more])


_ALL: Mapping[str, FreeForce] = {
    "velocity": _curve_of_velocity,
    "position": _curve_of_position,
    "position and direction": lambda m, r: m.direction * _curve_of_position(m, r),
    "position and velocity": lambda m, r: m.velocity / r.speed * _curve_of_position(m, r),
    "the past": _memory,
    "the past and derivatives": _memory_and_derivatives,
}


def families(motion: Motion) -> Mapping[str, FreeForce]:
    """The free functions of a motion: on a friction curve those of the velocity alone."""
    return {n: f for n, f in _ALL.items() if n == "velocity" or not motion.is_curve}
