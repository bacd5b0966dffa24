"""The files of an experiment: experiment.toml, a table in SI for each record, a digest of all."""

from __future__ import annotations

import gzip
import hashlib
import io
import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.errors import ExperimentError
from ..base.files import follow_links, write_beside, write_text
from ..base.toml import comment_text, inline_text, read_toml, string_text, toml_text
from ..base.units import unit_of
from .channel import BODY_QUANTITIES
from .description import BodyDescription, Effects, ModelValue
from .reading import reading_lines

#: bytes that are read at once
_BLOCK = 1 << 20

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
        uses = [record.use for record in experiment.records]
        names = [
            f"{use}.csv.gz" if uses.count(use) == 1 else f"{use}_{k}.csv.gz"
            for k, use in enumerate(uses, start=1)
        ]
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
        lines += ["[model.environment.effects]", *_effect_lines(experiment.environment.effects), ""]
    lines += [comment_text(line) for line in reading_lines(experiment.reading)]
    lines += ["[channels]", *['time = { column = "t", unit = "s" }'] * (not experiment.is_curve)]
    one = tuple(experiment.bodies) == ("device",)
    present = [k for k in experiment.channels if all(k in r.signals for r in experiment.records)]
    for key in present:
        channel = experiment.channels[key]
        if channel.body is None or channel.quantity not in BODY_QUANTITIES:
            continue
        unit = unit_of(BODY_QUANTITIES[channel.quantity], experiment.axis(channel.body))
        stated = {n: getattr(channel, n) for n in ("resolution", "noise", "measured")}
        entry = {"column": key, "unit": unit, **{n: v for n, v in stated.items() if v}}
        name = key.removeprefix("device.") if one else f'"{key}"'
        lines.append(f"{name} = {toml_text(entry)}")
    if any(len(r.segments) > 1 for r in experiment.records):
        lines.append('segment = { column = "segment" }')
    if experiment.bandwidth is not None:
        lines += ["", "[comparison]"]
        lines += [f'bandwidth = {{ value = {experiment.bandwidth!r}, unit = "Hz" }}']
    lines.append("")
    lines += records_text(
        {"file": name, "use": record.use, **dict.fromkeys(sorted(record.offset_names), "own")}
        for record, name in zip(experiment.records, names, strict=True)
    )
    lines += guesses_text(experiment.guesses)
    return "\n".join(lines) + "\n"


def body_lines(body: BodyDescription, notes: Mapping[str, str] | None = None) -> list[str]:
    """The lines of [model.BODY] with its effects;  notes: comments behind some of its keys."""
    entries = {"axis": string_text(body.axis)}
    if body.inertia is not None:
        entries["inertia"] = _value(body.inertia)
    lines = [f"[model.{body.name}]"]
    for key, text in entries.items():
        note = (notes or {}).get(key)
        lines.append(f"{key} = {text}" if note is None else f"{key} = {text}".ljust(60) + note)
    return [*lines, f"[model.{body.name}.effects]", *_effect_lines(body.effects), ""]


def _effect_lines(effects: Effects) -> list[str]:
    written = {n: {k: _value(v) for k, v in values.items()} for n, values in effects.items()}
    return [f"{name} = {inline_text(values)}" for name, values in written.items()]


def records_text(records: Iterable[Mapping[str, Any]]) -> list[str]:
    """Lines of the tables [[records]]."""
    return [
        line
        for record in records
        for line in ("[[records]]", *(f"{k} = {toml_text(v)}" for k, v in record.items()))
    ]


def guesses_text(guesses: Mapping[str, str]) -> list[str]:
    """Lines of the table [guessed]; none without a guess."""
    lines = [f"{string_text(key)} = {string_text(why)}" for key, why in guesses.items()]
    return ["", "[guessed]", *lines] if lines else []


def _value(value: ModelValue) -> str:
    marks = {"unit": value.unit, "fixed": value.fixed or None, "stderr": value.stderr}
    marks = {key: mark for key, mark in marks.items() if mark is not None}
    number = float(value.value)
    return toml_text({"value": number, **marks} if marks else number)


def is_experiment(folder: Path) -> bool:
    """Whether a folder holds an experiment."""
    try:
        return (folder / "experiment.toml").is_file()
    except OSError:  # a text that is too long for a path
        return False


def experiment_files(folder: Path) -> dict[str, Path | None]:
    """Name -> file, for experiment.toml and its records; for a folder, each file in it.

    None: the folder has no file of that name. If experiment.toml cannot be read, it is the only
        entry; `load_experiment` gives the reason.
    """
    files: dict[str, Path | None] = {"experiment.toml": file_within(folder, "experiment.toml")}
    try:
        table = read_toml(folder / "experiment.toml", f"{folder.name}/experiment.toml")
        records = [t.text("file") for t in table.tables("records")]
    except ExperimentError:
        return files
    for name in records:
        if "\0" not in name and (folder / name).is_dir():
            for path in sorted((folder / name).rglob("*")):
                inside = path.relative_to(folder).as_posix()
                files[inside] = file_within(folder, inside)
        else:
            files[name] = file_within(folder, name)
    return files


def file_within(folder: Path, name: str) -> Path | None:
    """The path of a regular file in the folder; None: there is none of that name."""
    path = folder / name
    is_file = os.path.isfile(path)  # a sentence may be too long for a path
    return path if is_file and follow_links(path).is_relative_to(follow_links(folder)) else None


def content_digest(folder: Path) -> str:
    """SHA-256 of the content of an experiment's files and of their names within the folder."""
    whole = hashlib.sha256()
    for name, path in experiment_files(folder).items():
        whole.update(f"{name}\0".encode("utf-8", "surrogatepass"))
        for block in [b"no file"] if path is None else _blocks(path):
            whole.update(block)
        whole.update(b"\0")
    return whole.hexdigest()


def _blocks(path: Path) -> Iterator[bytes]:
    """The content of a file block by block; one fixed text for a file that cannot be read."""
    try:
        with path.open("rb") as file:
            while block := file.read(_BLOCK):
                yield block
    except OSError:
        yield b"cannot be read"
