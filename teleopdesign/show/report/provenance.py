"""Where a page's numbers come from: record files and channels."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass

from ...base.units import unit_of
from ...measurement.experiment import Experiment
from ...measurement.reading import log_name

#: bytes that are read at once: a log may be larger than the memory
_BLOCK = 1 << 20


@dataclass(frozen=True)
class RecordRow:
    """A record and its content; duration: s, rate: Hz, NaN on friction curves; digest: SHA-256."""

    file: str
    use: str
    samples: int
    duration: float
    rate: float
    segments: int
    offset_names: tuple[str, ...]
    digest: str


@dataclass(frozen=True)
class ChannelRow:
    """A channel as described; resolution and noise in SI (`si_unit`), None if not stated."""

    name: str
    column: str
    unit: str
    resolution: float | None
    noise: float | None
    si_unit: str


def record_rows(experiment: Experiment) -> tuple[RecordRow, ...]:
    """Every record of the experiment."""
    return tuple(
        RecordRow(
            file=r.file,
            use=r.use,
            samples=len(r.time),
            duration=math.nan if r.is_curve else r.duration,
            rate=math.nan if r.is_curve else 1.0 / r.sample_time,
            segments=len(r.segments),
            offset_names=tuple(sorted(n.replace("_", " ") for n in r.offset_names)),
            digest=_digest(experiment, r.file),
        )
        for r in experiment.records
    )


def _digest(experiment: Experiment, file: str) -> str:
    """SHA-256 of a record's log; "" if the log no longer exists.

    For a folder (a bag): of its files one after the other, sorted by name.
    """
    path = experiment.folder / file
    if not path.exists():  # a part of a log
        path = experiment.folder / log_name(file)
    files = sorted(p for p in path.rglob("*") if p.is_file()) if path.is_dir() else [path]
    whole = hashlib.sha256()
    try:
        for one in files:
            with one.open("rb") as stream:
                while block := stream.read(_BLOCK):
                    whole.update(block)
    except OSError:
        return ""
    return whole.hexdigest()


def channel_rows(experiment: Experiment) -> tuple[ChannelRow, ...]:
    """Every channel of the experiment."""
    kinds = {"actuator_force": "force", "interaction_force": "force"}
    return tuple(
        ChannelRow(
            name=name,
            column=c.column,
            unit=c.unit,
            resolution=c.resolution,
            noise=c.noise,
            si_unit=(
                ""
                if c.body is None
                else unit_of(kinds.get(c.quantity, c.quantity), experiment.axis(c.body))
            ),
        )
        for name, c in experiment.channels.items()
    )
