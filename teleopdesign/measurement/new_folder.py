"""Make an experiment's folder from logs: by the proposals of a survey, or as another one."""

from __future__ import annotations

import re
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..base.errors import ExperimentError, quote
from ..base.files import read_whole, write_beside, write_text
from ..base.toml import Table, comment_text, read_toml, string_text, texts_in, toml_text
from ..base.units import unit_of
from .channel import LogLayout, layout_from
from .description import BodyDescription, ModelValue, bodies_from, with_first_values
from .doors._log import Log
from .encoder import reading_step, rests
from .first_guess import guess_from
from .limits import SHORTEST, SMALL
from .motion import SHORTEST as SEGMENT
from .record import Record, RecordEntry, overlap, read_record
from .reversals import runs_one_way
from .saving import body_lines, file_within, guesses_text, records_text
from .survey import Survey, spans_of
from .survey.content import STATEMENTS
from .tables import open_log

#: (begin, end) of the fit record and of the check record, s from the first row of a log
FitAndCheck = tuple[tuple[float, float], tuple[float, float]]

_FILE = "experiment.toml"
#: a table [[records]] of experiment.toml, up to the next table
_RECORDS = re.compile(r"^\s*\[\[\s*records\s*\]\].*?(?=^\s*\[|\Z)", re.M | re.S)


def make_folder(
    survey: Survey,
    logs: Sequence[Path],
    folder: Path,
    *,
    title: str,
    inertia: float | None = None,
    spans: FitAndCheck | None = None,
    overwrite: bool = False,
) -> Path:
    """Copy the logs into a folder and write experiment.toml beside them.

    One log is cut into a fit and a check record, at `spans` (s from its first row) if given. Of
    several logs, the last is the check record.

    overwrite: replace an existing experiment.toml
    raises ExperimentError: the folder holds an experiment already, or cannot be written; spans that
        overlap, lie outside of the log or belong to several logs; logs that state other units
    """
    names = [log.name for log in logs]
    records = records_of(names, spans)
    if spans is not None:
        check_spans(spans, survey.duration, names[0])
    if not overwrite:
        require_new(folder)
    require_same_statements(logs, counted="time" not in survey.channels)
    copy_logs(logs, folder)
    layout = _layout_of(survey)
    if len(names) == 1 and spans is None and (parts := _usual_cut(survey, folder, layout, names)):
        records = records_of(names, parts)
    body = body_with_friction(survey.axis)
    if inertia is not None:
        unit = unit_of("inertia", survey.axis)
        body = replace(body, inertia=ModelValue(inertia, unit, True, body.where))
    else:
        fitted = [r for r in records if r["use"] == "fit"]
        entries = [RecordEntry(r["file"], "fit", span=r.get("span")) for r in fitted]
        read = [read_record(folder, entry, layout) for entry in entries]
        body = _with_start(body, read, survey.guesses)
    write_text(folder / _FILE, experiment_text(survey, records, title=title, body=body))
    return folder


def body_with_friction(axis: str) -> BodyDescription:
    """A body with plain friction, of which no value is known."""
    return BodyDescription("device", axis, None, {"coulomb": {}, "viscous": {}}, "model.device")


def _with_start(
    body: BodyDescription, records: Sequence[Record], guesses: dict[str, str]
) -> BodyDescription:
    """The body with first values from the fit records, and a guess where these tell no inertia."""
    first = guess_from(records, body.name)
    start = first.start_of_inertia
    if not first.inertia > 0:
        guesses["model.device.inertia"] = (
            "the motion hardly tells the inertia: a start of the size of its error"
            if start > 0
            else "the motion tells no inertia: look at signs and units of position and force"
        )
    return with_first_values(
        body, inertia=start if start > 0 else 1.0, level=first.level, damping=first.damping
    )


def _layout_of(survey: Survey) -> LogLayout:
    """The channels of a survey, read as those of a file."""
    content = {"channels": survey.channels, "model": {"device": {"axis": survey.axis}}}
    table = Table(content, _FILE)
    return layout_from(table, bodies_from(table.table("model")))


