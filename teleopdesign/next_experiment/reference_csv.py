"""The proposed motion as a CSV file for a servo."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from ..base.files import harmless_cell, write_beside
from ..base.units import si_factor
from ..measurement.experiment import Experiment
from .proposal import Reference


def write_reference(reference: Reference, experiment: Experiment, path: str | Path) -> None:
    """Write time and position reference of each body, with header and units of the experiment.

    Without a time channel the first column is t, in s.
    """
    clock = experiment.channels.get("time")
    head, columns, forms = ["t"], [reference.time], ["%.9g"]
    if clock is not None:
        head = [clock.column]
        columns = [reference.time / si_factor(clock.unit, quantity="time")]
    for body, position in reference.position.items():
        channel = experiment.channels[f"{body}.position"]
        factor = si_factor(channel.unit, quantity="position", axis=experiment.axis(body))
        head.append(channel.column)
        columns.append(position / factor)
        forms.append("%.9g")
    with write_beside(path) as part, part.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerow(map(harmless_cell, head))
        np.savetxt(file, np.column_stack(columns), fmt=forms, delimiter=",")
