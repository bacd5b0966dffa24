"""Write an experiment as a folder: experiment.toml, and a table in SI for each record."""

from __future__ import annotations

import gzip
import io
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..base.errors import ExperimentError
from ..base.files import write_beside, write_text
from ..base.toml import comment_text, inline_text, string_text
from ..base.units import unit_of
from .channel import BODY_QUANTITIES
from .description import BodyDescription, ModelValue
from .reading import reading_table

if TYPE_CHECKING:
    from .experiment import Experiment

_ENVIRONMENT = ("stiffness", "damping", "contact_position")


def write_experiment(experiment: Experiment, folder: str | Path) -> Path:
    """Write a folder that reads as the same experiment, with signals in SI on their even grid.

    raises ExperimentError: the folder holds an experiment already, or cannot be written
    """
    folder = Path(folder)
    if (folder / "experiment.toml").exists():
        raise ExperimentError(f"{folder.name}/experiment.toml: is there already")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        names = _file_names(experiment)
        for record, name in zip(experiment.records, names, strict=True):
            columns = dict(record.signals)
            if not experiment.is_curve:
                columns = {"t": record.time, **columns}
            if len(record.segments) > 1:
                labels = np.zeros(len(record.time))
                for k, rows in enumerate(record.segments):
                    labels[rows] = k
                columns["segment"] = labels
            text = io.StringIO()
            text.write(",".join(columns) + "\n")
            np.savetxt(text, np.column_stack(list(columns.values())), fmt="%.17g", delimiter=",")
            packed = gzip.compress(text.getvalue().encode(), 6, mtime=0)
            with write_beside(folder / name) as part:
                part.write_bytes(packed)
        toml = experiment_text(experiment, names)
        write_text(folder / "experiment.toml", toml)
    except OSError as problem:
        raise ExperimentError(f"{folder.name}: cannot be written: {problem.strerror}") from None
    return folder


def _file_names(experiment: Experiment) -> list[str]:
    names: list[str] = []
    for k, record in enumerate(experiment.records, start=1):
        alone = sum(r.use == record.use for r in experiment.records) == 1
        names.append(f"{record.use}.csv.gz" if alone else f"{record.use}_{k}.csv.gz")
    return names


def experiment_text(experiment: Experiment, names: list[str]) -> str:
    """The text of experiment.toml for records that are written in SI."""
    lines = [f"kind = {string_text(experiment.kind)}"] * experiment.is_curve
    lines += [f"title = {string_text(experiment.title)}", ""]
    for body in experiment.bodies.values():
        lines += body_lines(body)
    if experiment.environment is not None:
        values = experiment.environment.values
        lines += ["[model.environment]"]
        lines += [f"{n} = {_value(values[n])}" for n in _ENVIRONMENT if n in values]
        lines += ["[model.environment.effects]"]
        for name, parameters in experiment.environment.effects.items():
            lines.append(f"{name} = {inline_text({k: _value(v) for k, v in parameters.items()})}")
        lines.append("")
    lines += [comment_text(line) for line in reading_table(experiment.reading)]
    lines += ["[channels]", *['time = { column = "t", unit = "s" }'] * (not experiment.is_curve)]
    one = tuple(experiment.bodies) == ("device",)
    present = [k for k in experiment.channels if all(k in r.signals for r in experiment.records)]
    for key in present:
        channel = experiment.channels[key]
        if channel.body is None or channel.quantity not in BODY_QUANTITIES:
            continue
        unit = unit_of(BODY_QUANTITIES[channel.quantity], experiment.axis(channel.body))
        entry = {"column": string_text(key), "unit": string_text(unit)}
        if channel.resolution is not None:
            entry["resolution"] = repr(channel.resolution)
        if channel.noise is not None:
            entry["noise"] = repr(channel.noise)
        if channel.measured:
            entry["measured"] = "true"
        name = key.removeprefix("device.") if one else f'"{key}"'
        lines.append(f"{name} = {inline_text(entry)}")
    if any(len(r.segments) > 1 for r in experiment.records):
        lines.append('segment = { column = "segment" }')
    if experiment.bandwidth is not None:
        lines += ["", "[comparison]"]
        lines += [f'bandwidth = {{ value = {experiment.bandwidth!r}, unit = "Hz" }}']
    lines.append("")
    for record, name in zip(experiment.records, names, strict=True):
        lines += ["[[records]]", f"file = {string_text(name)}", f"use = {string_text(record.use)}"]
        lines += [f'{offset} = "own"' for offset in sorted(record.offset_names)]
    return "\n".join(lines) + "\n"


def body_lines(body: BodyDescription) -> list[str]:
    """The lines of [model.BODY] with its effects."""
    lines = [f"[model.{body.name}]", f"axis = {string_text(body.axis)}"]
    if body.inertia is not None:
        lines.append(f"inertia = {_value(body.inertia)}")
    lines.append(f"[model.{body.name}.effects]")
    for name, values in body.effects.items():
        lines.append(f"{name} = {inline_text({k: _value(v) for k, v in values.items()})}")
    return [*lines, ""]


def _value(value: ModelValue) -> str:
    entries = {"value": repr(float(value.value))}
    if value.unit is not None:
        entries["unit"] = string_text(value.unit)
    if value.fixed:
        entries["fixed"] = "true"
    if value.stderr is not None:
        entries["stderr"] = repr(float(value.stderr))
    if value.unit is None and not value.fixed and value.stderr is None:
        return entries["value"]
    return inline_text(entries)
