"""Relations between columns of a log: wraps, and which column is the derivative of another."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ..column_names import is_another_quantity, likeness
from ..encoder import SURELY, Array
from ..filtering import spectrum
from ..first_guess import motion_columns, rows_each_way
from ..limits import NEARLY_ALL, SMALL
from .content import SURE_NAME, SurveyedColumn, rises
from .roles import is_unit_of, says

#: correlation from which one column is the derivative of another
DERIVATIVE = 0.9
#: units of a speed over those of the derivative: the same, and revolutions a minute of turns, rad
#: and deg
RATES = (1.0, 1 / 60.0, 2 * math.pi / 60.0, 6.0)
#: counts that encoders have in a turn, and the part by which an estimate may miss one of them:
#: 4000 and 4096 differ by 0.023
USUAL_COUNTS = tuple(
    sorted(
        {float(2**k) for k in range(7, 25)}
        | {m * 10.0**k for m in (1, 2, 4, 5, 8) for k in (2, 3, 4)}
    )
)
NEAR_USUAL = 0.02
#: part of its range over which a column leaps
LEAP = 0.6
#: usual steps from row to row that a leap of a wrap is longer than: a fifth of a turn in a row
UNLIKE = 5.0
#: lengths of a turn in units of angle; fewest counts of a turn, below which a number of counts may
#: be the range of a motion
TURNS, FEWEST_COUNTS = (360.0, 2 * math.pi, 1.0, 400.0, 180.0, math.pi), 500.0


def unwrap_column(x: Array) -> Array:
    """A column without its wraps."""
    jump = wrap_of(x)
    return x if jump is None else np.asarray(np.unwrap(x, period=jump))


def wrap_of(x: Array) -> float | None:
    """Period at which a column wraps; None: it does not wrap.

    A column wraps if it jumps over most of its range. The period is a turn in a unit of angle, a
    power of two, or a usual number of counts per turn of an encoder.
    """
    reach = float(np.ptp(x))
    steps = np.diff(x)
    usual = float(np.quantile(np.abs(steps), 0.95))
    is_jump = np.abs(steps) > max(LEAP * reach, UNLIKE * usual)
    if reach == 0.0 or not is_jump.any():
        return None
    # across a wrap the motion is as in the neighbouring rows
    beside = np.pad(np.where(is_jump, 0.0, steps), 1)
    number = np.maximum(np.convolve(~is_jump, (1, 0, 1), "same"), 1)
    turn = float(np.median(np.abs(steps - (beside[:-2] + beside[2:]) / number)[is_jump]))
    periods = [*TURNS, *(2.0**k for k in range(8, 33))]
    if np.array_equal(x, np.round(x)):
        periods += [n for n in USUAL_COUNTS if n >= FEWEST_COUNTS]
    period = min(periods, key=lambda one: abs(one - turn))
    near = abs(period - turn) < NEAR_USUAL * period
    return period if near else None


def leaps(x: Array) -> bool:
    """Whether a column leaps over most of its range from one row to the next, as a command may."""
    return bool(np.max(np.abs(np.diff(x)), initial=0.0) > LEAP * np.ptp(x))


def turn_of(x: Array) -> str | None:
    """The unit of angle in which a column wraps at one turn: deg, rad; None: it does not."""
    units = {360.0: "deg", 2 * math.pi: "rad"}
    wrap = wrap_of(x)
    return None if wrap is None else units.get(wrap)


def derivative_factor(x: Array, v: Array, sample_time: float) -> tuple[float, float]:
    """Factor and correlation between the derivative of x and a column v."""
    s = spectrum(len(x), sample_time)
    low = s.lowpass(min(0.02 / sample_time, 20.0))
    rate = s.back(s.transform(x) * low * s.derivative(1))
    slow = s.multiply(v, low)
    inner = slice(len(x) // 50 + 1, -len(x) // 50 - 1)
    a, b = rate[inner] - rate[inner].mean(), slow[inner] - slow[inner].mean()
    power = float(a @ a)
    if power <= 0 or float(b @ b) <= 0:
        return 0.0, 0.0
    return float(a @ b) / power, float(a @ b) / math.sqrt(power * float(b @ b))


def may_be_position(name: str, columns: Mapping[str, SurveyedColumn], sample_time: float) -> bool:
    """Whether a column of a log is no second clock: the angle of a wheel may only rise, too.

    Then its name or unit says so, or it rises at the speed in another column.
    """
    column = columns[name]
    if not rises(column.readings):
        return True
    if likeness(name, "position") >= SURE_NAME or is_unit_of(column.unit, "position"):
        return not is_unit_of(column.unit, "time")
    steps = np.diff(column.readings[np.isfinite(column.readings)])
    if column.unit is not None or likeness(name, "time") > 0 or np.all(steps == steps[0]):
        return False
    others = (c for n, c in columns.items() if n != name and not rises(c.readings))
    return any(is_mean_rate(column.values, c.values, sample_time) for c in others)


def may_be_ramp(column: SurveyedColumn) -> bool:
    """Whether a column that only rises may be a force: it is called one, and counts no rows."""
    x = column.readings
    return is_force(column) and not np.array_equal(x, np.arange(len(x)) + x[0])


def is_force(column: SurveyedColumn) -> bool:
    """Whether unit or name of a column are those of a force."""
    if column.unit is not None:
        return is_unit_of(column.unit, "force")
    return likeness(column.name, "actuator_force") >= SURE_NAME > likeness(column.name, "velocity")


def is_velocity(column: SurveyedColumn) -> bool:
    """Whether unit or name of a column are those of a velocity."""
    if is_unit_of(column.unit, "velocity"):
        return True
    return column.unit is None and likeness(column.name, "velocity") >= SURE_NAME


def is_no_velocity(column: SurveyedColumn) -> bool:
    """Whether unit or name of a column are those of a force, a position or another quantity.

    Friction, a voltage and the pressure against friction resemble a velocity, and so does an angle
    beside a motion with which it drifts.
    """
    angle_or_length = is_unit_of(column.unit, "position") and not is_unit_of(
        column.unit, "velocity"
    )
    another = is_another_quantity(column.name) or says(column.name, "difference")
    return is_force(column) or angle_or_length or another


def rate_agreement(x: Array, v: Array, sample_time: float) -> float:
    """How surely a column v is the derivative of x, up to 1: from `DERIVATIVE` on, it is."""
    _, agree = derivative_factor(x, v, sample_time)
    if agree > DERIVATIVE:
        return agree if has_both_signs(x, v, sample_time) else 0.0
    return 1.0 if is_mean_rate(x, v, sample_time) else agree


def has_both_signs(x: Array, v: Array, sample_time: float) -> bool:
    """Whether v changes its sign with the direction of x, as a velocity does; True for one way.

    Dry friction beside a large constant force follows the direction, too, but keeps its sign.
    """
    direction = motion_columns(x, sample_time)[2]
    inner = slice(len(x) // 50 + 1, -len(x) // 50 - 1)
    forward, backward = (v[inner][way] for way in rows_each_way(direction[inner]))
    if min(len(forward), len(backward)) < (1.0 - NEARLY_ALL) * len(v):
        return True
    return float(forward.mean() * backward.mean()) <= 0.0


def is_mean_rate(x: Array, v: Array, sample_time: float) -> bool:
    """Whether x moves one way at the mean of v, which hardly varies: a motor at a stated speed.

    Such a speed varies by little more than its noise, and stamps of another clock leave nothing of
    these variations in the derivative of x.
    """
    total, path = float(x[-1] - x[0]), float(np.sum(np.abs(np.diff(x))))
    mean = float(np.mean(v))
    if not abs(total) > NEARLY_ALL * path or not abs(mean) > SURELY * float(np.std(v)):
        return False
    factor = total / (sample_time * (len(x) - 1)) / mean
    return any(abs(factor / usual - 1.0) < SMALL for usual in RATES)
