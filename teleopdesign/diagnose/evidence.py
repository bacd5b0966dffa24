"""Is one error smaller than another by more than chance? Scores of residuals in blocks.

Two models leave residuals r_before and r_after. Their squares differ by d^2 + 2 d r_after with d =
r_before - r_after. The first part is the force that the better model explains; the second part is
chance. Residuals are correlated within fractions of a second, so the standard deviation of the
chance part is estimated from blocks of a quarter of a second. The score is the gain divided by this
standard deviation.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from ..measurement.filtering import Array
from .fit import Fit

#: relative difference (rms) of two residuals below which they count as equal
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
    """Probability that chance alone gives this score or a higher one (one-sided, normal)."""
    return float(ndtr(-score))


def check_squares(fit: Fit) -> float:
    """Sum of squares on the check records, relative to the force that acts in the model."""
    return float(fit.check_residual @ fit.check_residual)


def check_score(before: Fit, after: Fit) -> float:
    """Score of `after` against `before` by the force error on the check records.

    positive: `after` has the smaller error
    """
    return gain_score(before.check_residual, after.check_residual, after.check_blocks)


def score_at_command(before: Fit, after: Fit) -> float:
    """Score of `after` against `before` by the error at the command, on the check records.

    Only rows that are blind in neither model count.
    """
    rows = before.at_command.sighted & after.at_command.sighted
    return gain_score(
        before.at_command.residual[rows], after.at_command.residual[rows], after.check_blocks[rows]
    )


def gain_at_command(before: Fit, after: Fit) -> float:
    """Share of the squares at the command that `after` removes, on rows that both fits can judge.

    Rows that are blind in a fit are left out. The share is at most the gain in the error at the
    command, which each fit has on all of its sighted rows: a model gains nothing by being blind
    where the residual is large.
    """
    rows = before.at_command.sighted & after.at_command.sighted
    whole, left = (float(np.sum(f.at_command.residual[rows] ** 2)) for f in (before, after))
    if not (whole > 0.0 and before.at_command.error > 0.0):
        return 0.0
    by_error = 1.0 - (after.at_command.error / before.at_command.error) ** 2
    return min(by_error, 1.0 - left / whole)


def whole_score(before: Fit, after: Fit) -> float:
    """Score of `after` against `before` by the force error on all records together."""
    shift = int(after.fit_blocks.max()) + 1
    return gain_score(
        np.concatenate([before.fit_residual, before.check_residual]),
        np.concatenate([after.fit_residual, after.check_residual]),
        np.concatenate([after.fit_blocks, after.check_blocks + shift]),
    )
