"""Spikes: lone readings far off the course of all others, as of a disturbed bus or encoder.

No body and no sensor makes such a reading: it is read as lost, and filled by the curve through its
neighbours. Readings are spikes only if the least of them is `GAP` times as far off as every other
reading of the stretch. Steps, impacts of several rows and chatter are therefore none.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .encoder import Array, reading_step
from .limits import FEWEST, HALF, SMALL
from .repeated_rows import runs_of
from .resample import cubic_through_four

Mask = NDArray[np.bool_]

#: rows whose median is the course of a reading: of seven, three may be spikes
NEAR = 7
#: a spike is at least so many times as far off the course as any reading that is none
GAP = 4.0
#: most of the readings that are spikes: of more, seven rows hold four too often
MOST = 0.05
#: most successive spikes: an impact or a stretch without signal lasts longer. Of many spikes,
#: three follow one another by chance; then so do as many as are expected in `BY_CHANCE` records;
#: and the probability that spikes are taken for contacts by chance
LONGEST, BY_CHANCE = 2, 0.01


def filled_spikes(
    values: Array, step: float, parts: Sequence[slice], position: Array | None = None
) -> tuple[Array, Mask]:
    """Readings (n,) with their spikes filled, and the mask (n,) of these.

    parts: uninterrupted stretches;  position: of the body (n,), where the readings are a force
    """
    out, spikes = values.copy(), np.zeros(len(values), dtype=bool)
    for part in parts:
        x = values[part]
        odd = find_spikes(x, step)
        if not odd.any() or (position is not None and are_contacts(odd, position[part])):
            continue
        out[part], spikes[part] = fill_spikes(x, odd), odd
    return (out, spikes) if spikes.any() else (values, spikes)


def lost_zeros(position: Array) -> Mask:
    """Mask (n,) of the readings 0 of a position that stand for none: it leaps there and back.

    Each leap is larger than any other change of a reading, the largest of them `GAP` times. A body
    that passes zero, or rests there, comes to it as it moves elsewhere.
    """
    zero, lost = position == 0.0, np.zeros(len(position), dtype=bool)
    change = np.abs(np.diff(position))
    other = change[~(zero[1:] | zero[:-1]) & np.isfinite(change)]
    first, past = runs_of(zero)
    inner = (first > 0) & (past < len(zero))
    first, past = first[inner], past[inner]
    if not len(first) or not len(other):
        return lost
    least = max(float(other.max()), GAP * reading_step(position[np.isfinite(position)]))
    leaps = np.minimum(change[first - 1], change[past - 1])
    if leaps.max() > GAP * least:
        for a, b in zip(first[leaps > least], past[leaps > least], strict=True):
            lost[a:b] = True
    return lost


def find_spikes(x: Array, step: float) -> Mask:
    """Mask (n,) of the spikes among successive readings of one channel.

    step: smallest step between readings
    """
    none = np.zeros(len(x), dtype=bool)
    if len(x) < FEWEST:
        return none
    off = np.abs(x - _course(x))
    order = np.argsort(-off, kind="stable")[: int(MOST * len(x)) + 1]
    size = np.maximum(off[order], max(step, np.finfo(float).tiny))
    for last in np.flatnonzero(size[:-1] >= GAP * size[1:])[::-1]:
        spikes = none.copy()
        spikes[order[: last + 1]] = True
        if _are_lone(x, spikes):
            return spikes
    return none


def are_contacts(spikes: Mask, position: Array) -> bool:
    """Whether the spikes of a force (n,) lie where the velocity of the body (n,) changes most."""
    from scipy.special import bdtrc

    first, past = _inner_runs(spikes)
    if not len(first):
        return False
    rows = np.arange(NEAR // 2, len(position) - NEAR // 2)
    usual = np.sort(_change_of_slope(position, rows, rows + 1))
    changes = _change_of_slope(position, first, past)
    larger = np.sort(1.0 - np.searchsorted(usual, changes, side="left") / len(usual))
    half = (len(larger) + 1) // 2
    share = float(larger[half - 1])
    return share <= SMALL and float(bdtrc(half - 1, len(larger), share)) < BY_CHANCE


def fill_spikes(x: Array, spikes: Mask) -> Array:
    """The readings (n,) with each spike on the cubic through the four nearest other readings."""
    good, odd, out = np.flatnonzero(~spikes), np.flatnonzero(spikes), x.copy()
    left = np.searchsorted(good, odd) - 1
    out[odd] = cubic_through_four(x[good], good.astype(float), odd.astype(float), left)
    return out


def _course(x: Array) -> Array:
    """The median of the rows about each reading (n,); at the ends the parabola through medians."""
    course, half = x.copy(), NEAR // 2
    about = np.lib.stride_tricks.sliding_window_view(x, NEAR)
    course[half:-half] = np.partition(about, half)[:, half]
    nodes = half + NEAR * np.arange(3)
    for side in (course, course[::-1]):
        parabola = np.polyfit(nodes, side[nodes], 2)
        side[:half] = np.polyval(parabola, np.arange(half))
    return course


def _are_lone(x: Array, spikes: Mask) -> bool:
    """Whether each run of spikes is short, and the readings beside it go on as if without it."""
    first, past = runs_of(spikes)
    longest = int((past - first).max())
    if longest > LONGEST and len(x) * float(spikes.mean()) ** longest < BY_CHANCE:
        return False
    y = fill_spikes(x, spikes)
    # beside the ends of the record only the size counts: a first reading alone may be a step
    first, past = _inner_runs(spikes)
    if not len(first):
        return False
    size = np.minimum(np.abs(x - y)[first], np.abs(x - y)[past - 1])
    before, after = _slopes(y, first, past)
    level = y[past] - y[first - 1] - 0.5 * (past - first + 1) * (before + after)
    return bool((np.maximum(np.abs(level), np.abs(after - before)) <= HALF * size).all())


def _inner_runs(spikes: Mask) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """First row of each run of spikes, and the row after it, of those with rows on both sides."""
    first, past = runs_of(spikes)
    inner = (first >= NEAR // 2) & (past <= len(spikes) - NEAR // 2)
    return first[inner], past[inner]


def _slopes(x: Array, first: NDArray[np.intp], past: NDArray[np.intp]) -> tuple[Array, Array]:
    """Change of x in a row, before row `first` and from row `past` on."""
    return 0.5 * (x[first - 1] - x[first - 3]), 0.5 * (x[past + 2] - x[past])


def _change_of_slope(x: Array, first: NDArray[np.intp], past: NDArray[np.intp]) -> Array:
    before, after = _slopes(x, first, past)
    return np.abs(after - before)
