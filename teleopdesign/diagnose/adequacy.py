"""Adequacy: whether the remaining error is noise; and what effects explain, against what is left.

The error is compared with the noise floor. A hum may hold all the rest.
Every threshold is a field of `Criteria`.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import Literal, Protocol

import numpy as np

from .criteria import CRITERIA
from .evidence import check_squares
from .fit import Fit
from .noise_floor import NoiseFloor
from .outside_tone import Tone
from .ranking import Ranking


class Errors(Protocol):
    """Relative errors of a model: of a fit, or as an answer states them.

    blind: share of the sliding samples in which the command has no influence
    """

    @property
    def fit_error(self) -> float: ...
    @property
    def check_error(self) -> float: ...
    @property
    def check_error_at_command(self) -> float: ...
    @property
    def blind(self) -> float: ...


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


def is_a_tone(fit: Fit, tone: Tone, floor: NoiseFloor) -> bool:
    """Whether a single sine explains all of a fit's error except noise."""
    squares = check_squares(fit)
    left = fit.check_error * float(np.sqrt(tone.squares / squares)) if squares > 0.0 else 0.0
    return is_noise(left, floor)


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


#: how a diagnosis ends
VerdictName = Literal["effects_missing", "model_adequate", "undecided"]


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
