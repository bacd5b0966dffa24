"""Which of several columns that may be clocks is the time of a log; its rate without a clock."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import permutations

import numpy as np

from ...base.units import measures, si_factor
from ..column_names import is_wanted, likeness
from ..doors._log import Log
from .content import Array, Choices
from .derivative import DERIVATIVE, SAME, derivative_factor, has_both_signs, unwrap_column, wrap_of

#: rate that is assumed where nothing tells it, Hz: that of most controllers
ASSUMED = 1000.0
#: fewest rows and most columns that are looked at
FEWEST, MOST = 60, 12
#: part by which a rate with fewer digits may be off: a derivative along rows tells it no better
ROUNDED = 0.005


def counts_rows(x: Array) -> bool:
    """Whether a column is the number of each row."""
    return bool(np.all(np.diff(x[np.isfinite(x)]) == 1.0))


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
