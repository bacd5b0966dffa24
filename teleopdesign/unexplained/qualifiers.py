"""Whether a dependence holds in both directions, and whether it needs the body to have rested."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..diagnose.criteria import CRITERIA
from ..diagnose.fit import standard_errors
from ..measurement.filtering import Array
from .dependence import Dependence
from .rows import RESTED, Rows

#: part of the squares of a dependence that each side must have, so that the sides can be compared
SHARE = 0.1
#: size on one side, relative to the other side, below which the effect is "only" on the other side
ONLY = 0.25


@dataclass(frozen=True)
class Contrast:
    """The size of a dependence on two sides, relative to its overall size, with standard errors.

    sides: such as ("forward", "backward");  sizes, errors: (2,)
    """

    sides: tuple[str, str]
    sizes: Array
    errors: Array

    @property
    def differs(self) -> bool:
        """Whether the sides differ by more than chance."""
        return bool(abs(np.diff(self.sizes)[0]) > CRITERIA.sure * np.hypot(*self.errors))

    @property
    def only(self) -> str:
        """The only side on which the dependence exists; "" where it exists on both."""
        weak = int(np.argmin(np.abs(self.sizes)))
        strong = self.sizes[1 - weak]
        return self.sides[1 - weak] if self.differs and self.sizes[weak] < ONLY * strong else ""


def contrasts(rows: Rows, dependence: Dependence, left: Array) -> tuple[Contrast, ...]:
    """Sizes of the dependence forward and backward, and after a rest and after a mere reversal.

    left: weighted residual (n,) that the dependence describes
    """
    whole = dependence.columns.values @ dependence.coefficients
    direction, rested = rows.at("direction"), rows.at("rested")
    pairs = (
        (("forward", "backward"), direction > 0, direction < 0),
        (("after it has rested", "after a mere reversal"), rested >= RESTED, rested < RESTED),
    )
    candidates = [_contrast(rows, sides, a, b, whole, left) for sides, a, b in pairs]
    return tuple(c for c in candidates if c is not None)


def _contrast(
    rows: Rows,
    sides: tuple[str, str],
    one: NDArray[np.bool_],
    other: NDArray[np.bool_],
    whole: Array,
    left: Array,
) -> Contrast | None:
    columns = np.column_stack([whole * one, whole * other])
    size = np.sum(columns**2, axis=0)
    if size.min() < SHARE * size.sum():
        return None
    # the other columns of the model would blur the sides: each is held against what is left as is
    sizes = np.linalg.lstsq(columns, left, rcond=None)[0]
    errors = standard_errors(columns, left - columns @ sizes, rows.blocks)
    return Contrast(sides, np.asarray(sizes), errors)
