"""Ranges of a curve where the device needs more force than the model, or less, with sizes.

The first ranges are those with most of the residual's squares, not those with the largest f: a
curve is large at its ends, where few rows are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..measurement.filtering import Array
from .curve import Curve

#: least part of all squares in a range that is named
NAMED = 0.1
#: part of the rows outside a range at an end, below which the range is said to reach this end
NONE_BEYOND = 0.02
#: most ranges that are named; and number of ranges from which the text says "goes up and down"
MOST, TURNS = 3, 4


@dataclass(frozen=True)
class SignRegion:
    """A range of the variable (SI) where f keeps its sign and at least half of its extreme value.

    low, high: infinite where the range continues to the end of the known values
    extreme: f of largest size in the range
    share: part of the squares of the whole curve, in the run where f has this sign
    backward: the variable is negative here
    """

    low: float
    high: float
    extreme: float
    share: float
    backward: bool


def regions_of(curve: Curve, *, signed: bool = False) -> tuple[SignRegion, ...]:
    """The ranges where f differs from zero by more than its band, largest share of squares first.

    signed: f has a separate branch for each sign of the variable
    """
    half = len(curve.x) // 2
    parts = [slice(None, half), slice(half, None)] if signed else [slice(None)]
    squares = curve.weight * curve.y**2
    whole = max(float(squares.sum()), 1e-300)
    regions = []
    for part in parts:
        x, y, low, high = (a[part] for a in (curve.x, curve.y, curve.low, curve.high))
        sure = np.where((low > 0) | (high < 0), np.sign(y), 0.0)
        for run in _runs(sure):
            share = float(squares[part][run].sum()) / whole
            regions.append(_region(x, y, run, share, curve.weight[part]))
    regions.sort(key=lambda r: -r.share)
    return tuple(regions)


def largest_regions(regions: tuple[SignRegion, ...]) -> tuple[SignRegion, ...]:
    """The first range, and further ones of more than a tenth of the squares, from low to high."""
    chosen = regions[:1] + tuple(r for r in regions[1:MOST] if r.share > NAMED)
    return tuple(sorted(chosen, key=lambda r: r.low))


def goes_up_and_down(regions: tuple[SignRegion, ...]) -> bool:
    """Whether the curve has too many ranges to name them one by one."""
    return sum(r.share > 0.5 * NAMED for r in regions) >= TURNS


def _runs(sign: Array) -> list[slice]:
    """Runs of one sign; an uncertain part between two runs of one sign does not separate them."""
    edges = np.flatnonzero(np.diff(sign)) + 1
    runs: list[slice] = []
    for a, b in zip([0, *edges], [*edges, len(sign)], strict=True):
        if sign[a] == 0:
            continue
        if runs and sign[runs[-1].start] == sign[a]:
            runs[-1] = slice(runs[-1].start, int(b))
        else:
            runs.append(slice(int(a), int(b)))
    return runs


def _region(x: Array, values: Array, run: slice, share: float, weight: Array) -> SignRegion:
    size = np.abs(values)
    top = run.start + int(np.argmax(size[run]))
    large = (size > 0.5 * size[top]) & (np.sign(values) == np.sign(values[top]))
    low = top - int(np.argmin(np.append(large[top::-1], False))) + 1
    high = top + int(np.argmin(np.append(large[top:], False))) - 1
    few = NONE_BEYOND * float(weight.sum())
    return SignRegion(
        low=-np.inf if weight[:low].sum() <= few else float(x[low]),
        high=np.inf if weight[high + 1 :].sum() <= few else float(x[high]),
        extreme=float(values[top]),
        share=share,
        backward=bool(x[top] < 0),
    )
