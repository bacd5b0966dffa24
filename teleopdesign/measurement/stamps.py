"""Time stamps as they are written: their unit, and the wraps and late turns of their clock.

A microcontroller that counts microseconds in 32 bits starts again after 71 minutes; a time of day
starts again at midnight; a clock without a zone goes back an hour in autumn. A logger that reads
the seconds of a clock before their fraction writes 24.997, 24.002, 25.009.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..base.sentences import percent
from ..base.units import si_factor
from .encoder import SURELY, Array
from .limits import HALF
from .reading import ReadingStep, count_of
from .record_clock import EVEN, SHORTEST, RecordClock
from .usual_step import are_set_back, usual_step

#: s in a day
DAY = 86_400.0
#: units of stamps, as parts of a second
_SECONDS = (1.0, 1e3, 1e6, 1e9)
#: s after which a part of a clock turns -> its name, and why the clock then begins anew; "": it
#: does not, but a part that is read by itself may turn late or early
PARTS = {
    1.0: ("second", ""),
    60.0: ("minute", ""),
    3600.0: ("hour", "the clock goes back an hour"),
    43_200.0: ("half of the day", "the time of day begins anew after twelve hours"),
    DAY: ("day", "the time of day begins anew at midnight"),
    604_800.0: ("week", "the week begins anew"),
}
#: step of a counter of 16, 24 or 32 bits at its wrap -> as in `PARTS`
COUNTERS = {2.0**n: ("upper half", f"a counter of {n} bits wraps") for n in (16, 24, 32)}
#: part of that time which the rows that it displaces may last, and the steps beside them: only rows
#: at its turn are displaced. Higher: a pause before a clock was set back passes for one
TURN = 0.25
#: longest step over a wrap, in usual steps: a few rows may be lost there
LONGEST_STEP = 20.0
#: days between two rows: 0.2 s, as in seconds
LONGEST_DAYS = 0.2 / DAY
#: rows a second that no log of a machine has; a scope may have 1 MHz
FASTEST = 1.001e6


def unwrap_stamps(stamps: Array) -> tuple[Array, tuple[str, ...]]:
    """Stamps without the wraps of their counter or clock, and a note on each kind of wrap.

    A step back is a wrap if adding its period leaves a step like the others. Where a step forward
    by the same period lies beside it, the rows between them are displaced by that period.

    stamps: (n,) in any unit, NaN where there is none
    """
    rows = np.flatnonzero(np.isfinite(stamps))
    whole, notes = stamps[rows], []
    steps = np.diff(whole)
    if not np.any(steps > 0) or not np.any(steps < 0):
        return stamps, ()
    longest = LONGEST_STEP * float(np.median(steps[steps > 0]))
    periods = {unit * length: words for length, words in PARTS.items() for unit in _SECONDS}
    for period, (part, why) in {**periods, **COUNTERS}.items():
        steps = np.diff(whole)
        rest = steps - np.sign(steps) * period
        near = (rest > 0) & (rest <= longest)
        turns = np.flatnonzero(near & (rest <= TURN * period))
        late = _displaced_rows(turns, steps, whole, TURN * period)
        whole = whole + period * late
        for shift, when, more in ((1, "late", "later"), (-1, "early", "earlier")):
            if count := int(np.count_nonzero(late == shift)):
                notes.append(
                    f"the {part} turns {when} in {count_of(count, 'row')}: read a {part} {more}"
                )
        wraps = near & (steps < 0) & (np.diff(late) == 0)
        if why and (count := int(np.count_nonzero(wraps))):
            whole[1:] += period * np.cumsum(wraps)
            notes.append(f"{why}{f' {count} times' if count > 1 else ''}: time counts on")
    if not notes:
        return stamps, ()
    unwrapped = stamps.copy()
    unwrapped[rows] = whole
    return unwrapped, tuple(notes)


def _displaced_rows(
    turns: NDArray[np.intp], steps: Array, stamps: Array, longest: float
) -> NDArray[np.int_]:
    """1 for each row that is a period early, -1 for each that is a period late, 0 for the others.

    turns: steps by a period, forward or back;  longest: of such rows
    """
    shift = np.zeros(len(stamps), dtype=int)
    k = 0
    while k + 1 < len(turns):
        here, there = int(turns[k]), int(turns[k + 1])
        k += 1
        lasts = float(stamps[there] - stamps[here + 1])
        if steps[here] * steps[there] < 0.0 <= lasts <= longest:
            shift[here + 1 : there + 1] = -np.sign(steps[here])
            k += 1
    return shift


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


def unit_in_place_of(stated: str, stamps: Array) -> tuple[str, str] | None:
    """The unit of a time column whose name states another, and the reason; None: it may be right.

    The name is wrong where its unit makes the log too short for a record and its rows faster than
    those of any logger: seconds in a column "time_us".
    """
    steps = np.abs(np.diff(stamps[np.isfinite(stamps)]))
    usual = float(np.median(steps)) if len(steps) else 0.0
    factor = si_factor(stated, quantity="time")
    if usual == 0.0 or usual * factor * FASTEST > 1.0 or np.sum(steps) * factor > SHORTEST:
        return None
    unit, _ = unit_of_steps(stamps)
    rate = f"{1.0 / (usual * factor):.3g} rows a second"
    return unit, f"{unit}: in {stated}, as its name says, the log would have {rate}"


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
    effect = effect_of_even_stamps(clock, positions) if stamped else "none"
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


def effect_of_even_stamps(clock: RecordClock, positions: Sequence[Array]) -> str:
    """The error of the position if the stamps were read as even, as a text."""
    off = clock.stamps - clock.time[clock.places]
    speeds = [
        float(np.sqrt(np.mean((np.gradient(x, clock.stamps) * off) ** 2)))
        / max(float(np.ptp(x)), 1e-300)
        for x in positions
    ]
    if not speeds:
        return "none"
    return f"read as even, positions would err by {percent(max(speeds), '.2g')} of the travel"
