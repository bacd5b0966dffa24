"""Results of the points of a study, in few bytes per point.

Points whose measures are plain numbers, as for most measures, are rows of one array. Texts, arrays
and reasons of failures are stored unchanged.

Progress reports to the caller of a study while it runs.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..base.sentences import duration_text

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
    """Outcome by number of the point, from 0 to below `points`."""

    def __init__(self, points: int) -> None:
        # pages of zeros take no memory until they are written
        self._places = np.zeros(points, dtype=np.int8)
        self._forms: dict[tuple[Any, ...], int] = {}
        self._rows: list[np.ndarray] = []
        self._apart: dict[int, PointOutcome] = {}
        self._many = 0

    def keep(self, outcome: PointOutcome) -> None:
        """Store the outcome of a point that has none yet."""
        index, number = outcome.point, self._form_number(outcome)
        self._many += 1
        self._places[index] = number
        if number == _APART:
            self._apart[index] = outcome
        else:
            self._rows[number - 1][index] = outcome.values

    def _form_number(self, outcome: PointOutcome) -> int:
        """Number of the form whose array stores the outcome."""
        if outcome.reason or not all(type(v) is float for v in outcome.values):
            return _APART
        if outcome.form not in self._forms:
            if len(self._forms) == _MOST_FORMS:
                return _APART
            self._forms[outcome.form] = len(self._forms) + 1
            self._rows.append(np.zeros((len(self._places), len(outcome.values))))
        return self._forms[outcome.form]

    def __contains__(self, index: object) -> bool:
        if not isinstance(index, int) or not 0 <= index < len(self._places):
            return False
        return bool(self._places[index] != _NOWHERE)

    def __getitem__(self, index: int) -> PointOutcome:
        if index not in self:
            raise KeyError(index)
        if index in self._apart:
            return self._apart[index]
        number = int(self._places[index])
        form = next(form for form, k in self._forms.items() if k == number)
        return PointOutcome(index, form, tuple(self._rows[number - 1][index].tolist()))

    def __iter__(self) -> Iterator[int]:
        return map(int, np.flatnonzero(self._places))

    def __len__(self) -> int:
        return self._many


#: s between two reports: as often as one can read
_BETWEEN = 0.5
#: number of last reports that determine the rate: 10 s
_REMEMBERED = 20


@dataclass(frozen=True)
class Progress:
    """Progress of a study.

    done, total: numbers of points;  failed: of those done;  kept: points of an earlier run
    rate: points per second;  left: s until the end at that rate, NaN: no rate is known yet
    things: what the points are, as a noun
    """

    done: int
    total: int
    failed: int
    kept: int
    rate: float
    left: float
    things: str = "points"

    def __str__(self) -> str:
        text = f"{self.done} of {self.total} {self.things}"
        if self.failed:
            text += f", {self.failed} failed"
        if self.rate > 0:
            text += f", {self.rate:.3g}/s"
        if self.left == self.left and self.done < self.total:
            text += f", {duration_text(self.left)} left"
        return text


class Clock:
    """Counts outcomes, and reports the progress to the caller from time to time."""

    def __init__(
        self,
        total: int,
        kept: int,
        tell: Callable[[Progress], object] | None,
        things: str = "points",
    ) -> None:
        self.things = things
        self.total, self.kept, self.tell = total, kept, tell
        self.done, self.failed = kept, 0
        self.last = time.monotonic()
        #: (time, points done) now and then: the rate is that of the last seconds, so that what was
        #: compiled for the first point does not count to the end
        self._recent: deque[tuple[float, int]] = deque([(self.last, kept)], maxlen=_REMEMBERED)

    def count(self, outcome: PointOutcome) -> None:
        """Count one more outcome, and report if a report is due."""
        self.done += 1
        self.failed += bool(outcome.reason)
        now = time.monotonic()
        if self.tell is not None and (now - self.last > _BETWEEN or self.done == self.total):
            self.last = now
            self._recent.append((now, self.done))
            self.tell(self.now())

    def now(self) -> Progress:
        """The present progress."""
        start, before = self._recent[0]
        passed, fresh = time.monotonic() - start, self.done - before
        rate = fresh / passed if passed > 0 else 0.0
        left = (self.total - self.done) / rate if rate > 0 else float("nan")
        return Progress(self.done, self.total, self.failed, self.kept, rate, left, self.things)
