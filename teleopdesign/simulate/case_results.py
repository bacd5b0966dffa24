"""Results of many cases, collected while they run, and the labelled data set of all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.errors import ModelError, unknown
from ..diagrams import Diagram
from .setup import MOST_NUMBERS
from .units import signal_units

if TYPE_CHECKING:
    import xarray

    from ..realise.side_by_side import LaneResults


#: names of the reductions that `reduce` allows, with the words of the result
REDUCTIONS = {
    "final": "last value",
    "maximum": "largest value",
    "minimum": "least value",
    "peak": "largest size",
    "mean": "mean",
    "rms": "root mean square",
    "energy": "energy that flows in at the port",
}


class CaseResults:
    """Results of all cases, collected while they run."""

    def __init__(self, cases: int) -> None:
        self.open: np.ndarray = np.ones(cases, dtype=bool)
        self.reasons = [""] * cases
        self.steps: np.ndarray = np.full(cases, np.nan)
        self.rows: dict[str, np.ndarray] = {}
        self.numbers: dict[str, np.ndarray] = {}
        self.time: np.ndarray = np.zeros(0)

    def refuse(self, reasons: Mapping[int, str]) -> None:
        for case, reason in reasons.items():
            self.open[case] = False
            self.reasons[case] = reason

    def open_rows(self, samples: int, period: float, names: Sequence[str]) -> None:
        """Allocate the samples of the kept signals; raises ModelError: too many numbers."""
        if not names:
            return
        cases, rows = len(self.open), samples + 1
        if (numbers := cases * rows * len(names)) > MOST_NUMBERS:
            raise ModelError(
                f"simulate_many: keep: {len(names)} signals of {cases} cases with {rows} samples "
                f"need {8e-9 * numbers:.2g} GB: keep fewer, or reduce them"
            )
        self.time = period * np.arange(rows)
        self.rows = {name: np.full((cases, rows), np.nan) for name in names}

    def take(
        self,
        cases: np.ndarray,
        step: float,
        outcome: LaneResults,
        done: np.ndarray,
        kept: Sequence[str],
        reduced: Sequence[str],
    ) -> None:
        """Store the results of `cases`, the rows of the outcome where `done` is true.

        step: inner step of these cases, s
        """
        self.steps[cases] = step
        for j, name in enumerate(kept):
            self.rows[name][cases] = outcome.kept[done, :, j]
        for j, name in enumerate(reduced):
            numbers = self.numbers.setdefault(name, np.full(len(self.open), np.nan))
            numbers[cases] = outcome.reduced[done, j]

    def label(
        self,
        diagram: Diagram,
        columns: Mapping[str, np.ndarray],
        reduced: Mapping[str, tuple[Any, str]],
        duration: float,
    ) -> xarray.Dataset:
        """The data set of all cases.

        columns: parameter -> value in each case;  reduced: result -> (signal, reduction);
            duration: s
        """
        import xarray

        units, texts = signal_units(diagram), diagram.texts
        data: dict[str, Any] = {
            name: (("case", "time"), rows, {"units": units(name), "text": texts.get(name, "")})
            for name, rows in self.rows.items()
        }
        for name, (signal, kind) in reduced.items():
            unit = "J" if kind == "energy" else units(signal)
            text = f"{REDUCTIONS[kind]} of {' on '.join(signal) if kind == 'energy' else signal}"
            empty = np.full(len(self.open), np.nan)
            numbers = self.numbers.get(name, empty)
            data[name] = ("case", numbers, {"units": unit, "text": text})
        coordinates: dict[str, Any] = {
            "case": np.arange(len(self.open)),
            "reason": ("case", np.array(self.reasons, dtype=str)),
            "step": ("case", self.steps, {"units": "s", "text": "inner step of the simulation"}),
        }
        coordinates |= {name: ("case", column) for name, column in columns.items()}
        if self.rows:
            coordinates["time"] = ("time", self.time, {"units": "s"})
        attributes = {
            "diagram": diagram.name,
            "scheme": "exponential Runge-Kutta of order 4",
            "duration_s": duration,
        }
        fixed = {n: v for n, v in diagram.values.items() if n not in columns}
        attributes |= {f"parameter {n}": v for n, v in fixed.items()}
        return xarray.Dataset(data, coordinates, attributes)


class Mistake(ModelError):
    """An error in the arguments that does not depend on the values of a case."""


def read_reduction(name: str, what: Any) -> tuple[Any, str]:
    """A reduction as (signal, kind) or ((force, motion), "energy"), checked."""
    expected = 'expected (signal, "rms") or ((force, motion), "energy")'
    if not (isinstance(what, tuple) and len(what) == 2):
        raise Mistake(f"simulate_many: reduce: {name}: found {what!r}, {expected}")
    signal, kind = what
    if kind not in REDUCTIONS:
        raise Mistake(f"simulate_many: reduce: {name}: {unknown('reduction', kind, REDUCTIONS)}")
    is_port = isinstance(signal, tuple) and len(signal) == 2
    if is_port != (kind == "energy"):
        raise Mistake(f"simulate_many: reduce: {name}: found {what!r}, {expected}")
    return signal, kind
