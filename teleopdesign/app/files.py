"""Files that the page may open: experiments and logs inside its folder, nothing outside."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from ..base.errors import ExperimentError
from ..base.files import write_beside
from ..measurement.tables import DOORS, is_log

#: folder for what is dropped
DROPPED = "dropped"
#: bytes of a dropped file at most: a browser holds it in memory once, this process twice
LARGEST = 200_000_000
#: characters of a file's name that are kept: most file systems allow 255 bytes, and a character
#: has up to 3
LONGEST = 60


def experiments_in(folder: Path) -> tuple[str, ...]:
    """Names of the experiments in a folder and two levels below, relative to it; "." is itself."""
    places = [folder, *sorted(folder.glob("*")), *sorted(folder.glob("*/*"))]
    return tuple(
        str(p.relative_to(folder))
        for p in places
        if p.is_dir() and (p / "experiment.toml").is_file() and is_inside(folder, p)
    )


def logs_in(folder: Path) -> tuple[str, ...]:
    """Names of the logs in a folder and in its folder of dropped files, relative to it."""
    files = [*sorted(folder.glob("*")), *sorted((folder / DROPPED).glob("*"))]
    return tuple(
        str(p.relative_to(folder))
        for p in files
        if p.is_file() and is_log(p) and _is_offered(p) and is_inside(folder, p)
    )


def _is_offered(path: Path) -> bool:
    """Whether the place of a file suits a log: JSON files beside experiments are answers."""
    return path.suffix.lower() != ".json" or path.parent.name == DROPPED


def newest(folder: Path, names: Sequence[str]) -> str | None:
    """The experiment or log in a folder that was written last; None: there are none."""

    def written(name: str) -> float:
        path = folder / name
        toml = path / "experiment.toml"
        return (toml if toml.is_file() else path).stat().st_mtime

    return max(names, key=written, default=None)


def endings() -> str:
    """The endings of files that can be read, as text for a label or a message."""
    return ", ".join(dict.fromkeys(DOORS))


def is_inside(folder: Path, path: Path) -> bool:
    """Whether a path lies in the folder, after links are followed."""
    return path.resolve().is_relative_to(folder.resolve())


def resolve_inside(folder: Path, name: str) -> Path:
    """The path of a name in the folder; raises ExperimentError: it leads out of the folder."""
    path = folder / name
    if not is_inside(folder, path):
        raise ExperimentError(f'"{name}": lies outside of {folder.name}')
    return path


def keep_dropped(folder: Path, name: str, content: bytes) -> str:
    """Write a dropped file, never over another one; returns its name relative to the folder.

    raises ExperimentError: the ending of no log, or too large
    """
    base = re.sub(r"[^\w.\- ]", "_", name.replace("\\", "/").rpartition("/")[2])
    stem, _, ending = base.rpartition(".")
    plain = f"{stem.strip(' .')[:LONGEST] or 'log'}.{ending}"
    if not is_log(Path(plain)):
        raise ExperimentError(f'"{plain}": found {Path(plain).suffix!r}, expected {endings()}')
    if len(content) > LARGEST:
        raise ExperimentError(f'"{plain}": {len(content)} bytes, expected at most {LARGEST}')
    ending = max((e for e in DOORS if plain.lower().endswith(e)), key=len)
    ending = plain[-len(ending) :]  # as it is written: "LOG.CSV"
    target = resolve_inside(folder, DROPPED)
    target.mkdir(exist_ok=True)
    path, number = target / plain, 1
    while path.exists():
        number += 1
        path = target / f"{plain.removesuffix(ending)}-{number}{ending}"
    with write_beside(path) as part:
        part.write_bytes(content)
    return str(path.relative_to(folder))
