"""When is one error smaller than another by more than chance?

Two models leave residuals r_before and r_after. Their squares differ by d^2 + 2 d r_after with
d = r_before - r_after: the first part is what the better model explains, the second is chance. Its
size is estimated from blocks of a quarter of a second, for residuals are correlated within
fractions of a second, and the gain is measured in it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from ..measurement.filtering import Array

#: difference of two residuals, relative to the smaller, below which they count as the same
SAME = 1e-3


def gain_score(before: Array, after: Array, blocks: NDArray[np.intp]) -> float:
    """Gain in squares from `before` to `after`, in standard deviations of its chance part.

    before, after: residuals of the same rows;  blocks: number of the block of each row
    returns: positive where `after` is smaller; 0 where the two are the same
    """
    difference = before - after
    if not len(before) or np.sum(difference**2) < SAME**2 * np.sum(after**2):
        return 0.0
    gain = float(np.sum(before**2) - np.sum(after**2))
    products = np.bincount(blocks, difference * after)
    return gain / max(2.0 * float(np.sqrt(np.sum(products**2))), 1e-300)


def chance(score: float) -> float:
    """Probability that chance alone brings a score of this size or more (one-sided, normal)."""
    return float(ndtr(-score))
