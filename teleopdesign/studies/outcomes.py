"""Results of the points of a study, in few bytes per point.

Points whose measures are plain numbers, as for most measures, are rows of one array. Texts, arrays
and reasons of failures are stored unchanged.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

#: most forms of results that have an array each; points of further forms are stored one by one
_MOST_FORMS = 8
#: place of a point: nowhere, or among the points that are stored one by one; else the number of its
#: form
_NOWHERE, _APART = 0, -1


@dataclass(frozen=True)
class PointOutcome:
    """Result of a point.

    form: description of each value: (name, kind, unit, text, dimension ...)
    values: in the order of `form`;  reason: of a failure; "" if the point did not fail
    """

    point: int
    form: tuple[Any, ...] = ()
    values: tuple[Any, ...] = ()
    reason: str = ""


def as_row(outcome: PointOutcome) -> tuple[Any, ...]:
    """The arguments of `PointOutcome`: read back from bytes eight times as fast as the object."""
    return outcome.point, outcome.form, outcome.values, outcome.reason


class Outcomes(Mapping[int, PointOutcome]):
    """Outcome by number of the point.

    points: lower numbers are stored in arrays; higher numbers, such as digests, one by one
    """

    def __init__(self, points: int) -> None:
        # pages of zeros take no memory until they are written
        self._places = np.zeros(points, dtype=np.int8)
        self._forms: dict[tuple[Any, ...], int] = {}
        self._rows: list[np.ndarray] = []
        self._apart: dict[int, PointOutcome] = {}
        self._many = 0

    def keep(self, outcome: PointOutcome) -> None:
        """Store an outcome, in place of an earlier one of the same point."""
        index = outcome.point
        if index not in self:
            self._many += 1
        self._apart.pop(index, None)
        number = self._form_number(outcome)
        if self._is_counted(index):
            self._places[index] = number
        if number == _APART:
            self._apart[index] = outcome
        else:
            self._rows[number - 1][index] = outcome.values

    def drop(self, index: int) -> None:
        """Drop the outcome of a point."""
        self._many -= index in self
        if self._is_counted(index):
            self._places[index] = _NOWHERE
        self._apart.pop(index, None)

    def failed_points(self) -> list[int]:
        """Numbers of the points that failed."""
        return [index for index, outcome in self._apart.items() if outcome.reason]

    def _form_number(self, outcome: PointOutcome) -> int:
        """Number of the form whose array stores the outcome."""
        plain = self._is_counted(outcome.point) and all(type(v) is float for v in outcome.values)
        if outcome.reason or not plain:
            return _APART
        if outcome.form not in self._forms:
            if len(self._forms) == _MOST_FORMS:
                return _APART
            self._forms[outcome.form] = len(self._forms) + 1
            self._rows.append(np.zeros((len(self._places), len(outcome.values))))
        return self._forms[outcome.form]

    def _is_counted(self, index: int) -> bool:
        return 0 <= index < len(self._places)

    def __contains__(self, index: object) -> bool:
        if not isinstance(index, int):
            return False
        if self._is_counted(index):
            return bool(self._places[index] != _NOWHERE)
        return index in self._apart

    def __getitem__(self, index: int) -> PointOutcome:
        if index not in self:
            raise KeyError(index)
        if index in self._apart:
            return self._apart[index]
        number = int(self._places[index])
        form = next(form for form, k in self._forms.items() if k == number)
        return PointOutcome(index, form, tuple(self._rows[number - 1][index].tolist()))

    def __iter__(self) -> Iterator[int]:
        yield from map(int, np.flatnonzero(self._places))
        yield from (index for index in self._apart if not self._is_counted(index))

    def __len__(self) -> int:
        return self._many
