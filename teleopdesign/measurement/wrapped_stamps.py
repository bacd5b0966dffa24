"""Time stamps across the wrap of a counter, across midnight, and after a clock was set back.

A microcontroller that counts microseconds in 32 bits starts again after 71 minutes; a time of day
starts again at midnight; a clock without a zone goes back an hour in autumn. A logger that reads
the seconds of a clock before their fraction writes 24.997, 24.002, 25.009.
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
#: s of a part of a clock that is read by itself -> its name
PARTS = {1.0: "second", 60.0: "minute", 3600.0: "hour", 86_400.0: "day"}
#: part of that time which the rows that it displaces may last, and the steps beside them: only rows
#: at its turn are displaced. Higher: a pause before a clock was set back passes for one
TURN = 0.25
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
    stamps, displaced = _turned_in_time(stamps)
    rows = np.flatnonzero(np.isfinite(stamps))
    steps = np.diff(stamps[rows])
    forward = steps[steps > 0]
    back = np.flatnonzero(steps < 0)
    if not len(forward) or not len(back):
        return stamps, displaced
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
        return stamps, displaced
    whole = stamps.copy()
    whole[rows] += added
    notes = [f"{why}{f' {n} times' if n > 1 else ''}" for why, n in count.items()]
    return whole, displaced + tuple(f"{note}: time counts on" for note in notes)


def _turned_in_time(stamps: Array) -> tuple[Array, tuple[str, ...]]:
    """Stamps (n,) whose seconds, minutes, hours or days turn in time, and notes on those moved.

    Such a part of a clock turns late or early where its step back and a step forward lie beside
    each other, and both are like the other steps once the rows between them are moved by it.
    """
    rows = np.flatnonzero(np.isfinite(stamps))
    steps = np.diff(stamps[rows])
    if not np.any(steps < 0) or not np.any(steps > 0):
        return stamps, ()
    usual = float(np.median(steps[steps > 0]))
    moved, notes = np.zeros(len(rows)), []
    for length, name in PARTS.items():
        for period in (unit * length for unit in _SECONDS):
            longest = min(LONGEST_STEP * usual, TURN * period)
            sign = np.zeros(len(steps), dtype=int)
            for one in (1, -1):
                rest = steps - one * period
                sign[(rest > 0) & (rest <= longest)] = one
            turns = np.flatnonzero(sign)
            late = _displaced_rows(turns, sign, stamps[rows], TURN * period)
            for shift, when in ((1, "late"), (-1, "early")):
                there = late == shift
                if count := int(np.count_nonzero(there)):
                    moved[there] += shift * period
                    more = "later" if shift > 0 else "earlier"
                    of = "row" if count == 1 else "rows"
                    notes.append(f"the {name} turns {when} in {count} {of}: read a {name} {more}")
    if not notes:
        return stamps, ()
    whole = stamps.copy()
    whole[rows] += moved
    return whole, tuple(notes)


def _displaced_rows(
    turns: NDArray[np.intp], sign: NDArray[np.int_], stamps: Array, longest: float
) -> NDArray[np.int_]:
    """1 for each row that is a period early, -1 for each that is a period late, 0 for the others.

    turns: steps by a period;  sign: 1 for a step forward, -1 for one back;  longest: of such rows
    """
    shift = np.zeros(len(stamps), dtype=int)
    k = 0
    while k + 1 < len(turns):
        here, there = int(turns[k]), int(turns[k + 1])
        lasts = float(stamps[there] - stamps[here + 1])
        if sign[here] == sign[there] or not 0.0 <= lasts <= longest:
            k += 1
            continue
        shift[here + 1 : there + 1] = -sign[here]
        k += 2
    return shift


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
