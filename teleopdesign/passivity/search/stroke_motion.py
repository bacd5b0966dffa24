"""Motions made of strokes between turning points: sinusoids, stops with reversals, random paths."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import check_types
from ...simulate import Trajectory

Array = NDArray[np.float64]
#: the smallest motions of a search are smaller than the stroke by so many powers of ten
_DECADES = 3.0


@check_types
@dataclass(frozen=True)
class Strokes:
    """A motion from rest at 0 through turning points, round after round, back to rest at 0.

    A stroke of length d is half a cosine and takes the time pi d/(2 speed). With two turning points
    of opposite sign the motion is a sinusoid.

    points: turning points of one round, m or rad;  speed: peak speed of each stroke, m/s or rad/s
    rounds: how often the points are visited;  pause: rest at each turning point, s
    """

    points: tuple[float, ...]
    speed: float
    rounds: int = 4
    pause: float = 0.0

    @property
    def path(self) -> Array:
        """Position of every turning point from the first rest to the last, m or rad, (n,)."""
        return np.array([0.0, *(self.points * self.rounds), 0.0])

    @property
    def times(self) -> Array:
        """Time at which the motion leaves each turning point of `path`, s, (n,)."""
        lasting = np.pi * np.abs(np.diff(self.path)) / (2 * self.speed) + self.pause
        return np.concatenate([[0.0], np.cumsum(lasting)])

    @property
    def duration(self) -> float:
        """Time until the last rest, s."""
        return float(self.times[-1])

    @property
    def last_round(self) -> tuple[float, float]:
        """Begin and end of the last closed round, s: from a turning point back to the same one."""
        end = len(self.points) * self.rounds
        return float(self.times[end - len(self.points)]), float(self.times[end])

    def motion(self) -> Trajectory:
        """Position, velocity and acceleration as functions of time; at rest before and after."""
        return Trajectory(*(_Along(self, order) for order in range(3)))


@dataclass(frozen=True)
class _Along:
    """Position along strokes, or its first or second derivative, as a function of time."""

    strokes: Strokes
    order: int

    def __call__(self, t: Array) -> Array:
        times, path = self.strokes.times, self.strokes.path
        k = np.clip(np.searchsorted(times, t, side="right") - 1, 0, len(path) - 2)
        travel = np.diff(path)[k]
        lasting = np.maximum(np.diff(times)[k] - self.strokes.pause, 1e-300)
        angle = np.pi * np.clip((t - times[k]) / lasting, 0.0, 1.0)
        moving = (angle < np.pi) & (t >= 0)
        if self.order == 0:
            return np.asarray(path[k] + travel * (1 - np.cos(angle)) / 2)
        rate = np.pi / lasting
        shape = np.sin(angle) * rate if self.order == 1 else np.cos(angle) * rate**2
        return np.where(moving, travel / 2 * shape, 0.0)


def families(
    rng: np.random.Generator, *, stroke: float, speed: float, tries: int
) -> Iterator[tuple[str, Strokes]]:
    """Motions for a search: sinusoids on a grid, then stops with reversals, then random paths.

    stroke: largest position, m or rad;  speed: largest speed, m/s or rad/s
    tries: number of motions in all, about a third for each family
    yields: name of the family, and the motion
    """
    share = max(tries // 3, 1)
    across = max(int(np.sqrt(share)), 1)
    fractions = np.logspace(-_DECADES, 0.0, -(-share // across))
    for a in stroke * fractions:
        for v in speed * np.logspace(-2.0, 0.0, across)[::-1]:
            yield "sinusoid", Strokes((float(a), -float(a)), float(v))
    for _ in range(share):
        a, v = stroke * 10 ** rng.uniform(-_DECADES, 0), speed * 10 ** rng.uniform(-2, 0)
        back = a * 10 ** rng.uniform(-2, 0)
        points = (a, a - back, a, -a, back - a, -a)
        yield "stop and reverse", Strokes(tuple(map(float, points)), float(v))
    for _ in range(share):
        a, v = stroke * 10 ** rng.uniform(-_DECADES, 0), speed * 10 ** rng.uniform(-2, 0)
        path = a * rng.uniform(-1, 1, size=rng.integers(2, 9))
        yield "random path", Strokes(tuple(map(float, path)), float(v))
