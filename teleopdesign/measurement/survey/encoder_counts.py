"""Encoder counts of a log: which column holds them, and how many of them are a turn."""

from __future__ import annotations

import math

import numpy as np

from ...base.units import measures, si_factor
from .content import Survey, SurveyedColumn, sample_time_of
from .derivative import NEAR_USUAL, USUAL_COUNTS, derivative_factor, unwrap_column, wrap_of
from .remarks import counts_per_turn_in
from .words import says

#: counts per turn if nothing in the log determines them
USUAL = 4096.0
#: range above which whole numbers are counts: of a counter by its name, and of any other name;
#: angles may be whole degrees of many turns
MOST_ANGLE, MOST_DEGREES = 50, 1000


def is_counter(column: SurveyedColumn) -> bool:
    """Whether a column without a unit is the counter of an encoder, by its whole numbers."""
    values = column.readings[np.isfinite(column.readings)]
    if not np.all(values == np.round(values)):
        return False
    most = math.inf if says(column.name, "angle") else MOST_DEGREES
    most = MOST_ANGLE if says(column.name, "counter") else most
    return float(np.ptp(values)) > most


def guess_counts_per_turn(
    survey: Survey, column: SurveyedColumn, velocity: str | None, jump: float | None
) -> float:
    """Counts per turn by the header of the log, the velocity, or the wrap; the guess is noted.

    jump: counts by which the position wraps; None: the position does not wrap
    """
    per_turn = jump or USUAL
    why = "the log does not state them, see the data sheet of the encoder"
    if (in_header := counts_per_turn_in(survey.remarks)) is not None:
        per_turn, line = in_header
        why = f"a line of the log states {line!r}"
    elif velocity is not None and (counted := _counts_by_velocity(survey, column, velocity)):
        per_turn = counted
        unit = survey.columns[velocity].unit
        why = f"with them, the derivative agrees with {velocity!r} in {unit}"
    survey.guesses["channels.position.counts_per_turn"] = f"{per_turn:g} counts per turn: {why}"
    return per_turn


def _counts_by_velocity(survey: Survey, column: SurveyedColumn, velocity: str) -> float:
    """Usual counts per turn for which a velocity is the derivative of the position; 0: none."""
    unit = survey.columns[velocity].unit
    if unit is None or not measures(unit, "velocity", "revolute"):
        return 0.0
    whole = unwrap_column(column.values, wrap_of(column.values))
    factor, _ = derivative_factor(whole, survey.columns[velocity].values, sample_time_of(survey))
    if not factor > 0.0:
        return 0.0
    counted = 2 * math.pi / (factor * si_factor(unit, quantity="velocity", axis="revolute"))
    usual = min(USUAL_COUNTS, key=lambda one: abs(math.log(counted / one)))
    return usual if abs(counted / usual - 1.0) < NEAR_USUAL else 0.0
