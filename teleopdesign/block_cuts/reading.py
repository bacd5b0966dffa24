"""Read an experiment of a whole diagram: from its folder, or from arrays in memory."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..base.arguments import check_types
from ..base.errors import ExperimentError, did_you_mean, quote, unknown
from ..base.toml import Table, read_toml
from ..base.units import measures, to_si
from ..diagrams import Diagram, read_diagram
from ..measurement.channel import Channel, LogLayout, channel_from, frequency_from
from ..measurement.experiment import Experiment, folder_of_experiment
from ..measurement.experiment import load_experiment as load_body_experiment
from ..measurement.from_arrays import log_of
from ..measurement.record import cut_to, record_entries
from ..measurement.tables import columns_of, read_columns
from .diagram_experiment import DiagramExperiment, RecordedLog, StatedComputer, body_of_axis

_FILE = "experiment.toml"
#: keys of [diagram.computer]
_COMPUTER = ("velocity_bandwidth", "delay", "encoder_step")


@check_types
def load_experiment(folder: str | Path) -> Experiment | DiagramExperiment:
    """Read and check an experiment, of bodies or of a whole diagram.

    folder: the folder of experiment.toml (the path of the file is also accepted)
    raises ExperimentError: anything missing, unknown, of the wrong type or unit, in one line

        >>> td.load_experiment(td.example("rod"))
        Experiment "Rod of a one-axis haptic interface (simulated)" (rod)
          device: prismatic, coulomb, viscous
            position in m (resolution 7.2e-06 m)
            actuator_force in N
            interaction_force in N (noise 0.0116 N)
          Record fit.csv.gz (fit): 12000 samples, 12 s at 1000 Hz
          Record check.csv.gz (check): 8000 samples, 8 s at 1000 Hz
    """
    place = folder_of_experiment(Path(folder))
    table = read_toml(place / _FILE, f"{place.name}/{_FILE}")
    if "diagram" not in table.content:
        return load_body_experiment(place)
    table.allow(("title", "diagram", "channels", "comparison", "records", "model"))
    if "model" in table.content:
        raise ExperimentError(
            f"{table.where('model')}: found beside [diagram], expected one of both"
        )
    head = table.table("diagram")
    head.allow(("file", "sample_period", "outside", "computer", "one_pass"))
    diagram = read_diagram(_diagram_file(head, place))
    made = _experiment(table, diagram, place)
    wanted = {c: f"channels.{n}" for n, one in made.channel.items() for c in one.columns}
    logs = []
    for file, use, offset_names, span in record_entries(table, place):
        name = f"{place.name}/{file}"
        columns = read_columns(place / file, name, wanted)
        if span is not None:
            bodies = body_of_axis(made.axis(made.recorded[0]))
            layout = LogLayout(made.channel, bodies, made.sample_rate)
            columns = cut_to(columns, span, layout, name)
            file = f"{file} {span[0]:g}-{span[1]:g} s"
        logs.append(RecordedLog(file, use, offset_names, columns))
    return replace(made, logs=tuple(logs))


@check_types
def diagram_experiment(
    diagram: Diagram,
    data: Any,
    *,
    channels: Mapping[str, Mapping[str, Any]],
    check: Any = None,
    outside: Sequence[str] = (),
    sample_period: float | None = None,
    one_pass: bool = False,
    bandwidth: float | None = None,
    title: str = "data",
) -> DiagramExperiment:
    """An experiment of a whole diagram from arrays in memory.

    data, check: a DataFrame or a dict of arrays, to fit on and to report errors on
    channels: "time" and signals of the diagram -> a table as in [channels] of a file
    outside: signals from outside that are zero;  sample_period: of the computer, s;  bandwidth: Hz
    one_pass: all columns of a row were written in one pass of the computer
    raises ExperimentError: no such signal or column, a unit that does not fit
    """
    head: dict[str, Any] = {"outside": dict.fromkeys(outside, 0), "one_pass": one_pass}
    if sample_period is not None:
        head["sample_period"] = {"value": sample_period, "unit": "s"}
    content: dict[str, Any] = {"title": title, "diagram": head, "channels": dict(channels)}
    if bandwidth is not None:
        content["comparison"] = {"bandwidth": {"value": bandwidth, "unit": "Hz"}}
    made = _experiment(Table(content, "experiment"), diagram, Path(title))
    wanted = {c: f"channels.{n}" for n, one in made.channel.items() for c in one.columns}
    sources = [("fit", data)] + ([("check", check)] if check is not None else [])
    logs = [
        RecordedLog(use, use, frozenset(), columns_of(log_of(source), f"experiment: {use}", wanted))
        for use, source in sources
    ]
    return replace(made, logs=tuple(logs))


def _experiment(table: Table, diagram: Diagram, folder: Path) -> DiagramExperiment:
    """The experiment without its records."""
    head, channels = table.table("diagram"), table.table("channels")
    tables: dict[str, Table] = {}
    not_read = set()
    for name in channels.content:
        if name == "sample_rate":
            continue
        if name != "time" and name not in diagram.signals:
            wrong = unknown(f"signal of {diagram.name}", name, diagram.signals)
            raise ExperimentError(f"{channels.where()}: {wrong}")
        entry = channels.table(name)
        if not entry.flag("read_by_computer", True):
            not_read.add(name)
        rest = {k: v for k, v in entry.content.items() if k != "read_by_computer"}
        tables[name] = Table(rest, entry.file, entry.key)
    comparison = table.table("comparison")
    comparison.allow(("bandwidth",))
    made = DiagramExperiment(
        folder=folder,
        title=table.text("title", folder.name),
        diagram=diagram,
        channels=tables,
        channel={},
        zero=_zero(head.table("outside"), diagram, tables),
        computer=_computer(head),
        bandwidth=frequency_from(comparison, "bandwidth") if comparison.content else None,
        logs=(),
        sample_rate=_sample_rate(channels),
        read_by_computer=frozenset(tables) - not_read,
    )
    channel = {name: _channel_of(made, name) for name in tables}
    made = replace(made, channel=channel)
    _refuse_shared_columns(channels, channel)
    if not made.cuts.tested:
        why = "; ".join(f"{block}: {text}" for block, text in made.cuts.untested.items())
        raise ExperimentError(f"{channels.where()}: the recorded signals test no block: {why}")
    return made


def _sample_rate(channels: Table) -> float | None:
    if ("time" in channels.content) == ("sample_rate" in channels.content):
        raise ExperimentError(f'{channels.where()}: expected one of "time" and "sample_rate"')
    return None if "time" in channels.content else frequency_from(channels, "sample_rate")


def _channel_of(experiment: DiagramExperiment, name: str) -> Channel:
    table = experiment.channels[name]
    if name == "time":
        return channel_from(table, "time", {})
    motion = experiment.diagram.is_position(name) or (
        experiment.diagram.outside.get(name) == "position"
    )
    quantity = "position" if motion else "actuator_force"
    return channel_from(table, f"any.{quantity}", body_of_axis(experiment.axis(name)))


def _zero(table: Table, diagram: Diagram, recorded: Mapping[str, Table]) -> tuple[str, ...]:
    for name in table.content:
        if name not in diagram.outside:
            wrong = unknown("signal from outside", name, diagram.outside)
            raise ExperimentError(f"{table.where()}: {wrong}")
        if table.number(name) != 0:
            raise ExperimentError(
                f"{table.where(name)}: found {table.number(name):g}, expected 0 (record the signal)"
            )
        if name in recorded:
            raise ExperimentError(f"{table.where(name)}: is recorded too, expected one of both")
    return tuple(table.content)


def _computer(head: Table) -> StatedComputer:
    stated = head.table("computer")
    stated.allow(_COMPUTER)
    period = _quantity(head, "sample_period", "time") if "sample_period" in head.content else None
    kinds = {"velocity_bandwidth": "frequency", "delay": "time", "encoder_step": "position"}
    values = {key: _quantity(stated, key, kinds[key]) for key in stated.content}
    return StatedComputer(period, one_pass=head.flag("one_pass", False), **values)


def _quantity(table: Table, key: str, quantity: str) -> float:
    """Read { value, unit } as a positive number in SI."""
    entry = table.table(key)
    entry.allow(("value", "unit"))
    unit, where = entry.text("unit"), entry.where("unit")
    axis = "revolute" if measures(unit, quantity, "revolute") else "prismatic"
    return to_si(entry.number("value", above=0), unit, quantity=quantity, axis=axis, where=where)


def _diagram_file(head: Table, folder: Path) -> Path:
    path = folder / head.text("file")
    if not path.is_file() or not path.resolve().is_relative_to(folder.resolve()):
        names = sorted(p.name for p in folder.glob("*.toml") if p.name != _FILE)
        raise ExperimentError(
            f"{head.where('file')}: no file {quote(head.text('file'))} in {folder.name}/, found "
            f"{', '.join(names) or 'none'}{did_you_mean(head.text('file'), names)}"
        )
    return path


def _refuse_shared_columns(table: Table, channels: Mapping[str, Channel]) -> None:
    first_use: dict[str, str] = {}
    for name, channel in channels.items():
        for column in channel.columns:
            if first_use.setdefault(column, name) != name:
                raise ExperimentError(
                    f"{table.where(name)}: found column {quote(column)}, which "
                    f"{first_use[column]} uses"
                )
