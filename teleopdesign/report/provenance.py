"""Where a report's numbers come from: the record files and the channels."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

from ..measurement.experiment import Experiment
from ..quantity import unit_of


@dataclass(frozen=True)
class RecordRow:
    """A record file and what is in it; duration in s, rate in Hz, digest: SHA-256 of the file."""

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
    """A channel as described; resolution and noise in SI (`si_unit`), None where not stated."""

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
            duration=r.duration,
            rate=1.0 / r.sample_time,
            segments=len(r.segments),
            offset_names=tuple(sorted(n.replace("_", " ") for n in r.offset_names)),
            digest=_digest(experiment, r.file),
        )
        for r in experiment.records
    )


def _digest(experiment: Experiment, file: str) -> str:
    """SHA-256 of a record file; empty where it is no longer there."""
    try:
        return hashlib.sha256((experiment.folder / file).read_bytes()).hexdigest()
    except OSError:
        return ""


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
