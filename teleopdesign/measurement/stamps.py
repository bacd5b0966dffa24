"""Time stamps as they are written: their unit, and the wraps of their clock.

A microcontroller that counts microseconds in 32 bits starts again after 71 minutes; a time of day
starts again at midnight; a clock without a zone goes back an hour in autumn.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..base.sentences import percent
from .encoder import SURELY, Array
from .limits import HALF
from .reading import ReadingStep
from .record_clock import EVEN, SHORTEST, RecordClock
from .usual_step import are_set_back, usual_step

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


def read_at_stamps(
    clock: RecordClock, positions: Sequence[Array], file: str
) -> tuple[bool, list[ReadingStep]]:
    """Whether each row was taken at its stamp, with the reading steps that report it.

    positions: (m,) each, of the clock's rows
    """
    h, rule = clock.sample_time, "positions interpolated, commands held"
    if clock.counted or clock.jitter <= EVEN * h:
        return False, []
    numbers: dict[str, float] = {"rate": 1.0 / h}
    if math.isinf(clock.jitter):
        steps = np.diff(clock.stamps) / h
        numbers |= {"shortest": float(steps.min()), "longest": float(steps.max())}
        between = " to ".join(f"{numbers[key]:.2g}" for key in ("shortest", "longest"))
        text, stamped = f"uneven stamps, steps of {between} times {h:.3g} s", True
        rule = f"each row at its own stamp: {rule}"
    else:
        slope, error = stamps_are_true(clock, positions)
        numbers |= {"jitter": clock.jitter, "followed": slope}
        text = f"stamps {percent(clock.jitter / h, '.2g')} of a row off an even clock"
        share = f"({slope:.2f} +- {error:.1g} of what they say)"
        stamped = slope > HALF and math.isfinite(error)
        rule = f"the position was read at its stamps {share}: {rule}"
        if not stamped:
            rule = f"read on an even clock, for the position does not follow the stamps {share}"
    effect = "none"
    if "followed" in numbers and not abs(slope - 0.5) > SURELY * error:
        effect = "the position hardly tells, so that it makes little difference"
    step = ReadingStep(
        file,
        text,
        rule,
        effect,
        topic="sample clock",
        numbers=tuple(numbers.items()),
        interpolates=stamped,
    )
    return stamped, [step]


def stamps_are_true(clock: RecordClock, positions: Sequence[Array]) -> tuple[float, float]:
    """Whether a position follows uneven stamps (coefficient 1) or an even clock (coefficient 0).

    The deviation of a reading from its neighbours is regressed on the speed times the deviation of
    the stamp from the even clock. Both are second differences, which suppress a smooth motion.

    positions: (m,) each, of the clock's rows
    returns: the coefficient and its standard error; (1, inf) if the positions do not decide
    """
    above = below = 0.0
    pairs: list[tuple[Array, Array]] = []
    off = clock.stamps - clock.time[clock.places]
    for stretch in clock.of_rows:
        place = clock.places[stretch]
        if len(place) < 5:
            continue
        inner = (place[2:] - place[:-2] == 2)[1:-1]
        late = off[stretch] - off[stretch].mean()
        for x in positions:
            x = x[stretch]
            speed = np.zeros(len(x))
            speed[1:-1] = (x[2:] - x[:-2]) / (2.0 * clock.sample_time)
            bend = np.diff(x, 2)[1:-1][inner]
            made = np.diff(speed * late, 2)[1:-1][inner]
            scale = float(np.mean(bend**2))
            if scale > 0 and len(bend):
                above += float(made @ bend) / scale
                below += float(made @ made) / scale
                pairs.append((bend / math.sqrt(scale), made / math.sqrt(scale)))
    if below <= 0:
        return 1.0, math.inf
    slope = above / below
    left = sum(float(np.sum((b - slope * m) ** 2)) for b, m in pairs)
    number = sum(len(b) for b, _ in pairs)
    # neighbouring second differences share readings: six of them count as one
    return slope, math.sqrt(6.0 * left / max(number, 1) / below)
