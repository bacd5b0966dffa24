"""Measured signals for a fit of simulations: arrays, a data set, or a record of an experiment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..base.errors import ModelError, unknown
from ..measurement import Record
from ..measurement.from_arrays import log_of
from ..simulate import Simulation, Trajectory, sampled_motion
from ..simulate.on_grid import TableOverTime

#: fewest instants from which anything is fitted
_FEWEST = 10
#: durations of the data before them that nobody means to simulate: stamps of a clock
_LATE = 10.0


@dataclass(frozen=True, eq=False)
class MeasuredSignals:
    """Columns (n,) over one time (n,), s, which increases from 0 or later."""

    time: np.ndarray
    columns: Mapping[str, np.ndarray]

    def column(self, name: str) -> np.ndarray:
        """The samples of a column; raises ModelError: no such column."""
        if name not in self.columns:
            raise ModelError(f"fit_simulation: data: {unknown('column', name, self.columns)}")
        return self.columns[name]

    def course(self, name: str) -> TableOverTime:
        """The samples of a column as an input; raises ModelError: a sample that is no number."""
        values = self.column(name)
        if not np.isfinite(values).all():
            raise ModelError(f'fit_simulation: "{name}" has samples that are no numbers')
        return TableOverTime(self.time, values)

    def motion(self, name: str) -> Trajectory:
        """The samples of a column as a prescribed motion."""
        return sampled_motion(self.time, self.column(name))


def measured_signals(data: Any) -> MeasuredSignals:
    """Measured signals from columns with "time", a data set over `time`, a record, a simulation.

    The time of a record is counted from its first sample.

    raises ModelError: no time, another shape, times that do not increase or that count from long
        before the record, a record with gaps
    """
    if isinstance(data, Simulation):
        data = data.data
    if isinstance(data, Record):
        if len(data.segments) > 1:
            raise ModelError(
                f"fit_simulation: {data.file} has {len(data.segments)} segments, expected one "
                "without a gap: cut it by `span`"
            )
        time = data.time - data.time[0]
        columns: dict[str, Any] = dict(data.signals)
    elif hasattr(data, "data_vars") and "time" in data.coords:
        time = data["time"].values
        columns = {str(n): x.values for n, x in data.data_vars.items() if x.dims == ("time",)}
    else:
        columns = _named_columns(data)
        if "time" not in columns:
            raise ModelError(
                'fit_simulation: data: expected a mapping with "time" (s), a DataFrame with such a '
                "column or index, a Dataset over `time`, a Record or a Simulation, found "
                f"{type(data).__name__}"
            )
        time = columns.pop("time")
    return _check_signals(time, columns)


def _named_columns(data: Any) -> dict[str, Any]:
    """Columns of a mapping or of a DataFrame, whose index may be the time; none of all else."""
    if isinstance(data, Mapping):
        return {str(n): x for n, x in data.items()}
    if hasattr(data, "columns") or hasattr(data, "get_columns"):
        log = log_of(data)
        return dict(log.read(dict.fromkeys(log.names, "")))
    return {}


def _check_signals(time: Any, columns: Mapping[str, Any]) -> MeasuredSignals:
    try:
        t = np.asarray(time, dtype=float)
        arrays = {n: np.asarray(x, dtype=float) for n, x in columns.items()}
    except (TypeError, ValueError):
        raise ModelError("fit_simulation: data: expected arrays of numbers") from None
    if t.ndim != 1 or len(t) < _FEWEST or not (np.diff(t) > 0).all() or t[0] < 0:
        raise ModelError(
            f"fit_simulation: time: expected {_FEWEST} or more instants (s) that increase from 0 "
            "or later; the simulation starts at 0"
        )
    if t[0] > _LATE * (t[-1] - t[0]):
        raise ModelError(
            f"fit_simulation: time: begins at {t[0]:g} s and lasts {t[-1] - t[0]:g} s; the "
            "simulation starts at 0: subtract the instant at which it starts"
        )
    for name, array in arrays.items():
        if array.shape != t.shape:
            raise ModelError(
                f'fit_simulation: data: "{name}" has shape {array.shape}, time {t.shape}'
            )
    return MeasuredSignals(t, arrays)
