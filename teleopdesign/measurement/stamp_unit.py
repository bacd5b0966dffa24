"""The unit of time stamps for which neither the log nor its column names state one."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: s in a day
DAY = 86_400.0
#: days between two rows: 0.2 s, as in seconds
LONGEST_DAYS = 0.2 / DAY
_SHORTEST = 1.0  # s: shortest duration of a record


def unit_of_steps(stamps: Array) -> tuple[str, str]:
    """Unit of a time column from its usual step, and the reason if the unit is a guess."""
    finite = stamps[np.isfinite(stamps)]
    step = float(np.median(np.abs(np.diff(finite))))
    if step == 0.0:  # most rows share a stamp
        step = float(np.ptp(finite)) / max(len(finite) - 1, 1)
    # a spreadsheet counts days; read in seconds, such a log would be too short for a record
    if step < LONGEST_DAYS and _SHORTEST / DAY < float(np.ptp(finite)) < _SHORTEST:
        return "day", f"day: only in days are steps of {step:.4g} usual for a log"
    scales = ((0.2, "s"), (200.0, "ms"), (2e5, "us"), (math.inf, "ns"))
    unit = next(name for largest, name in scales if step < largest or largest == math.inf)
    if unit == "s" and step > 1e-5:
        return "s", ""
    return unit, f"{unit}: only in {unit} are steps of {step:.4g} usual for a log"
