"""A command that a digital controller computes from the readings of the position, row by row.

    u_k = c + sum of b_i x_(k-i), i = 0..3, + d w_k + sum of a_j u_(k-j), j = 1..2

x: readings of the position;  w: of the velocity, where it is logged
Past readings make a damper by differences, past commands the filter of the derivative. A smooth
machine is nearly linear in past rows, too. So two things are required. The law leaves no more than
the rounding of the command on each row, where the past commands are its own. And one step of a
reading moves the command by a multiple of what is left: no machine answers the rounding of a
reading, which only a controller receives.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .encoder import ENOUGH, FEWEST_STEPS, LOST, grid_of, reading_step
from .filtering import Array
from .limits import NEARLY_ALL
from .repeated_rows import runs_of

#: readings of the position, and past commands, in a row of a law
READINGS, PAST = 4, 2
#: part of the range of a command by which its numbers are wrong in a log of six digits
DIGITS = 5e-6
#: errors of the law in the command's change by one step of a reading. Where the command does not
#: contain the steps, half of this change is an error of the law, so that there are two at most
VISIBLE = 4.0
#: steps of a rounded command by which an exact law is off: half a step, and some of it again for
#: the factors, which are estimated from rounded commands
ROUNDED = 0.75
#: rows, and rows in which the reading changes, for each number of a law
FOR_EACH = 20
#: memories of the filter after which a row in a run counts: a set point that varies would be a
#: filter whose memory does not fade
MEMORIES = 3.0


@dataclass(frozen=True)
class LawOfReadings:
    """What a controller computes from the readings, SI.

    stiffness, damping: in slow motion, positive where they pull back
    is_damped: whether it has a damper;  is_partial: whether many rows are at rest or at a limit
    """

    stiffness: float
    damping: float
    is_damped: bool
    is_partial: bool = False


def is_copy(column: Array, position: Array) -> bool:
    """Whether a column is the position times a constant plus a constant, up to rounding.

    So is a reading in volts beside the same reading in mm, and the error of a controller whose set
    point is constant. A straight line of the position explains such a column to the last digit. The
    force of a real spring is not so exact: its sensor has noise of its own.
    """
    return spring_of_copy(column, position) is not None


def spring_of_copy(column: Array, position: Array) -> LawOfReadings | None:
    """The law of a command that is the position but for constants (`is_copy`); None: it is not."""
    x, y = position - position.mean(), column - column.mean()
    power = float(x @ x)
    if power == 0.0:
        return None
    slope = float(x @ y) / power
    reach, off = float(np.ptp(column)), float(np.max(np.abs(y - slope * x)))
    if off > reach / FEWEST_STEPS + LOST * reach:  # no rounding that is allowed explains it
        return None
    rounding = abs(slope) * reading_step(position) + reading_step(column)
    exact = rounding * FEWEST_STEPS <= reach and off <= rounding + LOST * reach
    return LawOfReadings(-slope, 0.0, is_damped=False) if exact else None


def law_of_readings(
    command: Array,
    position: Array,
    segments: Sequence[slice],
    *,
    sample_time: float,
    velocity: Array | None = None,
) -> LawOfReadings | None:
    """The law by which a controller computed a command; None: it is no law of the readings.

    command, position, velocity: (n,), of one record;  segments: its uninterrupted rows
    Rows in which the command rests at one value or is at its limits do not count. Where one law
    does not explain all others, those above and those below the value of rest are tried alone.
    """
    step, reach = grid_of(position, reading_step(position)), float(np.ptp(command))
    if step == 0.0 or reading_step(command) * FEWEST_STEPS > reach:
        return None
    levels, counts = np.unique(command, return_counts=True)
    rest = float(levels[np.argmax(counts)])
    inside = (command > levels[0]) & (command < levels[-1])
    x = np.round((position - position[0]) / step)
    readings = np.stack([np.roll(x - x.mean(), i) for i in range(READINGS)])
    if velocity is not None:
        readings = np.vstack([readings, velocity])
    begun = np.ones(len(x), dtype=bool)  # rows with as many rows before them as a law reads
    for segment in segments:
        begun[segment.start : segment.start + READINGS - 1] = False
    for free in (command != rest, command > rest, command < rest):
        counted = inside & free
        law = _exact_law(command, readings, counted & begun, step=step, sample_time=sample_time)
        if law is not None:
            return replace(law, is_partial=bool(np.mean(counted) < NEARLY_ALL))
    return None


def _exact_law(
    u: Array, readings: Array, free: NDArray[np.bool_], *, step: float, sample_time: float
) -> LawOfReadings | None:
    """The law of the commands (n,) in the free rows (n,); None where it is not exact.

    readings: (4 or 5, n) of the position, in steps, the present ones first, and of the velocity
    """
    from scipy.signal import lfilter, lfiltic

    # past commands are those of the law, too, if they rest at no value and no limit
    past = np.stack([np.roll(u, j) for j in range(1, PAST + 1)])
    counted = np.logical_and.reduce([np.roll(free, j) for j in range(PAST + 1)])
    rows = np.flatnonzero(counted)[:ENOUGH]
    every = np.vstack([readings, np.ones(len(u)), past])
    fewest = FOR_EACH * len(every)
    if np.count_nonzero(readings[0, rows] != readings[1, rows]) < fewest:
        return None
    sizes = np.maximum(np.abs(every[:, rows]).max(axis=1), 1e-300)
    factors = np.linalg.lstsq((every[:, rows] / sizes[:, None]).T, u[rows], rcond=None)[0] / sizes
    forward, (driven, back) = factors[:READINGS], np.split(factors, [-PAST])
    poles = np.array([1.0, *-back])
    memory = float(np.abs(np.roots(poles)).max())
    first, end = runs_of(counted[: rows[-1] + 1])
    if memory >= 1.0 or np.maximum(end - first - MEMORIES / (1.0 - memory), 0).sum() < fewest:
        return None
    push, worst = driven @ every[:-PAST], 0.0
    for a, b in zip(first.tolist(), end.tolist(), strict=True):  # from its own past commands
        law, _ = lfilter([1.0], poles, push[a:b], zi=lfiltic([1.0], poles, past[:, a]))
        worst = max(worst, float(np.abs(u[a:b] - law).max()))
    lost = DIGITS * float(np.ptp(u))
    # of a law that is exact up to the rounding of the command
    exact = ROUNDED * reading_step(u) * (1.0 + float(np.abs(back).sum())) + lost
    if worst > exact or np.abs(forward).max() < VISIBLE * max(worst, lost):
        return None
    # in slow motion: the response to z = exp(s), to first order
    now = 1.0 - float(back.sum())
    spring = float(forward.sum()) / now
    late = float(np.arange(READINGS) @ forward) + spring * float(np.arange(1, PAST + 1) @ back)
    damping = late / now * sample_time / step
    speed = np.ptp(readings[0, rows] - readings[1, rows]) * step / sample_time
    if len(readings) > READINGS:
        damping -= float(factors[READINGS]) / now
    return LawOfReadings(
        -spring / step, damping, bool(abs(damping) * speed > VISIBLE * max(worst, lost))
    )
