"""What each column of a log is beside its position, such as a set point, and so no force.

A column is no force where one of the relations of `relations_of` holds: it is the position or its
velocity once more, a set point, or the motion of another body. The same sentence says why the
column is not used, and is given where no force is left. A force that is left out without a remark
would look like physics that the model lacks.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from ...base.units import is_unit
from ..column_names import WANTED, is_wanted, likeness, words_of
from ..encoder import SURELY, Array
from ..first_guess import least_squares, stretch_of
from ..law_of_readings import is_copy
from ..limits import SEVERAL, SMALL
from .content import SURE_NAME, Survey, SurveyedColumn, columns_in_use, moves, rises, sample_time_of
from .derivative import DERIVATIVE, derivative_factor, is_velocity, may_be_ramp
from .roles import LEAST_LEFT, is_current, is_nameless, is_unit_of, says

Indices = NDArray[np.intp]

#: part of the squares of a column by which its position may differ: two columns that agree as a
#: velocity and the derivative of its position must
APART = 1.0 - DERIVATIVE**2
#: likeness of a name to that of a force, from which it is no set point whatever the numbers are:
#: "torque", "current", "effort". "pwm", "u" and "cmd" name pulses of a set point as well
FORCE_NAME = 0.85

#: most rows by which a drive may be late behind its command; it may also smooth over these rows
LATE = 4
#: correlation from which one column is the derivative of another to its digits, as of a planned
#: path: friction of 1 % of a force lowers it below
EXACT = 0.9999


def relations_of(
    survey: Survey, position: str, velocity: str | None, x: Array
) -> Iterator[tuple[str, str]]:
    """Columns that are no force beside a position x (n,), each with what it is, as a noun phrase.

    velocity: its column, if there is one.  A column in the unit of a force has no relation
    """
    speed = None if velocity is None else survey.columns[velocity].values
    planned = dict(_planned_motions(survey, sample_time_of(survey)))
    for name, column in survey.columns.items():
        used = name in (position, velocity) or name in columns_in_use(survey)
        if used or not moves(column) or is_unit_of(column.unit, "force"):
            continue
        what = _relation(column, position, x, speed) or planned.get(name)
        if what is not None:
            yield name, what


def _relation(column: SurveyedColumn, position: str, x: Array, speed: Array | None) -> str | None:
    """What a column is beside a position x (n,) and its velocity; None: it may be a force."""
    name, values = column.name, column.values
    forces = max(likeness(name, f"{whose}_force") for whose in ("actuator", "interaction"))
    if column.unit and is_unit(column.unit):
        if is_unit_of(column.unit, "velocity"):
            return f"a velocity, but not that of {position!r}"
        beside = is_unit_of(column.unit, "position")
        return f"a position beside {position!r}" if beside else f"a column in {column.unit}"
    if may_be_set_point(column) and has_numbers_of(values, x):
        return f"a set point, or a reading once more: it has the numbers of {position!r}"
    if is_sent_to_places(x, column):
        return f"a set point: {position!r} rests at a place of its own for each of its values"
    if forces == 0 and is_copy(values, x):
        return f"{position!r} times a constant plus a constant: another unit, or a control error"
    if forces == 0 and speed is not None and is_copy(values, speed):
        return f"the velocity of {position!r} once more: another unit, or a control error"
    # a symbol is no word: "v" may be a voltage as well
    if is_velocity(column) and any(
        len(w) > 1 and likeness(w, "velocity") >= SURE_NAME for w in words_of(name)
    ):
        return "a velocity by its name"
    return "an acceleration by its name" if says(name, "acceleration") else None


def left_in_turn(
    force: Array, position: Array, sample_time: float, beside: Array | None = None
) -> tuple[float, float]:
    """Part of a force (n,) that its place leaves, and part of that which the motion leaves.

    Place: a cubic of the position, which a spring, a weight or a second reading of the position
    follows. Motion: inertia, friction and damping beside it. Where the place leaves less than a
    hundredth, friction must be certain, and brake where the place pulls back: a reading that is
    late has friction of the other sign.

    beside: another force (n,), which counts as the place does, with its rate: one force may be
        computed from the other
    """
    others = [] if beside is None else [beside, np.gradient(beside)]
    stretch = stretch_of((force, position, *others), position, sample_time)
    if stretch is None:
        return 1.0, 1.0
    columns, (target, place, *others) = stretch
    place = (place - place.mean()) / max(float(np.ptp(place)), np.finfo(float).tiny)
    powers = np.stack([columns[3], place, place**2, place**3, *others])
    of_place = least_squares(powers, target, sample_time)
    of_all = least_squares(np.vstack([columns[:3], powers]), target, sample_time)
    whole = float(np.var(target))
    if not of_place[2] * whole > 0.0:
        return 1.0, 1.0
    (factors, errors, left), without = of_all, of_place[2]
    brakes = factors[1:3] * np.sign(target @ place) > SURELY * errors[1:3]
    share = without**2 / whole
    is_place = share < LEAST_LEFT and not brakes.any()
    return min(share, 1.0), 1.0 if is_place else min(left / without, 1.0) ** 2


def causes_acceleration(place: Array, column: Array, sample_time: float) -> bool:
    """Whether a column (n,) is the acceleration that another one causes as a force.

        place = m column + c sgn(v) + b v + k,   v: the integral of the column

    A torque and an acceleration imitate a position and its force: each is in proportion to the
    other but for friction. The relation that leaves less holds, if its inertia is surely positive.
    """
    rows = np.arange(len(column))
    speed = sample_time * np.cumsum(column - column.mean())
    # the speed at the first row, and the offset of a sensor, are not known
    speed -= np.polynomial.Polynomial.fit(rows, speed, 1)(rows)
    stretch = stretch_of((place, column, np.sign(speed), speed), place, sample_time)
    if stretch is None:
        return False
    (*_, one), (target, *caused) = stretch
    factors, errors, left = least_squares(np.stack([*caused, one]), target, sample_time)
    by_motion = math.prod(left_in_turn(column, place, sample_time))
    return bool(factors[0] > SURELY * errors[0] and left**2 < np.var(target) * by_motion)


def possible_forces(survey: Survey, *used: str | None) -> dict[str, SurveyedColumn]:
    """The columns that may be a force: those of no other relation to the position."""
    return {
        name: column
        for name, column in survey.columns.items()
        if name not in (*used, *survey.relations) and name not in columns_in_use(survey)
        if moves(column) and (not rises(column.readings) or may_be_ramp(column))
    }


def _planned_motions(survey: Survey, h: float) -> Iterator[tuple[str, str]]:
    """Columns without names that are position, velocity and acceleration of a planned path.

    Each is exactly the derivative of the one before. Two such columns alone tell less: the friction
    of a body that goes to and fro at one speed is the derivative of its position, too.
    """
    columns = {n: c.values for n, c in survey.columns.items() if moves(c) and is_nameless(c)}
    rates = {
        one: {n: derivative_factor(y, v, h)[1] for n, v in columns.items() if n != one}
        for one, y in columns.items()
    }
    exact = {one: [n for n, agree in of.items() if agree > EXACT] for one, of in rates.items()}
    for one, after in exact.items():
        for two, three in ((b, c) for b in after for c in exact[b] if c != one):
            for name in (one, two, three):
                yield name, "a motion that was planned: an exact derivative, or integral, of others"


def lags(column: Array, other: Array) -> bool:
    """Whether a column has the numbers of another one, only later.

    The delay may be less than a row, as that of a position behind the path that a drive plans: then
    the numbers agree a row later rather than a row earlier.
    """
    apart = _, later, earlier = _least_apart(column, other)
    return min(apart) < APART and later < earlier


def is_sent_to_places(position: Array, column: SurveyedColumn) -> bool:
    """Whether a position rests at a place of its own for each value that another column holds.

    The places are in proportion to the values, and the values keep away from zero: pulse widths of
    a hobby servo, or counts of a converter, are a set point in another unit than the position.
    """
    values = column.values
    if likeness(column.name, "actuator_force") >= FORCE_NAME or values.min() * values.max() <= 0.0:
        return False
    ends = np.flatnonzero(np.diff(values))  # the last row of each hold
    ends = ends[ends > 0]
    if not _rests_at(ends, position):
        return False
    line = np.polynomial.Polynomial.fit(values[ends], position[ends], 1)
    apart = float(np.mean((position[ends] - line(values[ends])) ** 2))
    return apart < APART * float(np.var(position[ends]))


def _rests_at(ends: Indices, position: Array) -> bool:
    """Whether a position is slower than on the average at the ends of enough holds."""
    if len(ends) < SEVERAL or 2 * len(ends) > len(position):
        return False
    change = np.abs(np.diff(position))
    return float(np.mean(change[ends - 1])) < float(np.mean(change))


def has_numbers_of(column: Array, position: Array) -> bool:
    """Whether a column has the numbers of the position, at the same time, earlier or later."""
    return min(_least_apart(column, position)) < APART


def may_be_set_point(column: SurveyedColumn) -> bool:
    """Whether unit and name of a column leave open that it is a set point of the position.

    "cmd" and "command" name forces and set points; "torque" names a force only. Per cent may be
    parts of a stroke or of a torque.
    """
    if column.unit not in (None, "%") and is_unit_of(column.unit, "force"):
        return False
    plain = " ".join(word for word in words_of(column.name) if word not in WANTED)
    return max(likeness(plain, f"{k}_force") for k in ("actuator", "interaction")) < SURE_NAME


def _delays(rows: int) -> Iterator[int]:
    """Delays in rows, each about a quarter longer than the one before."""
    delay = 1
    while delay <= max(SMALL * rows, 1.0):
        yield delay
        delay += 1 + delay // 4


def _least_apart(column: Array, other: Array) -> tuple[float, float, float]:
    """How far the numbers of a column are from another's: those of the same row, later, earlier."""
    delays = [*_delays(len(column))]
    pairs = ((column, other), (other, column))
    later, earlier = (min(_apart(*pair, k) for k in delays) for pair in pairs)
    return _apart(column, other, 0), later, earlier


