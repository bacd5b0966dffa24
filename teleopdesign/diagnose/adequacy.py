"""Adequacy: whether the remaining error is noise, by noise floor, hum and single moments.

Every threshold is a field of `Criteria`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from .criteria import CRITERIA, Criteria
from .evidence import check_squares
from .fit import Fit
from .noise_floor import NoiseFloor
from .one_moment import Moment, worst_moment
from .outside_tone import Tone
from .prepare import Prepared
from .ranking import Ranking


@dataclass(frozen=True)
class Floors:
    """The noise floor of a model: as drawn, and limited by the error of the model.

    drawn: what its readings, drawn anew, leave
    allowed: what counts as noise in decisions: never above what the records themselves leave, nor
        far above the floor of the user's model
    """

    drawn: NoiseFloor
    allowed: NoiseFloor


def limit_noise_floor(drawn: NoiseFloor, here: Fit, ranking: Ranking) -> NoiseFloor:
    """The noise floor, at most the error of the model or of any identifiable candidate.

    Without what is missing a parameter may be led where sensor noise would ask for any force: what
    the records themselves leave shows that it does not. Moments of reading that jitter are seen in
    the readings, though: a candidate that leaves less than they make weakens what they make.
    """
    left = [here.check_error]
    if not drawn.jitters:
        left += [r.fit.check_error for r in ranking.ranked if r.counts]
    return replace(drawn, value=min(drawn.value, *left))


def allowed_floor(
    bounded: NoiseFloor, first: NoiseFloor, stated: Fit, *, criteria: Criteria = CRITERIA
) -> NoiseFloor:
    """A noise floor, limited by the first floor or by the error of the user's fitted model.

    An effect that makes sensors count for much more would hide what it leaves in their noise.
    """
    most = max(criteria.louder * first.value, criteria.hidden * stated.check_error)
    return bounded.at_most(most)


def is_noise(check_error: float, floor: NoiseFloor, *, criteria: Criteria = CRITERIA) -> bool:
    """Whether an error of this size on the check records counts as noise."""
    return check_error <= criteria.adequate * floor.value


def is_a_tone(fit: Fit, tone: Tone, floor: NoiseFloor, *, criteria: Criteria = CRITERIA) -> bool:
    """Whether a plain tone explains all but noise."""
    squares = check_squares(fit)
    left = fit.check_error * float(np.sqrt(tone.squares / squares)) if squares > 0.0 else 0.0
    return is_noise(left, floor, criteria=criteria)


def is_adequate(fit: Fit, floor: NoiseFloor, *, criteria: Criteria = CRITERIA) -> bool:
    """Whether the error on the check records counts as noise, as a force and at the command.

    A model that is blind in much of the motion says too little to be adequate.
    """
    command_error = fit.at_command
    at_command = (
        command_error.error <= criteria.adequate * floor.value_at_command
        and command_error.blind <= criteria.blind
    )
    return is_noise(fit.check_error, floor, criteria=criteria) and at_command


def floors_left(fit: Fit, floor: NoiseFloor) -> float:
    """Check error in noise floors: of the force or at the command, the larger."""
    if not (floor.value and math.isfinite(fit.at_command.error)):
        return float("inf")
    return max(fit.check_error / floor.value, fit.at_command.error / floor.value_at_command)


def records_differ(fit: Fit, *, criteria: Criteria = CRITERIA) -> bool:
    """Whether a model leaves much more of the check records than of the fit records."""
    return fit.check_error >= criteria.differ * fit.fit_error > 0.0


def moment_above_noise(
    fit: Fit, prepared: Prepared, floor: NoiseFloor, *, criteria: Criteria = CRITERIA
) -> Moment | None:
    """The one moment that holds all that a model leaves above noise; None where none does."""
    if is_adequate(fit, floor, criteria=criteria):
        return None
    moment = worst_moment(fit, prepared, floor)
    return moment if moment is not None and moment.without <= criteria.adequate else None
