"""Channels of a diagram among the columns of a log, and the folder of an experiment of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..base.arguments import check_types
from ..base.errors import ExperimentError, quote, unknown
from ..base.files import write_text
from ..base.sentences import percent
from ..base.toml import comment_text, string_text, toml_text
from ..diagrams import Diagram
from ..measurement.doors._log import Log, join_names
from ..measurement.from_arrays import log_of
from ..measurement.new_folder import FitAndCheck, check_spans, copy_logs, records_of
from ..measurement.saving import records_text
from ..measurement.survey import spans_of
from ..measurement.survey.clock import duration_of, time_column
from ..measurement.survey.content import NONE, Choices, numeric_columns
from ..measurement.survey.roles import unit_in_log
from .channel_search import ChannelSearch, ColumnChoice

#: odds above which a choice needs no question
CLEAR = 20.0


@dataclass(frozen=True)
class ChannelProposal:
    """Proposed channels of an experiment of a diagram.

    duration: of the log, s
    channels: "time" or "sample_rate", then signal -> its table in [channels]
    zero: outside signals that are taken to be zero
    known: signal -> why its column is no guess;  guesses: "channels.R_A.column" -> why
    open: signals of which another choice is about as likely;  unused: column -> why
    errors: cut -> error of the stated diagram
    """

    diagram: Diagram
    duration: float
    channels: Mapping[str, Mapping[str, Any]]
    zero: tuple[str, ...]
    known: Mapping[str, str]
    guesses: Mapping[str, str]
    open: tuple[str, ...]
    unused: Mapping[str, str]
    errors: Mapping[str, float]

    def __repr__(self) -> str:
        lines = [f"the signals of the diagram {self.diagram.name}"]
        for key, table in self.channels.items():
            column = quote(table["column"]) if "column" in table else f"{table['value']:g}"
            basis = f"known {self.known[key]}" if key in self.known else "guess"
            basis = "open: another choice is about as likely" if key in self.open else basis
            sign = ", sign -1" if table.get("sign") == -1 else ""
            more = f"  ({basis})  {self.diagram.texts.get(key, '')}".rstrip()
            text = f"  {key:<12} {column} in {table['unit']}{sign}"
            lines.append(text + (more if key in self.diagram.signals else ""))
        lines += [f"  {name:<12} 0" for name in self.zero]
        lines += [f"  not used: {column}: {why}" for column, why in self.unused.items()]
        lines += ["guessed:"] if self.guesses else []
        return "\n".join([*lines, *(f"  {key}: {why}" for key, why in self.guesses.items())])


@check_types
def propose_channels(
    diagram: Diagram,
    log: Any,
    *,
    file: str = "log",
    choices: Choices | None = None,
    stated: Mapping[str, str] | None = None,
) -> ChannelProposal:
    """Propose the channels of an experiment of a diagram.

    log: an open log, a DataFrame or a dict of arrays
    choices: time, units and sample rate that the user states;  stated: signal -> column or "none"
    raises ExperimentError: no such signal or column; no column fits any signal
    """
    choices, stated = choices or Choices(), stated or {}
    raw, idle, log = numeric_columns(log if isinstance(log, Log) else log_of(log), file)
    _require(stated, diagram.signals, "signal", file)
    _require([choices.time or NONE, *choices.units, *stated.values()], tuple(raw), "column", file)
    guesses: dict[str, str] = {}
    time, unit = time_column(raw, log, choices, guesses)
    clock: dict[str, Any] = {"time": {"column": time, "unit": unit}}
    if time is None:
        if choices.sample_rate is None:
            raise ExperimentError(f"{file}: {guesses['sample_rate']}: --sample-rate HZ states it")
        clock = {"sample_rate": {"value": choices.sample_rate, "unit": "Hz"}}
    rows = max(map(len, raw.values())) if time is None else len(raw[time])
    idle |= {n: "has other rows than the time" for n, x in raw.items() if len(x) != rows}
    idle |= {n: "is constant" for n, x in raw.items() if np.nanmax(x) == np.nanmin(x)}
    units = {n: unit_in_log(n, log, choices) for n in raw if n != time and n not in idle}
    data = {n: x for n, x in raw.items() if n == time or n in units}
    search = ChannelSearch(diagram, data, units, clock, stated)
    best = search.best()
    _require_fit(search, best, file)
    used = {one.column for one in best.values()}
    left = {n: f" in {unit}" if unit else "" for n, unit in units.items() if n not in used}
    idle |= {n: f"fits no signal of the diagram{unit}" for n, unit in left.items()}
    known, open_ = _explain(search, best, guesses)
    return ChannelProposal(
        diagram,
        duration_of(raw, time, unit, choices),
        clock | {s: best[s].table for s in search.signals if s in best},
        search.zero(best),
        known,
        guesses,
        open_,
        idle,
        search.errors(best),
    )


def _require(names: Iterable[str], present: Sequence[str], kind: str, file: str) -> None:
    """Refuse names of signals or columns that are not there."""
    for name in names:
        if name not in (*present, NONE):
            raise ExperimentError(f"{file}: {unknown(kind, name, present)}")


def _require_fit(search: ChannelSearch, best: Mapping[str, ColumnChoice], file: str) -> None:
    """Refuse a log that tests no block, and a stated column of another quantity."""
    for signal, name in search.stated.items():
        if name != NONE and signal not in best:
            raise ExperimentError(
                f"{file}: column {quote(name)} as {signal}: found the unit "
                f"{search.units.get(name)}, expected one of a {search.quantity(signal)}"
            )
    if not search.errors(best):
        raise ExperimentError(
            f"{file}: no columns fit the signals of {search.diagram.name} so that a block is "
            f"tested, found {join_names(tuple(search.data))}: --signal NAME=COLUMN states one"
        )


def _explain(
    search: ChannelSearch,
    best: Mapping[str, ColumnChoice],
    guesses: dict[str, str],
) -> tuple[dict[str, str], tuple[str, ...]]:
    """What each choice rests on, in `guesses` if it is one; the known and the open signals."""
    known, open_ = {}, []
    others = list(search.changes(best))
    for signal, one in best.items():
        if signal in search.stated or search.tells(signal, one.column):
            known[signal] = "as stated" if signal in search.stated else "by its name"
        else:
            without = {s: o for s, o in best.items() if s != signal}
            apart = [without, *(o for o in others if o[signal].column != one.column)]
            second = max(apart, key=search.score)
            guesses[f"channels.{signal}.column"] = _compare(search, best, second, signal)
            if search.score(best) - search.score(second) < np.log(CLEAR):
                open_.append(signal)
        if search.units[one.column] is None:
            guesses[f"channels.{signal}.unit"] = f"the name {one.column!r} states no unit"
        if one.sign < 0:
            guesses[f"channels.{signal}.sign"] = "the other sign fits better"
    for name in search.zero(best):
        guesses[f"diagram.outside.{name}"] = "no column holds it: taken as zero in the recording"
    return known, tuple(open_)


def _compare(
    search: ChannelSearch,
    best: Mapping[str, ColumnChoice],
    second: Mapping[str, ColumnChoice],
    signal: str,
) -> str:
    """The errors of the cuts with a choice and with the next best one."""
    here, there = search.errors(best), search.errors(second)
    other = f"{second[signal].column!r}" if signal in second else "no column"
    errors = [
        f"{name} is off by {percent(error, '.2g')}, with {other} "
        + (f"by {percent(there[name], '.2g')}" if name in there else "untested")
        for name, error in here.items()
        if error != there.get(name)
    ]
    return "; ".join(errors) or f"by what its name suggests; {other} fits as well"


_FILE = "experiment.toml"


def make_diagram_folder(
    proposal: ChannelProposal,
    logs: Sequence[Path],
    diagram: Path,
    folder: Path,
    *,
    title: str,
    spans: FitAndCheck | None = None,
) -> Path:
    """Copy logs and diagram into a folder and write experiment.toml beside them.

    One log is cut into a fit and a check record; of several logs, the last is the check record.
    diagram: its file;  spans: (begin, end) of the fit and the check record, s from the first row
    raises ExperimentError: the folder cannot be written; spans outside of the log
    """
    if diagram.name == _FILE:
        raise ExperimentError(f"{diagram}: a diagram beside {_FILE} needs another name")
    names = [log.name for log in logs]
    alone = len(names) == 1
    records = records_of(names, spans or (spans_of(proposal.duration) if alone else None))
    if spans is not None:
        check_spans(spans, proposal.duration, names[0])
    copy_logs([*logs, diagram], folder)
    lines = ["# Written by `teleopdesign new`. Comments say what was guessed, and why.", ""]
    lines += [f"title = {string_text(title)}", "", "[diagram]"]
    lines += [f"file = {string_text(diagram.name)}", "[diagram.outside]"]
    for name in proposal.zero:
        lines += _comments(proposal, f"diagram.outside.{name}")
        lines.append(f"{string_text(name)} = 0")
    lines += ["", "[channels]"]
    for name, table in proposal.channels.items():
        lines += _comments(proposal, f"channels.{name}.")
        lines.append(f"{string_text(name)} = {toml_text(table)}")
    lines += [comment_text(f"not used: {n}: {why}") for n, why in proposal.unused.items()]
    write_text(folder / _FILE, "\n".join([*lines, "", *records_text(records)]) + "\n")
    return folder


def _comments(proposal: ChannelProposal, key: str) -> list[str]:
    """A comment on each guess of which the key begins so."""
    chosen = [why for name, why in proposal.guesses.items() if name.startswith(key)]
    return [comment_text(f"guessed: {why}") for why in chosen]
