"""What an error says: less than another by more than chance, or no more than noise.

Two models leave residuals r_before and r_after. Their squares differ by d^2 + 2 d r_after with d =
r_before - r_after. The first part is the force that the better model explains; the second part is
chance. Residuals are correlated within fractions of a second, so the standard deviation of the
chance part is estimated from blocks of a quarter of a second. The score is the gain divided by this
standard deviation.

What is left is compared with the noise floor. Every threshold is a field of `Criteria`.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from ..measurement.filtering import Array
from .criteria import CRITERIA
from .fit import Fit
from .noise_floor import NoiseFloor
from .ranking import Ranking
from .statements import LadderRow

#: errors of a model: of a fit, or as an answer states them
Errors = Fit | LadderRow

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


def limit_noise_floor(
    drawn: NoiseFloor, here: Fit, ranking: Ranking, without: Collection[tuple[str, str]] = ()
) -> NoiseFloor:
    """The noise floor, at most the error of the model or of any candidate that counts.

    without: effects, with their places, that only weaken errors of the readings

    While an effect is missing, a parameter may take a value with which sensor noise would cause any
    force. The error that the records themselves leave shows that the noise is smaller.
    A jitter of the reading moments is known from the readings. A candidate that leaves less than
    the jitter causes only weakens this error, so candidates do not limit the floor then.
    """
    left = [here.check_error]
    if not drawn.jitters:
        left += [
            r.fit.check_error for r in ranking.ranked if r.counts and r.candidate.key not in without
        ]
    return replace(drawn, value=min(drawn.value, *left))


def is_noise(check_error: float, floor: NoiseFloor) -> bool:
    """Whether an error of this size on the check records counts as noise."""
    return check_error <= CRITERIA.adequate * floor.value


def is_adequate(errors: Errors, floor: NoiseFloor) -> bool:
    """Whether the check error counts as noise, both of the force and referred to the command.

    A model that is blind in much of the motion is not adequate: there its command shows nothing.
    """
    at_command = (
        errors.check_error_at_command <= CRITERIA.adequate * floor.value_at_command
        and errors.blind <= CRITERIA.blind
    )
    return is_noise(errors.check_error, floor) and at_command


def floors_left(errors: Errors, floor: NoiseFloor) -> float:
    """Check error as a multiple of the noise floor: of the force or at the command, the larger.

    inf where the floor is zero or the error at the command is not finite
    """
    if not (floor.value and math.isfinite(errors.check_error_at_command)):
        return float("inf")
    at_command = errors.check_error_at_command / floor.value_at_command
    return max(errors.check_error / floor.value, at_command)


def records_differ(errors: Errors) -> bool:
    """Whether the relative error on the check records is much larger than on the fit records."""
    return errors.check_error >= CRITERIA.far_larger * errors.fit_error > 0.0


def explained_share(before: Errors, after: Errors, floor: NoiseFloor) -> float:
    """G / (G + L), 0 to 1: what the effects added between two fits explain, against what is left.

    The smaller of two shares: of the force, and of the force referred to the command.
    G: squares that they remove;  L: squares that are left above the noise floor
    """
    fits = (before, after)
    return min(
        removed_share([f.check_error for f in fits], floor.value),
        removed_share([f.check_error_at_command for f in fits], floor.value_at_command),
    )


def removed_share(errors: Sequence[float], floor: float) -> float:
    """`explained_share` of one kind of error: before and after."""
    before, after = errors
    # no step explains more of the force than the last fit, as of a model with a turned sign
    gain = min(before**2 - after**2, 1.0 - after**2)
    left = max(after**2 - floor**2, 0.0)  # NaN where all is blind: nothing is explained
    return gain / (gain + left) if gain > 0.0 and np.isfinite(left) else 0.0
