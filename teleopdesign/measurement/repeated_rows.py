"""Repeated rows: rows in which no channel has a new reading; they are read as lost.

A body at rest repeats its position, and a command may be constant or follow the position. A force
measured with noise repeats only if all channels repeat. Repeated rows are lost rows if there is
such a force, or if a position stops for a row and then continues. Many repeated rows are a rest, or
channels that are stuck (`stuck_stretches`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .channel import Channel
from .encoder import CHANGES, STEPS, Array, reading_step
from .limits import HALF, SMALL
from .record_clock import places_of, slope_of
from .stamps import usual_step
from .tables import LogColumns

#: probability by chance up to which a channel is stuck, and share of the rows up to which a force
#: with noise repeats alone
BY_CHANCE = 1e-3
#: part of the rows that a log may lose. Where more of them repeat, or lack a number in some cell,
#: the log or a column has a slower source
MOST = 0.2
#: samples to either side for the usual size of a change
NEAR = 10
#: change at the end of a constant stretch, in usual changes before it, that shows a stuck reading
LEAP = 5.0
#: fewest samples of a constant stretch that is called stuck, or is a rest; shorter ones are repeats
LASTING = 10

#: probability of a zero among normal changes, times median change over step: density at zero
_ZERO = 0.3989 * 0.6745
#: quantities that a sensor reads, also where it is slower than the controller
SENSED = ("position", "interaction_force")
#: part of the rate of the rows below which a sensor counts as slower: its readings are interpolated
SLOWER = 0.99


def runs_of(mask: NDArray[np.bool_]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """First index of each run of True, and the index after its last."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    return edges[::2], edges[1::2]


def repeated_rows(
    channels: Sequence[Array], positions: Sequence[Array] = (), forces: Sequence[Array] = ()
) -> NDArray[np.bool_]:
    """Mask (n,) of the rows that repeat the row before because no new reading was there.

    channels: (n,) each, of the same rows, without the time
    positions, forces: the channels among them that are measured, not commanded
    """
    count = len(channels[0]) if channels else 0
    out = np.zeros(count, dtype=bool)
    if len(channels) < 2 or count < 2:
        return out
    same = np.logical_and.reduce([np.diff(y) == 0 for y in channels])
    if not same.any() or same.mean() > MOST:  # at rest all rows are equal
        return out
    first, past = runs_of(same)
    stopped = np.zeros(count, dtype=bool)
    for x in positions:
        stopped[repeats(x, reading_step(x))] = True
    short = (past - first < LASTING) & (first > 0) & (past < len(same))
    noisy = [f for f in forces if np.mean(np.diff(f)[~same] == 0) <= BY_CHANCE]
    inside = short & (bool(noisy) | stopped[past])
    for a, b in zip(first[inside].tolist(), past[inside].tolist(), strict=True):
        out[a + 1 : b + 1] = True
    return out


def rows_between_readings(
    channels: Sequence[Array], positions: Sequence[Array], stamps: Array
) -> NDArray[np.bool_]:
    """Mask (n,) of the rows that a log wrote before its source had a new reading.

    One row of each reading is not marked. Such a source changes all channels in the same rows, a
    fixed period apart, and positions change by several steps at once; the steps of a slow encoder
    come one by one. Where all channels rest, one row in each period is not marked.

    channels, positions: (n,) each, as in `repeated_rows`;  stamps: (n,) s
    returns: all False where the log has no such source
    """
    none = np.zeros(len(stamps), dtype=bool)
    if not channels or len(stamps) < 2:
        return none
    changed = np.flatnonzero(~np.logical_and.reduce([np.diff(y) == 0 for y in channels])) + 1
    if len(changed) < CHANGES or len(changed) > (1.0 - MOST) * len(stamps):
        return none
    at = stamps[changed]
    leaps = [np.abs(x[changed] - x[changed - 1]) for x in positions]
    by_steps = any(
        np.median(leap[leap > 0]) > STEPS * reading_step(x)
        for x, leap in zip(positions, leaps, strict=True)
        if (leap > 0).any()
    )
    placed = places_of([at]) if by_steps and (np.diff(at) > 0).all() else None
    if placed is None:
        return none
    period = slope_of([at], placed)
    if round(period / usual_step(np.diff(stamps))) < 2:  # a reading for each row, with rests
        return none
    kept = none.copy()
    kept[changed] = True
    for k in np.flatnonzero(np.diff(placed[0]) > 1):  # a rest, or lost rows
        first, past = changed[k], changed[k + 1]
        nth = np.floor((stamps[first:past] - stamps[first]) / period + SMALL)
        kept[first:past] |= np.diff(nth, prepend=0.0) > 0
    return ~kept


