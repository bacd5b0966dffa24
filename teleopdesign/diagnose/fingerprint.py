"""Fingerprint of an experiment: title, records and a digest, to match answers and records."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from ..base.codec import Filled
from ..base.errors import quote
from ..measurement.experiment import Experiment


@dataclass(frozen=True)
class RecordPrint:
    """A record: its file, its use and its number of samples."""

    file: str
    use: str
    samples: int

    def __str__(self) -> str:
        return f"{self.file} ({self.use}, {self.samples} samples)"


@dataclass(frozen=True)
class Fingerprint:
    """Title, axis of each body, records, and the digest of their readings."""

    title: str
    axes: Mapping[str, str]
    records: Annotated[tuple[RecordPrint, ...], Filled(1)]
    digest: str

    def difference(self, experiment: Experiment) -> str | None:
        """How the expected experiment differs from this one, in words; None: they are equal."""
        present = fingerprint_of(experiment)
        if self.title != present.title:
            return f"title {quote(self.title)}, found {quote(present.title)}"
        if self.axes != present.axes:
            return f"bodies {bodies_text(self.axes)}, found {bodies_text(present.axes)}"
        if self.records != present.records:
            return f"records {_list(self.records)}, found {_list(present.records)}"
        if self.digest != present.digest:
            return "records of the same names, but they read differently now"
        return None


def fingerprint_of(experiment: Experiment) -> Fingerprint:
    """The fingerprint of an experiment, from its records as they were read."""
    return Fingerprint(
        title=experiment.title,
        axes={name: body.axis for name, body in experiment.bodies.items()},
        records=tuple(RecordPrint(r.file, r.use, len(r.time)) for r in experiment.records),
        digest=digest(experiment),
    )


def digest(experiment: Experiment) -> str:
    """SHA-256 of every record as it was read: use, clock and signals in SI, by their names.

    The packing of a file does not change it; another unit, sign or column does.
    """
    whole = hashlib.sha256()
    for r in experiment.records:
        cuts = [(s.start, s.stop) for s in r.segments]
        whole.update(repr((r.file, r.use, sorted(r.offset_names), r.sample_time, cuts)).encode())
        for name in sorted(r.signals):
            whole.update(f"{name} {len(r.signals[name])} ".encode())
            whole.update(np.ascontiguousarray(r.signals[name], dtype="<f8").tobytes())
    return whole.hexdigest()


def bodies_text(axes: Mapping[str, str]) -> str:
    """Names of bodies with their axes, as text: "device (prismatic)"."""
    return ", ".join(f"{place} ({axis})" for place, axis in axes.items())


def _list(records: tuple[RecordPrint, ...]) -> str:
    return ", ".join(map(str, records[:4])) + (", ..." if records[4:] else "")
