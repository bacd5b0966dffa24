"""Time and travel since a body last set off, and how long it had rested before."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..measurement.filtering import Array


@dataclass(frozen=True)
class SinceReversal:
    """Per sample (n,); zero, and `known` false, before the first motion that can be told.

    time: s since the body set off in its present direction;  travel: path since then (SI)
    rested: s for which no motion could be told before it set off
    """

    time: Array
    travel: Array
    rested: Array
    known: NDArray[np.bool_]


def since_reversal(
    direction: NDArray[np.int8], position: Array, *, sample_time: float, rest: float
) -> SinceReversal:
    """Look back from each sample to where the present motion began.

    direction: +1, -1, or 0 where no motion can be told;  position: (n,)
    rest: s without a told motion after which the same direction counts as a new start
    """
    n = len(direction)
    moving = np.flatnonzero(direction)
    zero = np.zeros(n)
    if not len(moving):
        return SinceReversal(zero, zero, zero, np.zeros(n, dtype=bool))
    gap = np.diff(moving, prepend=moving[0]) * sample_time
    turned = np.diff(direction[moving].astype(int), prepend=0) != 0
    onset = turned | (gap > rest)
    first = moving[onset]
    last = np.searchsorted(first, np.arange(n), side="right") - 1
    known = last >= 0
    began = first[np.maximum(last, 0)]
    before = gap[onset][np.maximum(last, 0)]
    return SinceReversal(
        time=np.where(known, (np.arange(n) - began) * sample_time, 0.0),
        travel=np.where(known, np.abs(position - position[began]), 0.0),
        rested=np.where(known, before, 0.0),
        known=known,
    )