def require_same_statements(logs: Sequence[Path], *, counted: bool) -> None:
    """Refuse a log that states another unit, rate or constant of the machine than the first one.

    All logs of an experiment are read by one table of channels, which holds what the first states.
    counted: rows are counted at a rate; where each log has its times, the rates may differ
    raises ExperimentError: with the two statements
    """
    opened = [(log.name, open_log(log, log.name)) for log in logs if log.is_file()]
    first = opened[0] if opened else ("", Log((), dict))
    for name, log in opened[1:]:
        for stated in STATEMENTS if counted else STATEMENTS[1:]:
            here, there = stated(log.remarks), stated(first[1].remarks)
            if here is not None and here[:-1] != (there and there[:-1]):
                words = f"{name} states {quote(here[-1])}, and {first[0]} "
                words += f"states {quote(there[-1])}" if there else "does not"
                raise ExperimentError(f"{words}: make an experiment of each")
        for column, unit in log.units.items():
            if (known := first[1].units.get(column, unit)) != unit:
                raise ExperimentError(
                    f"{name}: column {quote(column)} is in {unit}, and in {known} in {first[0]}: "
                    "make an experiment of each"
                )


def copy_logs(logs: Sequence[Path], folder: Path) -> None:
    """Copy logs into a folder, which is made; raises ExperimentError: it cannot be written."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for log in logs:
            target = folder / log.name
            if log.resolve() == target.resolve():
                continue
            if log.is_dir():
                shutil.copytree(log, target)
                continue
            with write_beside(target) as part:
                shutil.copyfile(log, part)
    except OSError as problem:
        raise ExperimentError(f"{folder.name}: cannot be written: {problem.strerror}") from None


def require_new(folder: Path) -> None:
    """Raise an ExperimentError if a folder holds an experiment already."""
    if (folder / _FILE).exists():
        raise ExperimentError(
            f"{folder.name}/{_FILE}: is there already: --overwrite writes it anew, --output FOLDER "
            "beside it"
        )


def check_spans(spans: FitAndCheck, duration: float, name: str) -> None:
    """Refuse spans of a log that overlap or begin outside of it."""
    for use, (begin, end) in zip(("fit", "check"), spans, strict=True):
        # a rounded end is meant
        if not 0 <= begin < end or begin >= duration or end > (1 + SMALL) * duration:
            raise ExperimentError(
                f"{name}: {use} span: found {begin:g} to {end:g} s, expected two instants in "
                f"order within the log's {duration:.4g} s"
            )
    (fit_begin, fit_end), (check_begin, check_end) = spans
    if overlap(*spans):
        raise ExperimentError(
            f"{name}: spans: found fit {fit_begin:g} to {fit_end:g} s and check "
            f"{check_begin:g} to {check_end:g} s, expected spans that do not overlap"
        )


def records_of(names: Sequence[str], spans: FitAndCheck | None = None) -> list[dict[str, Any]]:
    """Whole files as records, of which the last of several is the check record; or parts of one.

    raises ExperimentError: spans of several files
    """
    if spans is None:
        uses = ["fit"] * max(len(names) - 1, 1) + ["check"]
        return [{"file": name, "use": use} for name, use in zip(names, uses, strict=False)]
    if len(names) > 1:
        raise ExperimentError(
            f"{names[0]}: spans: found {len(names)} logs, expected one that is cut; of several the "
            "last is the check record"
        )
    parts = zip(("fit", "check"), spans, strict=True)
    return [{"file": names[0], "use": use, "span": span} for use, span in parts]


def _usual_cut(
    survey: Survey, folder: Path, layout: LogLayout, names: Sequence[str]
) -> FitAndCheck | None:
    """The parts of one log that are fitted and checked; None, with a note: it is fitted whole.

    Where a part of the usual cut would be too short, the log is cut in the middle of its rows.
    """
    usual = spans_of(survey.duration, survey.trials)
    middle = float(f"{np.median(survey.time):.4g}")
    why = "too short to be cut into"
    for parts in (usual, ((0.0, middle), (middle, usual[1][1]))):
        entries = [RecordEntry(names[0], "fit", span=part) for part in parts]
        try:
            records = [read_record(folder, entry, layout) for entry in entries]
        except ExperimentError:  # too few rows in a part
            continue
        lengths = ([(s.stop - s.start) * r.sample_time for s in r.segments] for r in records)
        if min(sum(t for t in times if t >= SEGMENT) for times in lengths) < SHORTEST:
            continue
        whys = (_why_untold(r, p, survey.duration) for r, p in zip(records, parts, strict=True))
        why = next(filter(None, whys), "")
        if not why:
            return parts
        break
    survey.notes.append(
        f"{why} a fit and a check record: errors are computed on blocks that are left out of the "
        "fit in turn"
    )
    return None


def _why_untold(record: Record, part: tuple[float, float], duration: float) -> str:
    """Why a part of a log is no record of its own: the body rests or runs one way; "": it is."""
    x = record.signals["device.position"]
    when = f"from {part[0]:g} to {min(part[1], duration):.4g} s, so that the log is not cut into"
    if rests(x, reading_step(x)):
        return f"the body rests {when}"
    return f"the body moves one way {when}" if runs_one_way(x, reading_step(x)) else ""


def experiment_text(
    survey: Survey,
    records: Sequence[Mapping[str, Any]],
    *,
    title: str,
    body: BodyDescription,
    kind: str = "",
) -> str:
    """The text of experiment.toml, with a comment on each guessed channel.

    kind: "friction curve"; "" for records over time
    """
    force, length = (unit_of(quantity, survey.axis) for quantity in ("force", "position"))
    notes = {"axis": f"# forces in {force}, positions in {length}"}
    if body.inertia is not None and not body.inertia.fixed:
        notes["inertia"] = "# a start, from the log; fixed = true if you know it"
    lines = ["# Written by `teleopdesign new`. What it guessed stands under [guessed] at the end:"]
    lines += ["# correct it there where it is used, and take its line out.", ""]
    lines += [f"kind = {string_text(kind)}"] if kind else []
    lines += [f"title = {string_text(title)}", "", *body_lines(body, notes), "[channels]"]
    for key, entry in survey.channels.items():
        comments = [w for k, w in survey.guesses.items() if k.startswith(f"channels.{key}.")]
        lines += [comment_text(f"guessed: {c}") for c in comments]
        lines.append(f"{key} = {toml_text(entry)}")
    if survey.unused:
        lines += ["", "# columns of the log that are in no channel:"]
        lines += [
            comment_text(f"  {string_text(name)}: {why}") for name, why in survey.unused.items()
        ]
    lines += ["", *records_text(records), *guesses_text(survey.guesses)]
    return "\n".join(lines) + "\n"


def make_folder_like(
    source: Path,
    logs: Sequence[Path],
    folder: Path,
    *,
    title: str,
    spans: FitAndCheck | None = None,
) -> None:
    """Copy logs into a folder, with the experiment.toml of another one: all but its records.

    Columns, units, signs and model are those of `source`, a folder; files that its experiment.toml
    names, such as a URDF or a diagram, are copied too. Of several logs the last is the check
    record; one log is fitted whole, unless `spans` cut it (s from its first row).
    raises ExperimentError: no experiment is there, the folder cannot be written, or spans belong to
        several logs
    """
    content = read_toml(source / _FILE, f"{source.name}/{_FILE}").content
    names = [log.name for log in logs]
    records = records_of(names, spans)
    known = [source / str(one["file"]) for one in content.get("records", [])[:1] if "file" in one]
    counted = "time" not in content.get("channels", {})
    require_same_statements([*known, *logs], counted=counted)
    whole = read_whole(source / _FILE).decode("utf-8")
    text = _RECORDS.sub("", "\n".join(whole.splitlines()))
    text = re.sub(r"(?m)^title\s*=.*$", lambda _: f"title = {string_text(title)}", text, count=1)
    copy_logs(logs, folder)
    others = {key: value for key, value in content.items() if key != "records"}
    for name in dict.fromkeys(texts_in(others)):
        if file_within(source, name) is not None:
            copy_logs([source / name], (folder / name).parent)
    write_text(folder / _FILE, "\n".join([text.rstrip(), "", *records_text(records), ""]))
