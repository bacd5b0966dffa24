"""Candidates that would leave less force than the final model, and why they do not count."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from .decision import helps_but_is_barred, lowers_check_squares, objection

if TYPE_CHECKING:
    from .diagnosis import Diagnosis
    from .ranking import Ranked

#: a candidate is reported if its error is lower by more than this part of the last model's error: a
#: difference that a reader can see
LESS = 0.02


def percent(error: float) -> str:
    """An error in percent; "unknown" where it is not finite: the model is blind everywhere."""
    return f"{100 * error:.2f} %" if math.isfinite(error) else "unknown"


def possible_next(diagnosis: Diagnosis) -> list[Ranked]:
    """The candidates that could be added next, best first: no rule excludes them."""
    last, floor = diagnosis.last, diagnosis.floor
    helpful = [r for r in last.ranked if r.counts and r.score > 0.0]
    return [r for r in helpful if not objection(last.base, r, floor)]


def left_out_lines(diagnosis: Diagnosis) -> list[str]:
    """The candidates that leave clearly less than the final model, each with the reason.

    All that a rule refuses; where more than noise is left also a candidate whose values the records
    do not determine, if none that may count leaves less
    """
    return [*_lines_of_refusals(diagnosis), *_lines_of_open_values(diagnosis)]


def _lines_of_refusals(diagnosis: Diagnosis) -> Iterator[str]:
    for r in diagnosis.last.ranked:
        why = helps_but_is_barred(diagnosis.last.base, r, diagnosis.floor)
        if why and r.fit.check_error < (1.0 - LESS) * diagnosis.after.check_error:
            yield (
                f"refused: {r.candidate} ({percent(r.fit.check_error)}; at the command "
                f"{percent(r.fit.at_command.error)}): {why}"
            )


def _lines_of_open_values(diagnosis: Diagnosis) -> Iterator[str]:
    ranked, base = diagnosis.last.ranked, diagnosis.last.base
    allowed = [r for r in ranked if not (r.refused or r.implausible)]
    least = min(allowed, key=lambda r: r.fit.check_error, default=None)
    if least is None or least.counts or not diagnosis.more_is_missing:
        return
    if lowers_check_squares(base, least.fit):
        yield (
            f"not determined: {least.candidate} leaves least ({percent(least.fit.check_error)}), "
            "but these records do not determine its values"
        )
