"""Time stamps across the wrap of a counter, across midnight, and after a clock was set back.

A microcontroller that counts microseconds in 32 bits starts again after 71 minutes; a time of day
starts again at midnight; a clock without a zone goes back an hour in autumn.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: step of a counter of 16, 24 or 32 bits at its wrap -> the reason in words
COUNTERS = {2.0**bits: f"a counter of {bits} bits wraps" for bits in (16, 24, 32)}
#: s by which a clock steps back -> the reason in words: an hour in autumn, a twelve-hour dial, a
#: day, a week of GPS
CLOCKS = {
    3600.0: "the clock goes back an hour",
    43_200.0: "the time of day begins anew after twelve hours",
    86_400.0: "the time of day begins anew at midnight",
    604_800.0: "the week begins anew",
}
#: units of stamps, as parts of a second
_SECONDS = (1.0, 1e3, 1e6, 1e9)
#: longest step over a wrap, in usual steps: a few rows may be lost there
LONGEST_STEP = 20.0
#: fewest usual steps in the period of a wrap: with fewer, the column counts the rows of blocks
FEWEST_STEPS = 500.0


def unwrap_stamps(stamps: Array) -> tuple[Array, tuple[str, ...]]:
    """Stamps without the wraps of their counter or clock, and a note on each kind of wrap.

    A step back is a wrap if adding its period leaves a step like the others.

    stamps: (n,) in any unit, NaN where there is none
    """
    rows = np.flatnonzero(np.isfinite(stamps))
    steps = np.diff(stamps[rows])
    forward = steps[steps > 0]
    back = np.flatnonzero(steps < 0)
    if not len(forward) or not len(back):
        return stamps, ()
    usual = float(np.median(forward))
    periods = dict(COUNTERS)
    periods |= {unit * length: why for length, why in CLOCKS.items() for unit in _SECONDS}
    added = np.zeros(len(rows))
    count: dict[str, int] = {}
    for row in back.tolist():
        for period, why in periods.items():
            step = float(steps[row]) + period
            if 0 < step <= LONGEST_STEP * usual and period > FEWEST_STEPS * usual:
                added[row + 1 :] += period
                count[why] = count.get(why, 0) + 1
                break
    if not count:
        return stamps, ()
    whole = stamps.copy()
    whole[rows] += added
    notes = [f"{why}{f' {n} times' if n > 1 else ''}" for why, n in count.items()]
    return whole, tuple(f"{note}: time counts on" for note in notes)


def seconds_since_first(stamps: Array) -> Array:
    """Time from the first row of the log, s; after a clock was set back, the time continues.

    stamps: (n,) s, NaN where there is none; rows a little out of order keep their stamps
    """
    from .uneven_stamps import OUT_OF_ORDER

    rows = np.flatnonzero(np.isfinite(stamps))
    since = stamps - (stamps[rows[0]] if len(rows) else 0.0)
    steps = np.diff(since[rows])
    forward = steps[steps > 0]
    if not len(forward):
        return np.asarray(since)
    usual = float(np.median(forward))
    set_back = steps < -(OUT_OF_ORDER + 0.5) * usual
    since[rows[1:]] += np.cumsum(np.where(set_back, usual - steps, 0.0))
    return np.asarray(since)
