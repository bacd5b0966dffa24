"""Make an experiment of further logs of a logger that an experiment reads already."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path

from ..base.files import read_whole, write_text
from ..base.toml import read_toml, string_text, texts_in
from .new_folder import FitAndCheck, copy_logs, records_of, require_same_statements
from .saving import records_text

_FILE = "experiment.toml"


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
    text = _without_records(read_whole(source / _FILE).decode("utf-8"))
    text = re.sub(r"(?m)^title\s*=.*$", lambda _: f"title = {string_text(title)}", text, count=1)
    copy_logs(logs, folder)
    others = {key: value for key, value in content.items() if key != "records"}
    for name in dict.fromkeys(texts_in(others)):
        if _is_file_in(source, name):
            copy_logs([source / name], (folder / name).parent)
    write_text(folder / _FILE, "\n".join([text.rstrip(), "", *records_text(records), ""]))


def _is_file_in(folder: Path, name: str) -> bool:
    """Whether a text is the name of a file within a folder; a sentence may be too long for one."""
    whole = os.path.realpath(folder / name)
    return os.path.isfile(whole) and Path(whole).is_relative_to(os.path.realpath(folder))


def _without_records(text: str) -> str:
    """The text of an experiment.toml without its tables [[records]]."""
    kept, inside = [], False
    for line in text.splitlines():
        if line.lstrip().startswith("["):
            inside = re.match(r"\s*\[\[\s*records\s*\]\]", line) is not None
        if not inside:
            kept.append(line)
    return "\n".join(kept)
