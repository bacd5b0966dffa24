"""A command that a digital controller computes from the readings of the position, row by row.

    u_k = c + sum of b_i x_(k-i), i = 0..3, + d w_k + sum of a_j u_(k-j), j = 1..2

x: readings of the position;  w: of the velocity, where it is logged
Past readings make a damper by differences, past commands the filter of the derivative. A smooth
machine is nearly linear in past rows, too. So two things are required. The law leaves no more than
the rounding of the command on each row, where the past commands are the law's own. And one step of
a reading moves the command by a multiple of what is left: no machine answers the rounding of a
reading, which only a controller receives.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .encoder import ENOUGH, FEWEST_STEPS, LOST, grid_of, reading_step
from .filtering import Array
from .limits import NEARLY_ALL
from .repeated_rows import runs_of

#: (readings of the position, past commands) of the laws, the simpler one first: spring, damper of
#: one difference, of several, with a filter of first and of second order
ORDERS = ((1, 0), (2, 0), (4, 0), (4, 1), (4, 2))
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
#: rows of a run without a clipped command, and memories of the filter after which a run counts: a
#: set point that varies would be a filter whose memory does not fade
SHORTEST_RUN, MEMORIES = 16, 3.0


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


@dataclass(frozen=True, eq=False)
class _Rows:
    """Rows of a log. x: steps of the position;  w: velocity, or None;  free: rows that count."""

    u: Array
    x: Array
    w: Array | None
    segments: tuple[slice, ...]
    free: NDArray[np.bool_]

    def runs(self, taps: int, past: int) -> Iterator[slice]:
        """Rows in a line that a law can predict, with as many rows before them as it reads."""
        shortest, count = SHORTEST_RUN if past else 1, 0
        for segment in self.segments:
            for begin, end in zip(*runs_of(self.free[segment]), strict=True):
                first = segment.start + max(begin + past, taps - 1)
                last = min(segment.start + end, first + ENOUGH - count)
                if last - first >= shortest:
                    count += last - first
                    yield slice(first, last)

    def columns(self, run: slice, taps: int) -> Array:
        """Readings of the rows of a run and a constant, (n, taps + 1), or with the velocity."""
        readings = [self.x[run.start - i : run.stop - i] for i in range(taps)]
        readings += [] if self.w is None else [self.w[run]]
        return np.column_stack([*readings, np.ones(run.stop - run.start)])

    def all_columns(self, run: slice, taps: int, past: int) -> Array:
        """`columns`, and the commands of the rows before, (n, m + past)."""
        before = [self.u[run.start - j : run.stop - j] for j in range(1, past + 1)]
        return np.column_stack([self.columns(run, taps), *before])


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
    for free in (command != rest, command > rest, command < rest):
        counted = inside & free
        rows = _Rows(command, x - x.mean(), velocity, tuple(segments), counted)
        for taps, past in ORDERS:
            law = _law_of_order(rows, taps, past, step=step, sample_time=sample_time)
            if law is not None:
                return replace(law, is_partial=bool(np.mean(counted) < NEARLY_ALL))
    return None


def _law_of_order(
    rows: _Rows, taps: int, past: int, *, step: float, sample_time: float
) -> LawOfReadings | None:
    """The law with so many readings and past commands; None where it is not exact."""
    runs = list(rows.runs(taps, past))
    numbers = taps + (rows.w is not None) + 1 + past
    changes = sum(int(np.count_nonzero(np.diff(rows.x[run]))) for run in runs)
    if changes < FOR_EACH * numbers:
        return None
    columns = np.vstack([rows.all_columns(run, taps, past) for run in runs])
    command = np.concatenate([rows.u[run] for run in runs])
    factors = _least_squares(columns, command)
    forward, back = np.split(factors, [len(factors) - past])
    if not _fades(runs, back, FOR_EACH * numbers):
        return None
    errors = np.concatenate([rows.u[run] - _follow(rows, run, forward, back) for run in runs])
    worst = float(np.abs(errors).max())
    lost = DIGITS * float(np.ptp(rows.u))
    # of a law that is exact up to the rounding of the command
    exact = ROUNDED * reading_step(rows.u) * (1.0 + float(np.abs(back).sum())) + lost
    if worst > exact or np.abs(forward[:taps]).max() < VISIBLE * max(worst, lost):
        return None
    spring, damper = _in_slow_motion(forward, back, taps)
    of_speed, is_damped = 0.0, taps + past > 1
    if rows.w is not None:
        of_speed = float(forward[taps]) / (1.0 - float(back.sum()))
        part = abs(of_speed) * float(np.ptp(rows.w))
        is_damped = is_damped or part > VISIBLE * max(worst, lost)
    return LawOfReadings(-spring / step, -damper * sample_time / step - of_speed, is_damped)


def _least_squares(columns: Array, values: Array) -> Array:
    """Factors of columns (n, m) that explain values (n,) best, of columns of any size."""
    sizes = np.maximum(np.abs(columns).max(axis=0), 1e-300)
    solution = np.linalg.lstsq(columns / sizes, values, rcond=None)[0]
    factors: Array = solution / sizes
    return factors


def _follow(rows: _Rows, run: slice, forward: Array, back: Array) -> Array:
    """Commands (n,) of a law along a run, from its own past commands."""
    past = len(back)
    driven = rows.columns(run, len(forward) - 1 - (rows.w is not None)) @ forward
    if not past:
        return np.asarray(driven)
    from scipy.signal import lfilter, lfiltic

    poles = np.concatenate([[1.0], -back])
    before = lfiltic([1.0], poles, rows.u[run.start - past : run.start][::-1])
    return np.asarray(lfilter([1.0], poles, driven, zi=before)[0])


def _fades(runs: Sequence[slice], back: Array, fewest: int) -> bool:
    """Whether enough rows lie so late in their runs that the filter has forgotten the first ones.

    A set point that varies would be the memory of a filter that does not fade.
    """
    size = float(np.abs(np.roots(np.concatenate([[1.0], -back]))).max()) if len(back) else 0.0
    if size >= 1.0:  # it never does, as a wave of one frequency
        return False
    wait = MEMORIES / (1.0 - size) if len(back) else 0.0
    return bool(sum(max(0.0, run.stop - run.start - wait) for run in runs) >= fewest)


def _in_slow_motion(forward: Array, back: Array, taps: int) -> tuple[float, float]:
    """Spring and damper of a law, per step and row: its response to z = exp(s), to first order."""
    now = 1.0 - float(back.sum())
    spring = float(forward[:taps].sum()) / now
    lag = float(np.arange(taps) @ forward[:taps])
    lag += spring * float(np.arange(1, len(back) + 1) @ back)  # 0 without past commands
    return spring, -lag / now
