"""An experiment from arrays or a DataFrame in memory, in one call."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..base.arguments import check_types
from ..base.errors import ExperimentError, unknown
from ..base.toml import Table
from ..base.units import AXES, is_unit, unit_of
from .channel import BODY_QUANTITIES, layout_from
from .column_names import as_unit, likeness, unfit_unit, unit_in_name, why_no_unit
from .description import BodyDescription, bodies_from, with_first_values
from .doors._cells import holds_dates
from .doors._log import Log
from .experiment import Experiment
from .first_guess import guess_from
from .record import Record, RecordEntry, cut_to, overlap, record_of
from .tables import columns_of

#: a channel in a call: the name of a column, or a table as in [channels]
ChannelEntry = str | Mapping[str, Any]
_WHERE = "experiment"


@check_types
def experiment(
    data: Any,
    *,
    axis: str,
    position: ChannelEntry,
    actuator_force: ChannelEntry,
    interaction_force: ChannelEntry | None = None,
    velocity: ChannelEntry | None = None,
    time: ChannelEntry | None = None,
    sample_rate: float | None = None,
    segment: str | None = None,
    units: Mapping[str, str] | None = None,
    inertia: float | None = None,
    effects: Sequence[str] = ("coulomb", "viscous"),
    fit: Sequence[Sequence[float] | float] | None = None,
    check: Sequence[Sequence[float] | float] = (),
    bandwidth: float | None = None,
    title: str = "data",
) -> Experiment:
    """An experiment on one body from arrays in memory.

    data: a DataFrame of pandas or polars, a Dataset of xarray, or a dict of arrays of one length
    axis: "prismatic" or "revolute"
    position, actuator_force, ...: the column, or a table as in [channels] of a file (`{"column":
        "i", "unit": "A", "torque_constant": {"value": 0.04, "unit": "N*m/A"}}`)
    time: default: the column or index whose name suggests a time;  sample_rate: Hz, instead
    segment: the column that numbers trials: hidden states start anew at each
    units: column -> unit; default: the unit at the end of the column's name ("Pos (deg)"), or SI,
        which `check` then calls a guess
    inertia: kg or kg*m^2; default: estimated from the data, as are the first values of friction
    effects: those of the model;  fit, check: spans (begin, end) in s from the first row, or one
        span; default: all rows are fitted, and blocks of them are held out in turn
    raises ExperimentError: no such column, a unit that does not fit, too little data

        >>> t = np.arange(0.0, 10.0, 0.001)
        >>> data = {"t": t, "x (mm)": 10 * np.sin(5 * t), "F (N)": np.cos(5 * t)}
        >>> td.experiment(
        ...     data, axis="prismatic", position="x (mm)", actuator_force="F (N)", inertia=0.2
        ... )
        Experiment "data" (data)
          device: prismatic, coulomb, viscous
            position in m
            actuator_force in N
          Record fit (fit): 10000 samples, 10 s at 1000 Hz
    """
    log = log_of(data)
    entries: dict[str, Any] = {
        "position": position,
        "actuator_force": actuator_force,
        "interaction_force": interaction_force,
        "velocity": velocity,
    }
    Table({"axis": axis}, _WHERE).choice("axis", AXES)
    entered = {key: entry for key, entry in entries.items() if entry is not None}
    guesses: dict[str, str] = {}
    channels = {
        key: channel_table(e, key, axis, log, units or {}, guesses) for key, e in entered.items()
    }
    content: dict[str, Any] = {"channels": channels}
    if sample_rate is not None:
        channels["sample_rate"] = {"value": sample_rate, "unit": "Hz"}
    else:
        channels["time"] = _time_table(time, log, units or {}, guesses)
    if segment is not None:
        channels["segment"] = {"column": segment}
    body: dict[str, Any] = {"axis": axis, "effects": {name: {} for name in effects}}
    if inertia is not None:
        body["inertia"] = inertia
    content["model"] = {"device": body}
    if strange := [column for column in units or {} if column not in log.names]:
        raise ExperimentError(f"{_WHERE}: units: {unknown('column', strange[0], log.names)}")
    spans: list[tuple[str, Sequence[float] | None]] = [("fit", None)]
    if fit is not None:
        spans = [("fit", span) for span in _spans(fit, "fit")]
    spans += [("check", span) for span in _spans(check, "check")]
    made = build_experiment(content, log, spans, title=title, bandwidth=bandwidth)
    return replace(made, guesses=guesses)


def _spans(spans: Sequence[Sequence[float] | float], use: str) -> list[Sequence[float]]:
    """The spans as a list of pairs; two plain numbers are one span."""
    numbers = [span for span in spans if isinstance(span, int | float)]
    pairs = [span for span in spans if not isinstance(span, int | float)]
    if len(numbers) == 2 and not pairs:
        return [numbers]
    if numbers or any(len(pair) != 2 for pair in pairs):
        raise ExperimentError(
            f"{_WHERE}: {use}: found {spans!r}, expected (begin, end) in s, or several such as "
            "[(0, 20), (30, 40)]"
        )
    return pairs


def _refuse_overlap(spans: Sequence[tuple[str, Sequence[float] | None]]) -> None:
    """Refuse fit and check spans that overlap: fitted rows must not be checked."""
    known = [(use, span) for use, span in spans if span is not None]
    for k, (use, span) in enumerate(known):
        for other_use, other in known[:k]:
            if use != other_use and overlap(span, other):
                raise ExperimentError(
                    f"{_WHERE}: {use}: found {tuple(span)}, which overlaps {other_use} "
                    f"{tuple(other)}, expected spans that do not"
                )


def build_experiment(
    content: Mapping[str, Any],
    log: Log,
    spans: Sequence[tuple[str, Sequence[float] | None]],
    *,
    title: str,
    bandwidth: float | None = None,
) -> Experiment:
    """An experiment from the tables of a file and one open log.

    spans: (use, (begin, end) in s) of each record, or (use, None) for all rows
    A body without inertia gets first values from the fit records.
    """
    _refuse_overlap(spans)
    table = Table(content, _WHERE)
    bodies = bodies_from(table.table("model"))
    layout = layout_from(table, bodies)
    columns = columns_of(log, _WHERE, layout.wanted)
    records: list[Record] = []
    for k, (use, span) in enumerate(spans, start=1):
        name = use if span is None else f"{use} {span[0]:g}-{span[-1]:g} s"
        if any(r.file == name for r in records):
            name = f"{name} ({k})"
        part = columns if span is None else cut_to(columns, span, layout, _WHERE)
        records.append(record_of(part, f"{_WHERE}: {name}", RecordEntry(name, use), layout))
    if not any(r.use == "fit" for r in records):
        raise ExperimentError(f"{_WHERE}: fit: found no span, expected at least one (begin, end)")
    fitted = [r for r in records if r.use == "fit"]
    bodies = {name: _with_first_values(body, fitted) for name, body in bodies.items()}
    return Experiment(Path(title), title, bodies, None, layout.channels, bandwidth, tuple(records))


def _with_first_values(body: BodyDescription, records: Sequence[Record]) -> BodyDescription:
    """The body, with inertia and first friction values from its records if it has no inertia.

    raises ExperimentError: the motion shows a negative inertia, or none
    """
    if body.inertia is not None:
        return body
    guess = guess_from(records, body.name)
    start = guess.start_of_inertia
    if not start > 0:
        raise ExperimentError(
            f"{_WHERE}: the motion tells no inertia of {body.name} ({guess.inertia:.3g} "
            f"{unit_of('inertia', body.axis)}): give inertia, or look at signs and units of "
            "position and force"
        )
    return with_first_values(body, inertia=start, level=guess.level, damping=guess.damping)


def channel_table(
    entry: ChannelEntry,
    key: str,
    axis: str,
    log: Log,
    units: Mapping[str, str],
    guesses: dict[str, str],
) -> dict[str, Any]:
    """The table of a channel: as written, or a column's name with the unit for this column.

    guesses: gets the unit that is taken where none is stated
    """
    table: dict[str, Any] = {"column": entry} if isinstance(entry, str) else dict(entry)
    column = table.get("column")
    if "unit" in table or not isinstance(column, str):
        return table
    quantity = BODY_QUANTITIES[key]
    stated = units.get(column) or log.units.get(column)
    along = "prismatic" if "lever_arm" in table else axis  # a force in N beside an angle
    unit = as_unit(stated) if stated else unit_in_name(column, quantity, along)
    if unit is None and (text := unfit_unit(column)):
        weight = f"{text}f" if quantity == "force" and is_unit(f"{text}f") else None
        instead = f"units={{{column!r}: {weight or unit_of(quantity, axis)!r}}}"
        if quantity == "force" and unit_in_name(column, quantity) and axis == "revolute":
            instead = f'{{"column": {column!r}, "lever_arm": {{"value": 0.07, "unit": "m"}}}}'
        raise ExperimentError(
            f"{_WHERE}: {key}: {why_no_unit(column, None, quantity, axis)}: state it, such as "
            f"{instead}, if {text!r} is to be read so"
        )
    if unit is None:
        unit = unit_of(quantity, along)
        guesses[f"channels.{key}.unit"] = f"{unit}: {why_no_unit(column, None, quantity, axis)}"
    return {**table, "unit": unit}


def _time_table(
    entry: ChannelEntry | None, log: Log, units: Mapping[str, str], guesses: dict[str, str]
) -> dict[str, Any]:
    if entry is not None and not isinstance(entry, str):
        return dict(entry)
    if entry is None:
        entry = max(log.names, key=lambda n: likeness(n, "time"), default="")
        if not entry or likeness(entry, "time") == 0:
            raise ExperimentError(
                f"{_WHERE}: time: no column sounds like a time, found {', '.join(log.names)}: give "
                "time or sample_rate"
            )
    unit = units.get(entry) or log.units.get(entry) or unit_in_name(entry, "time")
    if unit is None:
        unit, guesses["channels.time.unit"] = "s", f"s: the name {entry!r} states no unit"
    return {"column": entry, "unit": unit}


def log_of(data: Any) -> Log:
    """Arrays in memory as an open log; the index of a DataFrame becomes a column.

    raises ExperimentError: data without columns
    """
    columns: dict[str, Any] = {}
    units: dict[str, str] = {}
    if isinstance(data, Mapping) and not hasattr(data, "data_vars"):
        columns = {str(name): values for name, values in data.items()}
    elif hasattr(data, "data_vars"):  # xarray
        for name, array in {**data.coords, **data.data_vars}.items():
            columns[str(name)] = array.values
            unit = array.attrs.get("units") or array.attrs.get("unit")
            if isinstance(unit, str):
                units[str(name)] = unit
    elif hasattr(data, "index") and hasattr(data, "columns"):  # pandas
        index = data.index
        if index.dtype.kind in "fmM" or index.name is not None:
            columns["time" if index.name is None else str(index.name)] = index.to_numpy()
        columns |= {str(name): data[name].to_numpy() for name in data.columns}
        if any(v.dtype.kind == "O" for v in map(np.asarray, columns.values())):
            columns = {n: np.asarray(v) for n, v in columns.items()}
    elif hasattr(data, "get_columns"):  # polars
        columns = {column.name: column.to_numpy() for column in data.get_columns()}
    else:
        file = "; of a file: teleopdesign new FILE" if isinstance(data, str | Path) else ""
        raise ExperimentError(
            f"{_WHERE}: data: found {type(data).__name__}, expected a DataFrame, a Dataset of "
            f"xarray or a dict of arrays{file}"
        )
    # dates and durations are read in seconds, whatever their names say: "time_ms"
    units |= {n: "s" for n, v in columns.items() if holds_dates(v)}
    return Log(tuple(columns), lambda wanted: {n: columns[n] for n in wanted}, units)
