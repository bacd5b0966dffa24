"""Set points among the columns of a log: the position of a controlled machine follows them.

A set point has the numbers of the position, only earlier. Such a column is neither the position nor
a force, whatever its name: "r" beside "y", "SV" beside "PV", "reference" beside "measurement".
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..column_names import WANTED, likeness, words_of
from ..encoder import Array
from ..limits import HALF, SEVERAL, SMALL
from .content import SURE_NAME, SurveyedColumn, is_unit_of
from .derivative import DERIVATIVE

Indices = NDArray[np.intp]

#: part of the squares of a column by which its position may differ: two columns that agree as a
#: velocity and the derivative of its position must
APART = 1.0 - DERIVATIVE**2
#: likeness of a name to that of a force, from which it is no set point whatever the numbers are:
#: "torque", "current", "effort". "pwm", "u" and "cmd" name pulses of a set point as well
FORCE_NAME = 0.85


def lags(column: Array, other: Array) -> bool:
    """Whether a column has the numbers of another one, only later.

    The delay may be less than a row, as that of a position behind the path that a drive plans: then
    the numbers agree a row later rather than a row earlier.
    """
    if not has_numbers_of(column, other):
        return False
    later, earlier = (
        [_apart(*pair, k) for k in _delays(len(column))]
        for pair in ((column, other), (other, column))
    )
    if _apart(column, other, 0) < min(*later, *earlier):
        return later[0] < earlier[0]
    return min(later) < min(earlier)


def is_sent_to_places(position: Array, column: SurveyedColumn) -> bool:
    """Whether a position rests at a place of its own for each value that another column holds.

    The places are in proportion to the values, and the values keep away from zero: pulse widths of
    a hobby servo, or counts of a converter, are a set point in another unit than the position.
    """
    if column.unit is not None and is_unit_of(column.unit, "force"):
        return False
    values = column.values
    if likeness(column.name, "actuator_force") >= FORCE_NAME or not np.ptp(values) > 0.0:
        return False
    if values.min() * values.max() <= 0.0:
        return False
    # pulses of a hobby servo have 500 to 2500 us; no force keeps so far from zero beside a rest
    if np.abs(values).min() < SMALL * np.abs(values).max():
        return False
    ends = np.flatnonzero(np.diff(values))  # the last row of each hold
    ends = ends[ends > 0]
    if not _rests_at(ends, position) or not np.ptp(values[ends]) > 0.0:
        return False
    line = np.polynomial.Polynomial.fit(values[ends], position[ends], 1)
    apart = float(np.mean((position[ends] - line(values[ends])) ** 2))
    return apart < APART * float(np.var(position[ends]))


def _rests_at(ends: Indices, position: Array) -> bool:
    """Whether a position is slower than on the average at the ends of enough holds."""
    if len(ends) < SEVERAL or 2 * len(ends) > len(position):
        return False
    change = np.abs(np.diff(position))
    return float(np.mean(change[ends - 1])) < float(np.mean(change))


def has_numbers_of(column: Array, position: Array) -> bool:
    """Whether a column has the numbers of the position, at the same time, earlier or later."""
    if not _are_alike(column, position):
        return False
    delays = _delays(len(column))
    least = (min(_apart(column, position, k), _apart(position, column, k)) for k in delays)
    return min(_apart(column, position, 0), *least) < APART


def may_be_set_point(column: SurveyedColumn) -> bool:
    """Whether unit and name of a column leave open that it is a set point of the position.

    "cmd" and "command" name forces and set points; "torque" names a force only. Per cent may be
    parts of a stroke or of a torque.
    """
    if column.unit not in (None, "%") and is_unit_of(column.unit, "force"):
        return False
    plain = " ".join(word for word in words_of(column.name) if word not in WANTED)
    return max(likeness(plain, f"{k}_force") for k in ("actuator", "interaction")) < SURE_NAME


def _are_alike(column: Array, other: Array) -> bool:
    """Whether mean and spread let two columns have the same numbers: a quick first look."""
    spread = float(np.std(other))
    within = abs(float(np.mean(column) - np.mean(other))) < spread
    return within and HALF * spread < float(np.std(column)) < 2.0 * spread


def _delays(rows: int) -> Iterator[int]:
    """Delays in rows, each about a quarter longer than the one before."""
    delay = 1
    while delay <= max(SMALL * rows, 1.0):
        yield delay
        delay += 1 + delay // 4


def _apart(late: Array, early: Array, delay: int) -> float:
    """Mean square of the difference between a column and one `delay` rows earlier, over its own."""
    rows = len(late) - delay
    whole = float(np.var(late))
    return float(np.mean((late[delay:] - early[:rows]) ** 2)) / whole if whole > 0 else np.inf