def _apart(late: Array, early: Array, delay: int) -> float:
    """Mean square of the difference between a column and one `delay` rows earlier, over its own."""
    rows = len(late) - delay
    whole = float(np.var(late))
    return float(np.mean((late[delay:] - early[:rows]) ** 2)) / whole if whole > 0 else np.inf


def current_that_acted(
    force: str, columns: Mapping[str, SurveyedColumn], scores: Mapping[str, float]
) -> tuple[str, float] | None:
    """A measured current that acted in place of the commanded `force`, and how far the two differ.

    A model-based controller logs the force that its model demands. Friction that the model lacks
    shows only in the measured current: with the commanded force no effect would seem to be missing.

    returns: the column of the current, and the rms of the part that the command does not explain,
        over the rms of the current; None: `force` is no command, or the drive followed it
    """
    if not is_wanted(force):
        return None
    measured = [
        name
        for name, column in columns.items()
        if name != force and is_current(column) and not is_wanted(name)
        if likeness(name, "actuator_force") >= SURE_NAME
        # the current that a drive draws from its supply has one side
        if not _smaller_side(column.values) < SMALL < _smaller_side(columns[force].values)
    ]
    if not measured:
        return None
    best = max(measured, key=lambda name: scores[name])
    share = _unexplained_share(columns[force].values, columns[best].values)
    return (best, share**0.5) if share > LEAST_LEFT else None


def _smaller_side(x: Array) -> float:
    """The largest value of the smaller side of zero, over that of the larger side."""
    sides = sorted((max(float(np.max(x)), 0.0), max(-float(np.min(x)), 0.0)))
    return sides[0] / sides[1] if sides[1] > 0.0 else 0.0


def _unexplained_share(wanted: Array, measured: Array) -> float:
    """Part of the variance of a measured force that the commanded force does not explain.

    The residual of each row is multiplied by that of the next row, so that noise of single rows and
    the steps of a converter average out.
    """
    rows = len(measured) - LATE
    late = [wanted[LATE - k : LATE - k + rows] for k in range(LATE + 1)]
    columns = np.column_stack([*late, np.ones(rows)])
    target = measured[LATE:]
    whole = float(np.mean((target - target.mean()) ** 2))
    solution, *_ = np.linalg.lstsq(columns, target, rcond=1e-8)
    left = target - columns @ solution
    return float(np.mean(left[1:] * left[:-1])) / whole if whole > 0 else 0.0
