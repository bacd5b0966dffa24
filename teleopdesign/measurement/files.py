"""The files of an experiment, and a digest of their content."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from pathlib import Path

from ..base.errors import ExperimentError
from ..base.toml import read_toml

#: bytes that are read at once
_BLOCK = 1 << 20


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
    files: dict[str, Path | None] = {"experiment.toml": _resolve_within(folder, "experiment.toml")}
    try:
        table = read_toml(folder / "experiment.toml", f"{folder.name}/experiment.toml")
        records = [t.text("file") for t in table.tables("records")]
    except ExperimentError:
        return files
    for name in records:
        if "\0" not in name and (folder / name).is_dir():
            for path in sorted((folder / name).rglob("*")):
                inside = path.relative_to(folder).as_posix()
                files[inside] = _resolve_within(folder, inside)
        else:
            files[name] = _resolve_within(folder, name)
    return files


def _resolve_within(folder: Path, name: str) -> Path | None:
    """The path of a regular file in the folder; None if there is none."""
    path = folder / name
    if not path.is_file() or not path.resolve().is_relative_to(folder.resolve()):
        return None
    return path


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
