"""Friction as a residual shows it, whatever the model lacks: in cells of position and direction."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import groupby
from typing import Annotated

from ..base.codec import Bounds

#: direction of motion -> its word
_WAYS = {1: "forward", -1: "backward"}


@dataclass(frozen=True)
class FrictionCell:
    """Friction along one range of positions, in one direction of motion; SI.

    low, high: ends of the range;  direction: 1 or -1
    samples: number of independent samples of the friction, in any number of passes
    least: 2.5 % quantile of the friction; NaN where the samples are too few
    """

    low: float
    high: float
    direction: int
    samples: float
    least: Annotated[float, Bounds()]

    @property
    def is_covered(self) -> bool:
        """Whether the samples are enough for a bound."""
        return not math.isnan(self.least)


@dataclass(frozen=True)
class FrictionCells:
    """Friction of one body over all cells of its travel, each in both directions."""

    cells: tuple[FrictionCell, ...]

    @property
    def covered(self) -> tuple[FrictionCell, ...]:
        """Cells with enough independent samples."""
        return tuple(cell for cell in self.cells if cell.is_covered)

    @property
    def least(self) -> float:
        """Least friction of the covered cells, N or N m; not above the true one; NaN: none."""
        return min((cell.least for cell in self.covered), default=math.nan)

    def left_open(self, unit: str) -> str:
        """The ranges that no bound covers, in words: "forward 0.1 to 0.2 m"; "" where none."""
        parts = []
        for way, word in _WAYS.items():
            row = sorted((c for c in self.cells if c.direction == way), key=lambda c: c.low)
            ranges = []
            for is_covered, run in groupby(row, key=lambda c: c.is_covered):
                there = list(run)
                if not is_covered:
                    ranges.append(f"{there[0].low:.3g} to {there[-1].high:.3g} {unit}")
            parts += [f"{word} {', '.join(ranges)}"] if ranges else []
        return "; ".join(parts)
