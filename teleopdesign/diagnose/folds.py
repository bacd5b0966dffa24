"""Parts of the fit records that are held out in turn where there is no check record."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..measurement.friction_curve import FOLDS
from ..measurement.prepare import Stretch, measured_force
from ..measurement.shared_links import share_again


@dataclass(frozen=True, eq=False)
class Fold:
    """Stretches without some of their rows, and with these alone.

    rows: whether each row that counts is held out, of all stretches one after the other
    """

    known: tuple[Stretch, ...]
    held_out: tuple[Stretch, ...]
    rows: NDArray[np.bool_]


def folds(stretches: Sequence[Stretch]) -> list[Fold]:
    """The stretches with `FOLDS` parts of each held out in turn.

    The parts are blocks of successive rows. A block may hold most of the motion in one direction,
    such as the only stroke forward. Then the rest of the records would not tell friction from a
    constant force, and chance would decide between such effects: so the rows of each direction,
    and those at rest, are divided apart.
    """
    parts = [_blocks(len(s.keep)) for s in stretches]
    if _holds_most_of_a_direction(stretches, parts):
        parts = [_blocks_of_each(s.motion.direction[s.keep]) for s in stretches]
    every = []
    for i in range(FOLDS):
        held = [part == i for part in parts]
        known = [
            replace(with_rows(s, ~out), shared=s.shared)
            for s, out in zip(stretches, held, strict=True)
        ]
        held_out = tuple(with_rows(s, out) for s, out in zip(stretches, held, strict=True))
        every.append(Fold(share_again(known), held_out, np.concatenate(held)))
    return every


def _blocks(rows: int) -> NDArray[np.intp]:
    """The block of each row: blocks of successive rows, equally long."""
    return np.arange(rows) * FOLDS // max(rows, 1)


def _blocks_of_each(direction: NDArray[np.int8]) -> NDArray[np.intp]:
    """The block of each row, where the rows of each direction are divided into blocks apart."""
    part = np.zeros(len(direction), dtype=np.intp)
    for one in (-1, 0, 1):
        here = np.flatnonzero(direction == one)
        part[here] = _blocks(len(here))
    return part


def _holds_most_of_a_direction(
    stretches: Sequence[Stretch], parts: Sequence[NDArray[np.intp]]
) -> bool:
    """Whether a block holds more than half of all rows in one of two directions."""
    direction = np.concatenate([s.motion.direction[s.keep] for s in stretches])
    part = np.concatenate(parts)
    counts = [np.bincount(part[direction == one], minlength=FOLDS) for one in (-1, 1)]
    return all(c.sum() >= FOLDS for c in counts) and any(2 * c.max() > c.sum() for c in counts)


def with_rows(stretch: Stretch, rows: NDArray[np.bool_]) -> Stretch:
    """The stretch with some of its rows that count, regardless of links.

    rows: mask of `keep`
    """
    keep = stretch.keep[rows]
    force = measured_force(replace(stretch, keep=keep))
    return replace(stretch, keep=keep, measured=stretch.weight * float(force @ force), shared=None)
