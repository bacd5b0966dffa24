"""Measured and modelled forces of a diagnosis as a table, one row per sample of every record."""

from __future__ import annotations

import csv
import gzip
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from io import TextIOWrapper
from pathlib import Path
from typing import TextIO

import numpy as np

from ..base.files import harmless_cell, write_beside
from ..measurement.filtering import Array
from ..measurement.record import Record
from ..realise.along_motion import residual_along
from .diagnosis import Diagnosis
from .record_offsets import apply_record_offsets


def write_predictions(diagnosis: Diagnosis, path: str | Path) -> None:
    """Write measured and modelled forces: one row per sample of every record; .csv or .csv.gz.

    `BODY.measured` is the actuator force plus the interaction force as recorded. Residuals are
    low-passed only by the smoothing of the motion, so their low-passed values can be recomputed.
    """
    path = Path(path)
    head = ["record", "t"]
    for body in diagnosis.experiment.bodies:
        head += [f"{body}.{q}" for q in ("measured", "model_before", "model_after")]
        head += [f"{body}.residual_before", f"{body}.residual_after"]
    with write_beside(path) as part, _open_for_writing(part, path) as file:
        out = csv.writer(file)
        out.writerow(head)
        for record in diagnosis.experiment.records:
            columns = _predicted_forces(diagnosis, record)
            for k, time in enumerate(record.time):
                numbers = (f"{c[k]:.7g}" for c in columns)
                out.writerow([harmless_cell(record.file), f"{time:.9g}", *numbers])


@contextmanager
def _open_for_writing(part: Path, path: Path) -> Iterator[TextIO]:
    """A text file to write to, compressed where the path ends in .gz.

    part: the file that is written;  path: its final name, also written into the compressed file
    """
    with part.open("wb") as raw:
        if path.suffix != ".gz":
            with TextIOWrapper(raw, encoding="utf-8", newline="") as file:
                yield file
            return
        with gzip.GzipFile(path.name, "wb", fileobj=raw) as packed:
            with TextIOWrapper(packed, encoding="utf-8", newline="") as file:
                yield file


def _predicted_forces(diagnosis: Diagnosis, record: Record) -> list[Array]:
    columns: list[Array] = []
    before, after = (_residuals(diagnosis, k, record) for k in (0, -1))
    for body in diagnosis.experiment.bodies:
        interaction = record.signals.get(f"{body}.interaction_force")
        measured = record.signals[f"{body}.actuator_force"] + (
            0.0 if interaction is None else interaction
        )
        columns += [measured, measured - before[body], measured - after[body]]
        columns += [before[body], after[body]]
    return columns


def _residuals(diagnosis: Diagnosis, row: int, record: Record) -> Mapping[str, Array]:
    """Body -> residual of a row's model on all rows of a record; zero where it is not compared."""
    left = {body: np.zeros(len(record.time)) for body in diagnosis.experiment.bodies}
    for prepared, model in diagnosis.parts(row):
        stretches = [s for s in prepared.stretches if s.motion.file == record.file]
        for body, motion in apply_record_offsets(model, stretches):
            left[motion.body][motion.rows] = residual_along(body, motion).residual.value
    return left
