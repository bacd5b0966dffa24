"""Which of several columns that may be clocks is the time of a log; its rate without a clock."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import permutations

import numpy as np

from ...base.units import measures, si_factor
from ..column_names import is_wanted, likeness, words_of
from ..doors._log import Log
from ..doors.shapes._table import AS_EVEN_AS_A_CLOCK
from .content import Array, Choices
from .derivative import DERIVATIVE, SAME, derivative_factor, has_both_signs, unwrap_column, wrap_of

#: times as uneven as another column that a first column without a name may rise. Two: the stamps of
#: a logger spread by a third of a step at most, the angle of a motor at ripple by its whole step
FAR_LESS_EVEN = 2.0
#: part of the steps at either end that may differ by more than those of a clock
AT_EITHER_END = 0.05
#: fewest columns of a log whose count of rows leaves a clock, a position and a force
FEWEST_BESIDE_A_COUNT = 4
#: rate that is assumed where nothing tells it, Hz: that of most controllers
ASSUMED = 1000.0
#: fewest rows and most columns that are looked at
FEWEST, MOST = 60, 12
#: part by which a rate with fewer digits may be off: a derivative along rows tells it no better
ROUNDED = 0.005


def clock_without_name(rising: Mapping[str, Array], width: int) -> tuple[str, str]:
    """The time among columns that always rise, where no name tells it, and why it is the time.

    The first one, unless it rises far less evenly than another: the angle of a motor that turns one
    way rises, too. A column that counts rows is the time only as the first one, and not beside
    stamps of a clock.

    width: number of columns of the log
    """
    first, *others = rising
    if width >= FEWEST_BESIDE_A_COUNT and counts_rows(rising[first]):
        stamps = [n for n in others if _is_stamp(rising[n])]
        if stamps:
            return stamps[0], f"as even as a clock, beside {first!r}, which counts the rows"
    uneven = {n: _unevenness(rising[n]) for n in others if not counts_rows(rising[n])}
    even = min(uneven, key=lambda n: uneven[n], default=first)
    if even != first and FAR_LESS_EVEN * uneven[even] < _unevenness(rising[first]):
        return even, "the column that rises most evenly"
    return first, "the first column that always rises"


def _unevenness(x: Array) -> float:
    """Median deviation of a column's steps from their median, over it; inf where that is zero."""
    steps = np.diff(x[np.isfinite(x)])
    usual = float(np.median(steps))
    return float(np.median(np.abs(steps - usual))) / usual if usual > 0 else float("inf")


def _is_stamp(x: Array) -> bool:
    """Whether whole numbers rise as evenly as the stamps of a clock, and are no count of rows."""
    steps = np.diff(x[np.isfinite(x)])
    usual = float(np.median(steps))
    low, high = np.quantile(steps, [AT_EITHER_END, 1.0 - AT_EITHER_END])
    even = usual > 1.0 and float(high - low) < AS_EVEN_AS_A_CLOCK * usual
    return bool(even and np.all(steps > 0) and np.array_equal(x, np.round(x)))


def counts_rows(x: Array) -> bool:
    """Whether a column is the number of each row."""
    return bool(np.all(np.diff(x[np.isfinite(x)]) == 1.0))


def clock_of_position(
    first: str, scores: Mapping[str, float], raw: Mapping[str, Array], choices: Choices
) -> str | None:
    """A clock of the same rank as the first one, with more words of the position's name.

    "motor_time" beside "sensor_time" and "motor_position".  None: the first one is as near
    """
    wanted = set(words_of(position_by_name(raw, choices)))
    shared = {n: len(wanted & set(words_of(n))) for n, s in scores.items() if s == scores[first]}
    best = max(shared, key=lambda n: shared[n])
    return best if shared[best] > shared[first] else None


def position_by_name(raw: Mapping[str, Array], choices: Choices) -> str:
    """The column that is stated as the position, or most likely one by its name."""
    if choices.position is not None:
        return choices.position
    return max(raw, key=_likeness_of_position)


def _likeness_of_position(name: str) -> float:
    """How surely a name is that of a measured position; a set point is named alike."""
    return likeness(name, "position") - 0.6 * is_wanted(name)


def busiest_clock(log: Log, raw: Mapping[str, Array], choices: Choices) -> str:
    """The clock of the position, among several clocks of a log."""
    if choices.position is not None:
        return log.clocks[choices.position]
    scores = {n: _likeness_of_position(n.rpartition(".")[2]) for n in raw if n in log.clocks}
    best = max(scores, key=lambda n: (scores[n], len(raw[n])))
    return log.clocks[best]


def rate_of_velocity(
    raw: Mapping[str, Array], units: Mapping[str, str]
) -> tuple[float, str] | None:
    """The rate at which one column is the derivative of another, Hz, and the sentence that says so.

    None: no column is one at a rate other than the assumed one, or its unit could be any.

    raw: columns of numbers, by name;  units: those that are known
    """
    moving = {n: x for n, x in raw.items() if len(x) >= FEWEST and np.ptp(x) > 0}
    flat = {n: unwrap_column(x, wrap_of(x)) for n, x in list(moving.items())[:MOST]}
    best, pair = (0.0, DERIVATIVE), ("", "")
    for place, speed in permutations(flat, 2):
        x, v = flat[place], moving[speed]
        scale = _scale(units.get(place), units.get(speed))
        if len(x) != len(v) or scale is None or likeness(speed, "position") > 0:
            continue
        factor, agree = derivative_factor(x, v, 1 / ASSUMED)
        if agree > best[1] and has_both_signs(x, v, 1 / ASSUMED):
            best, pair = (factor * scale, agree), (place, speed)
    if not best[0] > 0 or abs(best[0] - 1.0) < SAME:
        return None
    rates = [float(f"{ASSUMED * best[0]:.{digits}g}") for digits in (1, 2, 3)]
    rate = next((r for r in rates if abs(r / (ASSUMED * best[0]) - 1.0) < ROUNDED), rates[-1])
    unit = ""
    if not all(units.get(n) for n in pair):
        if not all(likeness(n, q) > 0 for n, q in zip(pair, ("position", "velocity"), strict=True)):
            return None
        unit = f", if it is in the unit of {pair[0]!r} per second"
    return rate, f"{pair[1]!r} is the derivative of {pair[0]!r} at this rate{unit}"


def _scale(of_place: str | None, of_speed: str | None) -> float | None:
    """Units of a speed over those of a position, in SI; None: they do not belong together."""
    if of_place is None or of_speed is None:
        return 1.0
    for axis in ("revolute", "prismatic"):
        fits = measures(of_place, "position", axis) and measures(of_speed, "velocity", axis)
        if fits and of_place != "counts":
            speed = si_factor(of_speed, quantity="velocity", axis=axis)
            return speed / si_factor(of_place, quantity="position", axis=axis)
    return None
