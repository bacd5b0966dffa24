"""Signals of a log on the even grid of a record, each by the rule for its quantity.

A command holds until the next row; the value of a sample is the mean of the command over the
sample. A position is interpolated where it moves fast. Where it moves by few encoder steps, the
line between readings is rounded to such steps. Other measured signals follow the straight line.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from .encoder import Array
from .record_clock import RecordClock

Rule = Literal["held", "position", "line"]

#: encoder steps between two rows up to which interpolated readings are rounded to whole steps. In
#: faster motion the rounding of a reading is small against the motion between two rows
STEPS = 2.5


def resample_on_grid(
    values: Array,
    clock: RecordClock,
    rule: Rule,
    *,
    step: float,
    delay: float,
    stamps: Array | None = None,
) -> Array:
    """A signal (m,), one value per used row, on the record's grid (n,).

    step: of the encoder, 0 for none;  delay: s by which the log has the signal late
    stamps: (m,) s, of a signal with a clock of its own;  default: those of the rows
    """
    if stamps is None and clock.exact and not clock.stamped and delay == 0.0:
        return values
    out, h = np.empty(len(clock.time)), clock.sample_time
    for rows, samples in zip(clock.of_rows, clock.segments, strict=True):
        begin, place = clock.time[samples.start], clock.places[rows] - samples.start
        at = place.astype(np.float64)
        if stamps is not None:
            at = (stamps - begin) / h
        elif clock.stamped:
            at = (clock.stamps[rows] - begin) / h
            if clock.set_back:
                at += place[0] - at[0]
        out[samples] = interpolate_by_rule(
            values if stamps is not None else values[rows],
            at - delay / h,
            np.arange(samples.stop - samples.start, dtype=np.float64),
            rule,
            step=step,
            slower_clock=stamps is not None,
        )
    return out


def interpolate_by_rule(
    values: Array, at: Array, grid: Array, rule: Rule, *, step: float, slower_clock: bool = False
) -> Array:
    """Values (m,) at ascending instants `at` (m,), interpolated by their rule at `grid` (n,).

    at, grid: in samples;  step: of the encoder, 0 for none
    slower_clock: the signal is slower than the grid: gaps above one sample are no lost rows
    """
    if len(at) == len(grid) and np.array_equal(at, grid):
        return values
    if rule == "held":
        return _average_held(*((values, at) if slower_clock else _fill_held(values, at)), grid)
    if rule == "position":
        return _position(values, at, grid, step, slower_clock)
    return np.interp(grid, at, values)


def _fill_held(values: Array, at: Array) -> tuple[Array, Array]:
    """Held values and their instants, with straight lines where rows are lost.

    A lost row had a different command: the straight line between its neighbours errs half as much
    as the older command held on.
    """
    steps = np.rint(np.diff(at)).astype(np.intp)
    if np.all(steps <= 1):
        return values, at
    between = [
        np.linspace(a, b, k + 1)[1:-1]
        for a, b, k in zip(at[:-1], at[1:], steps, strict=True)
        if k > 1
    ]
    new = np.concatenate(between)
    whole = np.concatenate([at, new])
    order = np.argsort(whole, kind="stable")
    return np.concatenate([values, np.interp(new, at, values)])[order], whole[order]


def _average_held(values: Array, at: Array, grid: Array) -> Array:
    """Mean over each sample of a command that holds from each instant to the next."""
    if len(at) == len(grid) and np.array_equal(at, grid):
        return values
    edges = np.append(grid, grid[-1] + 1.0)
    ends = np.append(at, max(at[-1] + 1.0, edges[-1]))
    total = np.concatenate([[0.0], np.cumsum(values * np.diff(ends))])
    # assumption: the first command was held before the first row
    early = np.minimum(edges - ends[0], 0.0) * values[0]
    mean: Array = np.diff(np.interp(edges, ends, total) + early) / np.diff(edges)
    return mean


def _position(
    values: Array, at: Array, grid: Array, step: float, slower_clock: bool = False
) -> Array:
    """Local cubic through four readings; where these are few steps apart, a line in such steps.

    slower_clock: readings are so far apart that the motion between them bends, also in steps
    """
    right = np.clip(np.searchsorted(at, grid), 1, len(at) - 1)
    left = right - 1
    part = np.clip((grid - at[left]) / (at[right] - at[left]), 0.0, 1.0)
    smooth = (
        cubic_through_four(values, at, grid, left) if len(at) > 3 else np.interp(grid, at, values)
    )
    # beyond the ends the last reading is kept
    smooth = np.where(grid < at[0], values[0], np.where(grid > at[-1], values[-1], smooth))
    if step == 0.0:
        return np.where(values[right] == values[left], values[left], smooth)
    slow = np.abs(values[right] - values[left]) <= STEPS * step * (at[right] - at[left])
    way = smooth - values[left] if slower_clock else part * (values[right] - values[left])
    return np.where(slow, values[left] + step * np.rint(way / step), smooth)


def cubic_through_four(values: Array, at: Array, grid: Array, left: NDArray[np.intp]) -> Array:
    """The cubic through four values (m,) at `at`, two on each side where they are, at `grid` (n,).

    left: index of the last value before each point of the grid
    """
    first = np.clip(left - 1, 0, len(at) - 4)
    nodes = [at[first + k] for k in range(4)]
    total = np.zeros(len(grid))
    for k in range(4):
        weight = np.ones(len(grid))
        for j in range(4):
            if j != k:
                weight *= (grid - nodes[j]) / (nodes[k] - nodes[j])
        total += weight * values[first + k]
    return total


def filling_error(values: Array, clock: RecordClock, rule: Rule, *, step: float) -> float:
    """Rms error of a filled row, from each fifth row, filled as if it were lost."""
    error: list[Array] = []
    for rows in clock.of_rows:
        x, place = values[rows], clock.places[rows] - clock.places[rows.start]
        gone = np.arange(2, len(x) - 2, 5)
        gone = gone[place[gone + 2] - place[gone - 2] == 4]
        at, grid = np.delete(place, gone).astype(float), np.arange(place[-1] + 1.0)
        made = interpolate_by_rule(np.delete(x, gone), at, grid, rule, step=step)
        error.append(made[place[gone]] - x[gone])
    every = np.concatenate(error)
    return float(np.sqrt(np.mean(every**2))) if len(every) else float("nan")
