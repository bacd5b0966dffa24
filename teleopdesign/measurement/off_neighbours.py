"""How far a position is off the curve through its neighbours, and what late rows make of it."""

from __future__ import annotations

from copy import copy

import numpy as np

from .record_clock import Array


class OffNeighbours:
    """How far each row of a position is off the curve through four neighbours, by its stamps."""

    def __init__(self, stamps: Array, x: Array) -> None:
        rows = np.arange(2, len(x) - 2)
        nodes = rows[:, None] + np.array([0, -2, -1, 1, 2])
        at = stamps[nodes] - stamps[rows][:, None]
        weights = np.ones((len(rows), 5))
        for j in range(1, 5):
            for k in range(1, 5):
                if k != j:
                    weights[:, j] *= -at[:, k] / (at[:, j] - at[:, k])
            weights[:, j] *= -1.0
        self.middle = float(0.5 * (stamps[0] + stamps[-1]))
        self.stamps, self.nodes, self.weights = stamps, nodes, weights
        self.off = np.sum(weights * x[nodes], axis=1)
        self.speed = _speed(stamps, x)
        self.rows = np.arange(len(rows))

    def some(self, count: int) -> OffNeighbours:
        """The same of at most so many rows, evenly over the log."""
        less = copy(self)
        less.rows = self.rows[:: max(1, -(-len(self.rows) // count))]
        return less

    def made(self, period: float, phase: float) -> Array:
        """What reading the tick before each stamp puts a row off its neighbours, at speed 1."""
        nodes = self.nodes[self.rows]
        late = (self.stamps[nodes] - phase) % period
        return np.asarray(-np.sum(self.weights[self.rows] * late * self.speed[nodes], axis=1))

    def left(self, period: float, phase: float) -> float:
        """Squares that are left of the distances, where rows are those of the ticks."""
        return float(np.sum((self.off[self.rows] - self.made(period, phase)) ** 2))

    def fit(self, period: float, phase: float) -> tuple[float, float, float]:
        """Part of the squares that ticks explain, the speed they say, and its standard error."""
        made, off = self.made(period, phase), self.off[self.rows]
        below = float(made @ made)
        if below <= 0:
            return 0.0, 0.0, np.inf
        slope = float(made @ off) / below
        left = float(np.sum((off - slope * made) ** 2))
        error = np.sqrt(5.0 * left / len(off) / below)
        return 1.0 - left / float(off @ off), slope, float(error)


def _speed(stamps: Array, x: Array) -> Array:
    """Speed (n,) at each row: slope of the line through it and three rows to either side."""
    speed = np.zeros(len(x))
    count = 7
    kernel = np.ones(count)
    t = stamps - stamps[0]

    def total(y: Array) -> Array:
        return np.convolve(y, kernel, mode="valid")

    mean_t, mean_x = total(t) / count, total(x) / count
    above = total(t * x) / count - mean_t * mean_x
    below = total(t * t) / count - mean_t**2
    speed[3:-3] = above / below
    speed[:3], speed[-3:] = speed[3], speed[-4]
    return speed
