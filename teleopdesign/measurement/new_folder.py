"""Make an experiment's folder from logs: the proposals of a survey, written with their reasons."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..base.errors import ExperimentError
from ..base.files import write_beside, write_text
from ..base.toml import Table, comment_text, inline_text, string_text
from .channel import layout_from
from .description import bodies_from
from .encoder import reading_step, rests
from .first_guess import FirstGuess, guess_from
from .limits import SMALL
from .motion import SHORTEST as SEGMENT
from .record import RecordEntry, overlap, read_record
from .record_clock import FEWEST, SHORTEST
from .reversals import runs_one_way
from .survey import Survey, spans_of
from .survey.content import sample_time_of
from .survey.derivative import unwrap_column, wrap_of

#: (begin, end) of the fit record and of the check record, s from the first row of a log
FitAndCheck = tuple[tuple[float, float], tuple[float, float]]

_FILE = "experiment.toml"


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
        overlap, lie outside of the log or belong to several logs
    """
    names = [log.name for log in logs]
    if spans is not None:
        check_spans(spans, survey.duration, names)
    if not overwrite:
        require_new(folder)
    copy_logs(logs, folder)
    records = _records(survey, names, spans)
    first = _first_values(survey, folder, records) if inertia is None else None
    if first is not None and not first.inertia > 0:
        survey.guesses["model.device.inertia"] = (
            "the motion hardly tells the inertia: a start of the size of its error"
            if first.start_of_inertia > 0
            else "the motion tells no inertia: look at signs and units of position and force"
        )
    text = experiment_text(survey, records, title=title, inertia=inertia, first=first)
    write_text(folder / _FILE, text)
    return folder


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


def check_spans(spans: FitAndCheck, duration: float, names: Sequence[str]) -> None:
    """Refuse spans that overlap, begin outside of the log, or belong to several logs."""
    if len(names) > 1:
        raise ExperimentError(
            f"{names[0]}: spans: found {len(names)} logs, expected one that is cut; of several the "
            "last is the check record"
        )
    for use, (begin, end) in zip(("fit", "check"), spans, strict=True):
        # a rounded end is meant
        if not 0 <= begin < end or begin >= duration or end > (1 + SMALL) * duration:
            raise ExperimentError(
                f"{names[0]}: {use} span: found {begin:g} to {end:g} s, expected two instants in "
                f"order within the log's {duration:.4g} s"
            )
    (fit_begin, fit_end), (check_begin, check_end) = spans
    if overlap(*spans):
        raise ExperimentError(
            f"{names[0]}: spans: found fit {fit_begin:g} to {fit_end:g} s and check "
            f"{check_begin:g} to {check_end:g} s, expected spans that do not overlap"
        )


def _records(
    survey: Survey, names: Sequence[str], spans: FitAndCheck | None
) -> list[dict[str, Any]]:
    if len(names) > 1:
        return records_of(names)
    fit, check = _usual_spans(survey) if spans is None else spans
    if spans is None and (why := _why_whole(survey, (fit, check))):
        survey.notes.append(
            f"{why} a fit and a check record: errors are computed on blocks that are left out of "
            "the fit in turn"
        )
        return records_of(names)
    return [
        {"file": names[0], "use": "fit", "span": fit},
        {"file": names[0], "use": "check", "span": check},
    ]


def records_of(names: Sequence[str]) -> list[dict[str, Any]]:
    """Whole files as records: of several, the last is the check record."""
    uses = ["fit"] * max(len(names) - 1, 1) + ["check"]
    return [{"file": name, "use": use} for name, use in zip(names, uses, strict=False)]


def _why_whole(survey: Survey, parts: FitAndCheck) -> str:
    """Why a log is not cut into these parts; "" where both are long enough and reverse."""
    if min(_lasting(survey, *part) for part in parts) < _shortest(survey):
        return "too short to be cut into"
    x = survey.columns[survey.channels["position"]["column"]].values
    step, unwrapped = reading_step(x), unwrap_column(x, wrap_of(x))
    for begin, end in parts:
        inside = (survey.time >= begin) & (survey.time < end)
        when = f"from {begin:g} to {min(end, survey.duration):.4g} s"
        if inside.any() and rests(x[inside], step):
            return f"the body rests {when}, so that the log is not cut into"
        if inside.any() and runs_one_way(unwrapped[inside], step):
            return f"the body moves one way {when}, so that the log is not cut into"
    return ""


def _usual_spans(survey: Survey) -> FitAndCheck:
    """The usual cut of one log, or the middle of its rows where one part would be too short."""
    parts = spans_of(survey.duration, survey.trials)
    if min(_lasting(survey, *part) for part in parts) >= _shortest(survey):
        return parts
    middle = float(f"{np.median(survey.time):.4g}")
    return (0.0, middle), (middle, parts[1][1])


