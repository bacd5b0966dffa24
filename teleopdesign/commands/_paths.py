"""Which paths a command reads, and which it writes.

The names of the options decide, so that no command has to declare them.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator
from pathlib import Path

from ..base.errors import ExperimentError
from ..base.files import read_whole

#: options that name what a command reads, and what it writes: a file or a folder
INPUTS = (
    *("folder", "logs", "source", "file", "diagram", "answer", "check", "effect", "law", "design"),
    *("without", "like"),
)
OUTPUTS = ("json", "predictions", "figure", "report", "output", "out", "effect_file")


def inputs(options: argparse.Namespace | None) -> Iterator[Path]:
    """The paths that a command reads, as the user wrote them."""
    return _paths(options, INPUTS)


def outputs(options: argparse.Namespace | None) -> Iterator[Path]:
    """The paths that a command writes."""
    return _paths(options, OUTPUTS)


def python_files(options: argparse.Namespace | None) -> Iterator[Path]:
    """The user's Python files that a command runs: effects and studies."""
    return (path for path in inputs(options) if path.suffix == ".py")


def _paths(options: argparse.Namespace | None, names: tuple[str, ...]) -> Iterator[Path]:
    for name in names:
        value = getattr(options, name, None)
        for one in value if isinstance(value, list) else [value]:
            if isinstance(one, str | Path) and str(one):
                yield Path(one)


def check_paths(options: argparse.Namespace) -> None:
    """Raise ExperimentError if an output is also an input, or if two outputs are the same file.

    Records that an experiment names count as inputs; so do files that another TOML file names.
    """
    read = {os.path.realpath(p): p for p in _files_read(options)}
    written: dict[str, Path] = {}
    for path in outputs(options):
        if path.is_dir():
            continue
        real = os.path.realpath(path)
        if real in read:
            raise ExperimentError(f"{path}: is read by this command, expected another file")
        if real in written:
            raise ExperimentError(f"{path}: is to hold two results, expected a file for each")
        written[real] = path


def _files_read(options: argparse.Namespace) -> Iterator[Path]:
    for path in inputs(options):
        file = path / "experiment.toml" if path.is_dir() else path
        yield file
        if file.suffix == ".toml":
            yield from (file.parent / text for text in _texts_of(file))


def _texts_of(file: Path) -> Iterator[str]:
    """Every text in a TOML file; none for an invalid file, which is reported when it is read."""
    from ..base.toml import parse_toml, texts_in

    try:
        content = parse_toml(read_whole(file).decode("utf-8-sig"))
        yield from texts_in(content)
    except (OSError, ValueError, RecursionError):
        return
