"""Commanded or measured current: which of two logged forces acted on the device.

A model-based controller logs the force that its model demands. Friction that the model lacks shows
only in the measured current: with the commanded force, no effect would seem to be missing.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..column_names import is_wanted, likeness
from .content import SURE_NAME, Array, SurveyedColumn
from .words import says

#: a measured current equals the commanded one if the difference has at most this part of its
#: squares, without the noise of single rows: the current loop of a drive and its sensor leave less
#: than a tenth of the force. If the difference is larger, another force than the command acted:
#: feedback, or a limit
FOLLOWED = 0.01
#: part of the larger of two sides (values above and below zero) up to which the smaller one may be
#: noise about zero: the current that a drive draws from its supply has one side, a motor's has both
ONE_SIDE = 0.1
#: most rows by which a drive may be late behind its command; it may also smooth over these rows
LATE = 4


def current_that_acted(
    force: str, columns: Mapping[str, SurveyedColumn], scores: Mapping[str, float]
) -> tuple[str, float] | None:
    """A measured current that acted in place of the commanded `force`, and how far the two differ.

    returns: the column of the current, and the rms of the part that the command does not explain,
        over the rms of the current; None: `force` is no command, or the drive followed it
    """
    if not is_wanted(force):
        return None
    measured = [
        name
        for name, column in columns.items()
        if name != force and _is_current(column) and not is_wanted(name)
        if not _lacks_a_side(column.values, columns[force].values)
    ]
    if not measured:
        return None
    best = max(measured, key=lambda name: scores[name])
    share = _unexplained_share(columns[force].values, columns[best].values)
    return (best, share**0.5) if share > FOLLOWED else None


def _is_current(column: SurveyedColumn) -> bool:
    """Whether a column is the current of a motor, by unit or by name."""
    if likeness(column.name, "actuator_force") < SURE_NAME:
        return False
    return column.unit in ("A", "mA") or column.unit is None and says(column.name, "current")


def _lacks_a_side(measured: Array, wanted: Array) -> bool:
    """Whether a current has one sign although the command has both: it is no motor's current."""
    return _smaller_side(measured) < ONE_SIDE < _smaller_side(wanted)


def _smaller_side(x: Array) -> float:
    """The largest value of the smaller side of zero, over that of the larger side."""
    sides = sorted((max(float(np.max(x)), 0.0), max(-float(np.min(x)), 0.0)))
    return sides[0] / sides[1] if sides[1] > 0.0 else 0.0


def _unexplained_share(wanted: Array, measured: Array) -> float:
    """Part of the variance of a measured force that the commanded force does not explain.

    The residual of each row is multiplied by that of the next row, so that noise of single rows and
    the steps of a converter average out.
    """
    rows = len(measured) - LATE
    if rows <= LATE:
        return 0.0
    late = [wanted[LATE - k : LATE - k + rows] for k in range(LATE + 1)]
    columns = np.column_stack([*late, np.ones(rows)])
    target = measured[LATE:]
    whole = float(np.mean((target - target.mean()) ** 2))
    solution, *_ = np.linalg.lstsq(columns, target, rcond=1e-8)
    left = target - columns @ solution
    return float(np.mean(left[1:] * left[:-1])) / whole if whole > 0 else 0.0
