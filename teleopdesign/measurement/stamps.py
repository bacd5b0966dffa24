"""Time stamps as they are written: their unit, and the wraps of their clock.

A microcontroller that counts microseconds in 32 bits starts again after 71 minutes; a time of day
starts again at midnight; a clock without a zone goes back an hour in autumn.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from ..base.units import measures
from .column_names import bare_name, unit_in_name, unit_of_text
from .encoder import Array
from .limits import HALF, SHORTEST

#: most successive lost rows that are filled, and most rows by which one is out of order: more are a
#: pause, or a clock that was set back. At 1 kHz six sample times are a tenth of a period at 16 Hz,
#: so the motion between them is still known in the band of a comparison
GOES_ON = 5

#: s in a day
DAY = 86_400.0
#: units of stamps, as parts of a second
_SECONDS = (1.0, 1e3, 1e6, 1e9)
#: s after which a clock begins anew -> what it does
CLOCKS = {
    3600.0: "the clock goes back an hour",
    43_200.0: "the time of day begins anew after twelve hours",
    DAY: "the time of day begins anew at midnight",
    604_800.0: "the week begins anew",
}
#: step of a counter of 16, 24 or 32 bits at its wrap -> as in `CLOCKS`
COUNTERS = {2.0**n: f"a counter of {n} bits wraps" for n in (16, 24, 32)}
#: longest step over a wrap, in usual steps: a few rows may be lost there
LONGEST_STEP = 20.0
#: days between two rows: 0.2 s, as in seconds
LONGEST_DAYS = 0.2 / DAY


def unwrap_stamps(stamps: Array) -> tuple[Array, tuple[str, ...]]:
    """Stamps without the wraps of their counter or clock, and a note on each kind of wrap.

    A step back is a wrap if adding its period leaves a step like the others.

    stamps: (n,) in any unit, NaN where there is none
    """
    rows = np.flatnonzero(np.isfinite(stamps))
    whole, notes = stamps[rows], []
    steps = np.diff(whole)
    if not np.any(steps > 0) or not np.any(steps < 0):
        return stamps, ()
    longest = LONGEST_STEP * float(np.median(steps[steps > 0]))
    periods = {unit * length: why for length, why in CLOCKS.items() for unit in _SECONDS}
    for period, why in {**periods, **COUNTERS}.items():
        steps = np.diff(whole)
        wraps = (steps < 0) & (steps + period > 0) & (steps + period <= longest)
        if count := int(np.count_nonzero(wraps)):
            whole[1:] += period * np.cumsum(wraps)
            notes.append(f"{why}{f' {count} times' if count > 1 else ''}: time counts on")
    if not notes:
        return stamps, ()
    unwrapped = stamps.copy()
    unwrapped[rows] = whole
    return unwrapped, tuple(notes)


def seconds_since_first(stamps: Array) -> Array:
    """Time from the first row of the log, s; after a clock was set back, the time continues.

    stamps: (n,) s, NaN where there is none; rows a little out of order keep their stamps
    """
    rows = np.flatnonzero(np.isfinite(stamps))
    since = stamps - (stamps[rows[0]] if len(rows) else 0.0)
    steps = np.diff(since[rows])
    if not np.any(steps > 0):
        return np.asarray(since)
    usual = usual_step(steps)
    set_back = are_set_back(steps, usual)
    since[rows[1:]] += np.cumsum(np.where(set_back, usual - steps, 0.0))
    return np.asarray(since)


def unit_of_time(name: str, stated: str | None) -> str | None:
    """The unit of a column if it is a time: as stated, in its name, or all of it: "Sekunden"."""
    unit = stated or unit_in_name(name, "time") or unit_of_text(bare_name(name))
    return unit if unit and unit != "counts" and measures(unit, "time") else None


def share_time(spans: Iterable[tuple[float, float]]) -> bool:
    """Whether clocks (begin, end) share half of the shortest; others count from other instants."""
    begins, ends = zip(*spans, strict=True)
    shortest = min(end - begin for begin, end in zip(begins, ends, strict=True))
    return bool(min(ends) - max(begins) >= HALF * shortest)


def unit_of_steps(stamps: Array) -> tuple[str, str]:
    """Unit of a time column from its usual step, and the reason if the unit is a guess."""
    finite = stamps[np.isfinite(stamps)]
    step = float(np.median(np.abs(np.diff(finite))))
    if step == 0.0:  # most rows share a stamp
        step = float(np.ptp(finite)) / max(len(finite) - 1, 1)
    # a spreadsheet counts days; read in seconds, such a log would be too short for a record
    if step < LONGEST_DAYS and SHORTEST / DAY < float(np.ptp(finite)) < SHORTEST:
        return "day", f"day: only in days are steps of {step:.4g} usual for a log"
    scales = ((0.2, "s"), (200.0, "ms"), (2e5, "us"), (math.inf, "ns"))
    unit = next(name for largest, name in scales if step < largest)
    if unit == "s":
        return "s", ""
    return unit, f"{unit}: only in {unit} are steps of {step:.4g} usual for a log"


def usual_step(steps: Array) -> float:
    """The usual one of the steps between stamps, s: the mean of those near the median.

    steps: those of 0 and back do not count; 0 where none is left
    """
    forward = steps[steps > 0]
    if not len(forward):
        return 0.0
    usual = float(np.median(forward))
    near = forward[np.abs(forward - usual) < HALF * usual]
    return float(near.mean()) if len(near) else usual


def step_deviations(stamps: Array) -> Array:
    """Distance of each step between stamps (n,) from the usual one, in usual steps, (n - 1,)."""
    steps = np.diff(stamps)
    usual = usual_step(steps)
    return np.abs(steps / usual - 1.0) if usual > 0 else np.full(len(steps), math.inf)


def are_set_back(steps: Array, usual: float) -> NDArray[np.bool_]:
    """Steps between stamps (n,) at which a clock was set back: further than a row out of order."""
    return np.asarray(steps < -(GOES_ON + 0.5) * usual)


def are_out_of_order(stamps: Array) -> bool:
    """Whether stamps are those of one clock, each once, with rows a little out of order."""
    steps, ordered = np.diff(stamps), np.diff(np.sort(stamps))
    if not np.any(steps < 0) or not np.all(ordered > 0):
        return False
    return not are_set_back(steps, usual_step(ordered)).any()
