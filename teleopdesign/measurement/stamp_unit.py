"""The unit of time stamps for which neither the log nor its column names state one."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..base.units import si_factor

Array = NDArray[np.float64]

#: s in a day
DAY = 86_400.0
#: days between two rows: 0.2 s, as in seconds
LONGEST_DAYS = 0.2 / DAY
_SHORTEST = 1.0  # s: shortest duration of a record
#: rows a second that no log of a machine has; a scope may have 1 MHz
FASTEST = 1.001e6


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


def unit_in_place_of(stated: str, stamps: Array) -> tuple[str, str] | None:
    """The unit of a time column whose name states another, and the reason; None: it may be right.

    The name is wrong where its unit makes the log too short for a record and its rows faster than
    those of any logger: seconds in a column "time_us".
    """
    steps = np.abs(np.diff(stamps[np.isfinite(stamps)]))
    usual = float(np.median(steps)) if len(steps) else 0.0
    factor = si_factor(stated, quantity="time")
    if usual == 0.0 or usual * factor * FASTEST > 1.0 or np.sum(steps) * factor > _SHORTEST:
        return None
    unit, _ = unit_of_steps(stamps)
    rate = f"{1.0 / (usual * factor):.3g} rows a second"
    return unit, f"{unit}: in {stated}, as its name says, the log would have {rate}"
