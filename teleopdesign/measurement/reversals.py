"""Time and travel since the last reversal of a body, and the rest before it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .encoder import STEPS, reading_noise
from .filtering import Array
from .limits import ONE_WAY
from .motion import play


def runs_one_way(position: Array, step: float) -> bool:
    """Whether a body hardly comes back on its way, with all returns together.

    position: (n,), without leaps of whole turns;  step: of its readings
    """
    noise = reading_noise(position) if len(position) > 4 else 0.0
    followed = play(position, 2.0 * STEPS * max(step, noise))  # what moves within it moves nothing
    moves = np.diff(followed)
    forth, back = float(moves[moves > 0].sum()), float(-moves[moves < 0].sum())
    return min(forth, back) <= ONE_WAY * float(np.ptp(position))


def count_reversals(direction: NDArray[np.int8]) -> int:
    """Number of reversals of directions (n,): +1, -1, or 0 where no motion is certain."""
    return int(np.count_nonzero(np.diff(direction[direction != 0])))


@dataclass(frozen=True)
class SinceReversal:
    """For each sample (n,): time and travel since the last reversal, and the rest before it.

    time: s since the motion in the present direction began
    travel: distance from the position where it began (SI)
    rested: s without certain motion before it began
    known: False before the first certain motion; the other values are 0 there
    """

    time: Array
    travel: Array
    rested: Array
    known: NDArray[np.bool_]


def look_back_to_reversal(
    direction: NDArray[np.int8], position: Array, *, sample_time: float, rest: float
) -> SinceReversal:
    """Look back from each sample to the beginning of the present motion.

    direction: (n,) +1, -1, or 0 where no motion is certain;  position: (n,)
    rest: s without certain motion after which a motion in the same direction counts as a new start
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


def mark_reversals(direction: NDArray[np.int8], *, within: int) -> NDArray[np.bool_]:
    """Mask (n,) of the samples at most `within` samples before or after a reversal of the motion.

    direction: (n,) +1, -1, or 0 where no motion is certain
    """
    moving = np.flatnonzero(direction)
    turned = moving[1:][np.diff(direction[moving].astype(int)) != 0]
    edges = np.zeros(len(direction) + 1, dtype=int)
    np.add.at(edges, np.maximum(turned - within, 0), 1)
    np.add.at(edges, np.minimum(turned + within + 1, len(direction)), -1)
    return np.cumsum(edges[:-1]) > 0
