"""Repeated rows: rows in which no channel has a new reading; they are read as lost.

A body at rest repeats its position, and a command may be constant or follow the position. A force
measured with noise repeats only if all channels repeat. Repeated rows are lost rows if the readings
seldom repeat separately, or if a position stops for one row and then continues. Many repeated rows
may be a rest: these are lost rows only if a reading jumps afterwards by the motion in between.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .encoder import reading_step
from .row_places import Array

#: a row in which all readings repeat may be lost if the probability of this by chance is at most
#: this. Rows count as lost only if they are more than this share of all rows
ALONE = 0.001
#: rows to either side that show how often each channel repeats alone
BESIDE = 25
#: if more than this share of the rows repeat, the log has a slower source, which is another case
MOST = 0.2
#: part of the changes that must be in step with the slower source, and their largest distance from
#: the step, in its periods: of rows that repeat at random, 0.6 lie as near
IN_STEP, OFF_STEP = 0.95, 0.3
#: fewest changes that show the period of a source
READINGS = 50
#: smallest change from sample to sample that counts as motion, in steps between values
STEPS = 3.0
#: samples to either side for the usual size of a change
NEAR = 10
#: change at the end of a constant stretch, in usual changes before it, that shows a stuck reading
LEAP = 5.0
#: fewest samples of a constant stretch that is called stuck, or is a rest; shorter ones are repeats
LASTING = 10

#: probability of a zero among normal changes, times median change over step: density at zero
_ZERO = 0.3989 * 0.6745
#: probability that a sound channel is called stuck
STUCK_BY_CHANCE = 1e-3


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
    steps = [reading_step(x) for x in positions]
    stopped = np.zeros(count, dtype=bool)
    for x, step in zip(positions, steps, strict=True):
        stopped[repeats(x, step)] = True
    short = (past - first < LASTING) & (first > 0) & (past < len(same))
    noisy = [f for f in forces if np.mean(np.diff(f)[~same] == 0) <= ALONE]
    unlikely = _chance_of_repeats([*positions, *forces], same, first, past) <= ALONE
    unlikely &= np.count_nonzero(unlikely & short) > ALONE * len(same)
    inside = short & (unlikely | bool(noisy) | stopped[past])
    lasting = np.flatnonzero(past - first >= LASTING)
    stuck = np.zeros(count, dtype=bool)
    if len(lasting):
        for x, step in zip(positions, steps, strict=True):
            for a, b in stuck_stretches(x, step, "position"):
                stuck[a + 1 : b] = True
    for k in lasting:
        a, b = int(first[k]), int(past[k])
        inside[k] = bool(stuck[a + 1 : b + 1].all())
        inside[k] |= any(_leaps(x, a, b, s) for x, s in zip(positions, steps, strict=True))
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
    if len(changed) < READINGS or len(changed) > (1.0 - MOST) * len(stamps):
        return none
    at = stamps[changed]
    between = np.diff(at)
    if not (between > 0).all():
        return none
    period = float(np.median(between))
    if period < 1.5 * float(np.median(np.diff(stamps))):  # a reading for each row, with rests
        return none
    count = np.concatenate([[0.0], np.cumsum(np.round(between / period))])
    slope, start = np.polyfit(count, at, 1)
    in_step = np.abs(at - start - slope * count) <= OFF_STEP * period
    leaps = [np.abs(x[changed] - x[changed - 1]) for x in positions]
    by_steps = any(
        np.median(leap[leap > 0]) > STEPS * reading_step(x)
        for x, leap in zip(positions, leaps, strict=True)
        if (leap > 0).any()
    )
    if in_step.mean() < IN_STEP or not by_steps:
        return none
    kept = none.copy()
    kept[changed] = True
    for k in np.flatnonzero(between > 1.6 * period):  # a rest, or lost rows
        first, past = changed[k], changed[k + 1]
        nth = np.floor((stamps[first:past] - stamps[first]) / period + 0.1)
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
    is_held = (size >= STEPS * step) & (into >= 0.5 * size) & (out >= 0.5 * size)
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
        leaps = leaps and (b + 1 >= len(change) or abs(change[b + 1]) < 0.5 * abs(change[b]))
        if quantity == "position":
            slowing = abs(change[a - 1] - change[a - 3]) / 2
            dead = abs(change[a - 1]) > max(STEPS * step, LEAP * slowing)
            is_stuck = dead and (leaps or ends)
        else:
            chance = (b - a) * np.log(_ZERO * step / usual)
            is_stuck = bool(chance < np.log(STUCK_BY_CHANCE / len(x)))
        if is_stuck:
            stretches.append((a, b + 1))
    return stretches


def _chance_of_repeats(
    read: Sequence[Array], same: NDArray[np.bool_], first: NDArray[np.intp], past: NDArray[np.intp]
) -> Array:
    """Probability of each run: that all readings repeat at once, from their repeats beside the run.

    Commands are not counted; where a position repeats, a command that follows it repeats as well.
    """
    low, high = np.maximum(first - BESIDE, 0), np.minimum(past + BESIDE, len(same))

    def beside(rows: NDArray[np.bool_]) -> Array:
        counted = np.r_[0, np.cumsum(rows)]
        return np.asarray(counted[high] - counted[low], dtype=float)

    whole, chance = beside(~same), np.ones(len(first))
    for y in read:
        chance = chance * (beside((np.diff(y) == 0) & ~same) + 0.5) / (whole + 1.0)
    return chance


def _leaps(x: Array, first: int, past: int, step: float) -> bool:
    """Whether a reading stands still from row `first` to `past` and jumps once afterwards."""
    near = int(LEAP)
    if first < near or past + 1 + near > len(x) - 1:
        return False
    change = np.abs(np.diff(x[first - near : past + 2 + near]))
    before, leap, after = change[:near], change[-near - 1], change[-near:]
    return bool(leap > LEAP * max(np.median(before), np.median(after), step))