def _shortest(survey: Survey) -> float:
    """The shortest record that can be read, s."""
    h = sample_time_of(survey)
    return max(FEWEST * h, SHORTEST) + h  # the row at a cut belongs to the other part


def _lasting(survey: Survey, begin: float, end: float) -> float:
    """Time that the segments of a part cover, s: no pause, and no segment too short to count.

    Behind the rows that the survey looked at, the log is taken to be one segment.
    """
    h, last = sample_time_of(survey), float(survey.time[-1])
    inside = survey.time[(survey.time >= begin) & (survey.time < end)]
    starts = np.searchsorted(inside, survey.trials)
    pauses = np.flatnonzero(np.round(np.diff(inside) / h) > 1) + 1
    ends = np.unique([0, *starts, *pauses, len(inside)])
    segments = h * np.diff(ends)
    behind = max(min(end, survey.duration) - max(begin, last), 0.0)
    if behind and len(segments):
        segments[-1] += behind
    return float(segments[segments >= SEGMENT].sum()) if len(segments) else behind


def _first_values(survey: Survey, folder: Path, records: Sequence[Mapping[str, Any]]) -> FirstGuess:
    """First values of the model from the fit records, read as the experiment will read them."""
    content = {"channels": survey.channels, "model": {"device": {"axis": survey.axis}}}
    table = Table(content, f"{folder.name}/{_FILE}")
    layout = layout_from(table, bodies_from(table.table("model")))
    fitted = [
        RecordEntry(r["file"], "fit", span=r.get("span")) for r in records if r["use"] == "fit"
    ]
    read = [read_record(folder, entry, layout) for entry in fitted]
    return guess_from(read, "device")


def experiment_text(
    survey: Survey,
    records: Sequence[Mapping[str, Any]],
    *,
    title: str,
    inertia: float | None = None,
    first: FirstGuess | None = None,
    kind: str = "",
) -> str:
    """The text of experiment.toml, with a comment on each guessed channel.

    kind: "friction curve"; "" for records over time
    """
    axis = survey.axis
    force, length = ("N", "m") if axis == "prismatic" else ("N*m", "rad")
    mass = "kg" if axis == "prismatic" else "kg*m^2"
    lines = ["# Written by `teleopdesign new`. What it guessed stands under [guessed] at the end:"]
    lines += ["# correct it there where it is used, and take its line out.", ""]
    lines += [f"kind = {string_text(kind)}"] if kind else []
    lines += [f"title = {string_text(title)}", "", "[model.device]"]
    lines += [
        f"axis = {string_text(axis)}".ljust(60) + f"# forces in {force}, positions in {length}"
    ]
    if inertia is not None:
        lines.append(f'inertia = {{ value = {inertia!r}, unit = "{mass}", fixed = true }}')
    elif first is not None:
        value = _round(first.start_of_inertia) if first.start_of_inertia > 0 else 1.0
        lines.append(
            f'inertia = {{ value = {value!r}, unit = "{mass}" }}'.ljust(60)
            + "# a start, from the log; fixed = true if you know it"
        )
    lines.append("[model.device.effects]")
    level, damping = (first.level, first.damping) if first else (0.0, 0.0)
    lines.append(f"coulomb = {_first_of('level', level, force)}")
    lines.append(f"viscous = {_first_of('damping', damping, f'{force}*s/{length}')}")
    lines += ["", "[channels]"]
    for key, entry in survey.channels.items():
        comments = [w for k, w in survey.guesses.items() if k.startswith(f"channels.{key}.")]
        line = f"{key} = {toml_table(entry)}"
        lines += [comment_text(f"guessed: {c}") for c in comments] + [line]
    if survey.unused:
        lines += ["", "# columns of the log that are in no channel:"]
        lines += [
            comment_text(f"  {string_text(name)}: {why}") for name, why in survey.unused.items()
        ]
    lines += ["", *records_text(records)]
    if survey.guesses:
        lines += ["", "[guessed]"]
        lines += [f"{string_text(key)} = {string_text(why)}" for key, why in survey.guesses.items()]
    return "\n".join(lines) + "\n"


def records_text(records: Sequence[Mapping[str, Any]]) -> list[str]:
    """Lines of the tables [[records]]."""
    lines = []
    for record in records:
        lines.append("[[records]]")
        lines += [f"{k} = {_toml_text(v)}" for k, v in record.items()]
    return lines


def _first_of(parameter: str, value: float, unit: str) -> str:
    if not value > 0:
        return "{}"
    return f'{{ {parameter} = {{ value = {_round(value)!r}, unit = "{unit}" }} }}'


def _round(value: float) -> float:
    return float(f"{value:.3g}")


def toml_table(entries: Mapping[str, Any]) -> str:
    """A table on one line."""
    return inline_text({name: _toml_text(value) for name, value in entries.items()})


def _toml_text(value: Any) -> str:
    if isinstance(value, Mapping):
        return toml_table(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return string_text(value)
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_toml_text, value)) + "]"
    return repr(value)
