"""Readings: noise and step of an encoder, jitter of the sampling times, counts that hold a sign.

Drives report a two's complement of some bits, servos on a bus a size beside a bit for the sign. A
logger that reads either as a count writes no number below 0: 65315 for -221, or 1245 where bit 10
is the sign.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ExperimentError
from ..base.toml import Table
from .limits import HALF, NEARLY_ALL, SEVERAL

#: keys of a channel, one for each code
TWOS_COMPLEMENT, SIGN_BIT = "twos_complement", "sign_bit"
#: most bits of a whole number that float64 holds exactly
MOST_BITS = 53
#: least range of readings that are looked at
LEAST_RANGE = 2**7

Array = NDArray[np.float64]

#: steps that a column must span to show a grid, a law or a unit; and steps between two readings
#: whose number is certain from the smallest gap alone: it may be 1 % wrong if a log has few digits
FEWEST_STEPS = 20
#: part of the range of a column that sums of its numbers lose in floating point
LOST = 1e-9
#: smallest change from sample to sample that counts as motion, in steps between values
STEPS = 3.0
#: standard errors from which the sign of a value counts as known; three: wrong by chance once in
#: 700
SURELY = 3.0
#: most values that are evaluated
ENOUGH = 20_000
#: fewest changes of a reading that show a period: nearly all of them lie a whole number of periods
#: apart, while a slow body changes its reading at odd rows
CHANGES = 50
#: fewest changes of a force: a position at constant speed passes its steps in even time, a force
#: does not. Of 20 changes at random rows, 18 lie whole periods of two apart with a probability of
#: 0.0002
CHANGES_OF_FORCE = 20
#: samples of a piece for the comparison of scatter and speed, and fewest pieces
PIECE, PIECES = 64, 8
#: order of the difference that separates scatter from motion. Of a motion at a tenth of the sample
#: rate, the fourth difference leaves as much as a jitter of 2 % of a row, the eighth only 0.03 %
DIFFERENCE = 8
#: steps within which the readings of a body at rest lie: between two values, it shows both
AT_REST = 1.5


def is_most(mask: NDArray[np.bool_]) -> bool:
    """Whether more than half of some values are true."""
    return bool(len(mask) and np.mean(mask) > HALF)


def rests(position: Array, step: float) -> bool:
    """Whether readings of this step show no motion."""
    return float(np.ptp(position)) <= AT_REST * step


def reading_noise(position: Array) -> float:
    """Rms noise of one position reading, estimated from the content near the Nyquist frequency."""
    fourth = np.diff(position, 4)
    # the fourth difference amplifies white noise by sqrt(70); the median ignores sharp motion
    return float(np.median(np.abs(fourth)) / 0.6745 / np.sqrt(70.0))


def reading_step(position: Array) -> float:
    """Smallest step between neighbouring values of the readings: the encoder step, if any.

    In a motion that never returns to a place, the values lie apart by the travel per sample. Then
    the step is the one whose rounding error looks like the noise in the readings. Values that lie
    on a grid and come again are those of an encoder, though: a body that rests for half the time
    shows no noise.
    """
    values = np.unique(position)
    if len(values) < 2:
        return 0.0
    gaps = np.diff(values)
    step = float(np.quantile(gaps[gaps > LOST * np.ptp(values)], 0.002))
    rounding = float(np.sqrt(12.0)) * reading_noise(position)
    moving = is_most(np.diff(position) != 0)
    # a fourth difference of zero in most readings: no visible noise
    is_noisy = rounding > LOST * float(np.ptp(position))
    if not (is_noisy and moving and step > STEPS * rounding):
        return step
    if len(values) < NEARLY_ALL * len(position) and grid_of(position[:ENOUGH], step):
        return step
    return min(step, rounding)


def is_on_grid(x: Array, step: float) -> bool:
    """Whether readings (n,), of which `ENOUGH` are looked at, lie on a grid with any origin."""
    some = x[:: max(1, len(x) // ENOUGH)]
    return bool(np.abs(np.exp(2j * np.pi * (some - some[0]) / step).mean()) > NEARLY_ALL)


def grid_of(position: Array, step: float) -> float:
    """Step of the grid on which the readings lie, near `step`; 0 where there is no such grid."""
    if step <= 0.0 or np.ptp(position) <= FEWEST_STEPS * step:
        return 0.0
    mean = _fitted_step(position, step)
    return mean if is_on_grid(position, mean) else 0.0


def _fitted_step(position: Array, step: float) -> float:
    """Refine a step by values at increasing distances, to average out rounded digits.

    Neighbouring values give a first mean. This mean counts the steps to values twice as far away,
    and so on to the ends of the travel.
    """
    values = np.unique(position)
    gaps = np.diff(values)
    counts = np.round(gaps / step)
    near = (counts > 0) & (counts < FEWEST_STEPS)
    if near.any():
        step = float(gaps[near].sum() / counts[near].sum())
    away = values - values[len(values) // 2]
    reach, end = FEWEST_STEPS * step, float(np.abs(away).max())
    while True:
        inside = away[np.abs(away) <= reach]
        places = np.round(inside / step)
        if (squares := float(places @ places)) > 0.0:
            step = float(inside @ places) / squares
        if reach >= end:
            return step
        reach *= 2.0


def update_period(*stretches: Array, fewest: int = CHANGES) -> int:
    """Rows from one reading of a channel to the next: 1 unless each one is held for several rows.

    Nearly all changes then lie a whole number of periods apart.

    fewest: changes that show a period
    """
    apart = np.concatenate([np.diff(np.flatnonzero(np.diff(x))) for x in stretches])
    if len(apart) < fewest:
        return 1
    every = int(np.median(apart))
    return every if every > 1 and np.mean(apart % every == 0) >= NEARLY_ALL else 1


def sampling_jitter(x: Array, step: float, sample_time: float) -> float:
    """Rms error of the sampling times (s), from the growth of a position's scatter with its speed.

    The square of the scatter is that at rest, plus the square of the time error times the square of
    the speed. The slowest and the fastest quarter of the pieces are compared; 0 where the scatter
    does not grow with speed. Of readings that are held for several rows, one row each counts.
    """
    every = update_period(x)
    x, sample_time = x[::every], every * sample_time
    count = len(x) // PIECE
    if count < PIECES:
        return 0.0
    pieces = x[: count * PIECE].reshape(count, PIECE)
    scatter = np.sqrt(np.mean(np.diff(pieces, DIFFERENCE, axis=1) ** 2, axis=1))
    scatter /= math.sqrt(
        math.comb(2 * DIFFERENCE, DIFFERENCE)
    )  # gain of the difference for white noise
    # over several rows the motion is much larger than the scatter, which would choose the pieces
    moved = np.mean((pieces[:, DIFFERENCE:] - pieces[:, :-DIFFERENCE]) ** 2, axis=1)
    fast = moved >= np.quantile(moved, 0.75)
    slow = moved <= np.quantile(moved, 0.25)
    rest = max(0.29 * step, float(np.median(scatter[slow])))
    # less than twice the scatter at rest may be rounding alone
    if np.median(scatter[fast]) < 2.0 * rest:
        return 0.0
    # readings next to each other differ by their scatter too, not by the motion alone
    steps = np.mean(np.diff(pieces, axis=1) ** 2, axis=1) - 2.0 * scatter**2
    squares = (np.median(steps[fast]) - np.median(steps[slow])) / sample_time**2
    more = np.median(scatter[fast] ** 2) - rest**2
    return float(np.sqrt(more / squares)) if more > 0.0 and squares > 0.0 else 0.0


@dataclass(frozen=True)
class SignCode:
    """How a column holds signed numbers.

    key: "twos_complement" or "sign_bit"
    bits: number of bits of the two's complement, or number of the bit that is the sign
    """

    key: str
    bits: int

    @property
    def end(self) -> float:
        """The first count that is no number in this code."""
        return 2.0 ** (self.bits + (self.key == SIGN_BIT))

    def decode(self, counts: Array) -> Array:
        """The numbers (n,) of counts (n,); a count below half of `end` is itself."""
        negative = 0.5 * self.end - counts if self.key == SIGN_BIT else counts - self.end
        return np.where(counts >= HALF * self.end, negative, counts)

    def refuse_other_counts(self, counts: Array, where: str) -> None:
        """Raise an ExperimentError for a reading that is no count of this code."""
        largest = float(np.max(counts, initial=-np.inf, where=np.isfinite(counts)))
        if largest >= self.end:
            raise ExperimentError(
                f"{where}: found a reading of {largest:g}, expected less than {self.end:g} with "
                f"{self.key} = {self.bits}"
            )


def sign_code_from(table: Table) -> SignCode | None:
    """The code that a channel's table states; raises ExperimentError: both codes, or no bit."""
    stated = [key for key in (TWOS_COMPLEMENT, SIGN_BIT) if key in table.content]
    if not stated:
        return None
    if len(stated) == 2:
        raise table.error(stated[0], "one", f"beside {stated[1]}")
    bits = table.number(stated[0])
    least = 2 if stated[0] == TWOS_COMPLEMENT else 1
    if bits != int(bits) or not least <= bits <= MOST_BITS - 1:
        raise ExperimentError(
            f"{table.where(stated[0])}: found {bits:g}, expected a whole number from {least} to "
            f"{MOST_BITS - 1}"
        )
    return SignCode(stated[0], int(bits))


def sign_code_of(readings: Array) -> SignCode | None:
    """The code of a column of counts that change far less if read with a sign; None: there is none.

    The highest bit is then the sign, and both signs occur with several values.
    """
    counts = readings[np.isfinite(readings)]
    if not len(counts) or counts.min() < 0 or not LEAST_RANGE <= counts.max() < 2.0**MOST_BITS / 2:
        return None
    if not np.array_equal(counts, np.round(counts)):
        return None
    bit = int(np.floor(np.log2(counts.max())))
    codes = (SignCode(SIGN_BIT, bit), SignCode(TWOS_COMPLEMENT, bit + 1))
    changes = {code: _changes(code.decode(counts)) for code in codes}
    best = min(codes, key=lambda code: changes[code])
    if changes[best] >= HALF * _changes(counts):
        return None
    numbers = best.decode(counts)
    of_sign = [np.unique(numbers[sign * numbers > 0]) for sign in (1, -1)]
    # a command that is on or off has two values, and may be 0 and 200 by choice
    return best if min(map(len, of_sign)) >= SEVERAL else None


def _changes(numbers: Array) -> float:
    return float(np.sum(np.abs(np.diff(numbers))))
