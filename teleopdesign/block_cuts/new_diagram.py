"""Make the folder of an experiment of a diagram from logs, with the reason of each choice."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ..base.errors import ExperimentError
from ..base.files import write_text
from ..base.toml import comment_text, string_text, toml_text
from ..measurement.new_folder import FitAndCheck, check_spans, copy_logs, records_of
from ..measurement.saving import records_text
from ..measurement.survey import spans_of
from .channel_proposal import ChannelProposal

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