def repeats(x: Array, step: float) -> NDArray[np.intp]:
    """Samples of a position that repeat the sample before although the body moves.

    Before and after the hold, the reading changes by at least half of the usual change there, in
    the same direction: no body stops and starts within a sample.
    """
    change = np.diff(x)
    first, past = runs_of(change == 0)
    inside = (first > 0) & (past < len(change)) & (past - first < LASTING)
    first, past = first[inside], past[inside]
    low, high = np.maximum(first - NEAR, 0), np.minimum(past + NEAR, len(x) - 1)
    usual = (x[high] - x[low]) / (high - low)
    way, size = np.sign(usual), np.abs(usual)
    into, out = way * change[first - 1], way * change[past]
    is_held = (size >= STEPS * step) & (np.minimum(into, out) >= HALF * size)
    pairs = zip(first[is_held].tolist(), past[is_held].tolist(), strict=True)
    rows = [np.arange(a, b) + 1 for a, b in pairs]
    return np.concatenate(rows) if rows else np.zeros(0, dtype=np.intp)


def stuck_stretches(x: Array, step: float, quantity: str) -> list[tuple[int, int]]:
    """(first, one past the last) sample of each hold that only a stuck channel explains.

    quantity: a position counts as stuck if it stops abruptly and jumps afterwards or never moves
        again; a command never does; any other measured quantity does if its noise vanishes
    """
    if quantity == "actuator_force":
        return []
    change = np.diff(x)
    first, past = runs_of(change == 0)
    lasting = (past - first >= LASTING) & (first >= 5)
    stretches = []
    for a, b in zip(first[lasting].tolist(), past[lasting].tolist(), strict=True):
        before = np.abs(change[a - 5 : a])
        usual = float(np.median(before))
        if usual < STEPS * step:
            continue
        ends = b == len(change)
        leaps = not ends and abs(change[b]) > LEAP * max(usual, step)
        # a stuck reading jumps once; a body that rested at a reversal continues with similar steps
        leaps = leaps and (b + 1 >= len(change) or abs(change[b + 1]) < HALF * abs(change[b]))
        if quantity == "position":
            slowing = abs(change[a - 1] - change[a - 3]) / 2
            dead = abs(change[a - 1]) > max(STEPS * step, LEAP * slowing)
            is_stuck = dead and (leaps or ends)
        else:
            chance = (b - a) * np.log(_ZERO * step / usual)
            is_stuck = bool(chance < np.log(BY_CHANCE / len(x)))
        if is_stuck:
            stretches.append((a, b + 1))
    return stretches


def with_slower_signals(
    columns: LogColumns, channels: Sequence[Channel], stamps: Array
) -> LogColumns:
    """The columns; those of slower bodies and sensors have one value and stamp for each reading.

    A program that joins the messages of several devices repeats those of the slower one until its
    next reading. Held readings would look like a motion in steps on a clock that jitters.

    stamps: (n,) s, of the rows
    Where all channels change together, the whole log has a slower source, and its rows are left out
    instead (`clock_of_log`). A command that alone changes seldom is held by its controller, and
    stays as it is.
    """
    usable = len(stamps) and np.isfinite(stamps).all()
    if not usable or _reads_slowly(columns, channels, stamps).any():
        return columns
    bodies = dict.fromkeys(ch.body for ch in channels if ch.body is not None)
    sources = [[ch for ch in channels if ch.body == body] for body in bodies if len(bodies) > 1]
    for signals in sources + [[ch] for ch in channels if ch.quantity in SENSED]:
        between = _reads_slowly(columns, signals, stamps)
        if between.any():
            values, slow_stamps = dict(columns.values), dict(columns.stamps)
            for column in _columns(columns, signals):
                values[column] = columns.values[column][~between]
                slow_stamps[column] = stamps[~between]
            columns = replace(columns, values=values, stamps=slow_stamps)
    return columns


def _columns(columns: LogColumns, signals: Sequence[Channel]) -> list[str]:
    """Columns of signals on the clock of the log."""
    every = {c for s in signals if s.body is not None for c in s.columns}
    return sorted(c for c in every if c not in columns.stamps)


def _reads_slowly(columns: LogColumns, signals: Sequence[Channel], stamps: Array) -> np.ndarray:
    """Mask (n,) of the rows between two readings of these signals; none where a cell is empty."""
    sensed = _columns(columns, [s for s in signals if s.quantity == "position"] or signals)
    every = [columns.values[c] for c in _columns(columns, signals)]
    if not all(len(x) == len(stamps) and np.isfinite(x).all() for x in every):
        return np.zeros(len(stamps), dtype=bool)
    return rows_between_readings(every, [columns.values[c] for c in sensed], stamps)
