"""Repeatability: by how much the residual differs where a body makes the same motion again.

A force that follows from the motion is the same again when the motion and its past are the same.
So the part of a residual that differs from pass to pass is no force of the motion: it is noise, a
change with time, or something that was not measured, and no effect of the motion explains it. Half
of the squares of the difference of two passes are those of one pass. The rest of the residual
repeats: there something is missing from the model, even if no candidate describes it.

Residuals are compared, not forces: the model takes out what small differences of the two motions
change. What the model lacks changes with the place, so two motions are the same only if one is
ahead of the other by no more than the bandwidth resolves. Where a force that changes suddenly is
missing, such as at the end of a gap, differences still count as not repeated.

In two short passes, noise is alike by chance. How much is seen from the differences of the passes
themselves: their squares, and how long they stay alike.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ..base.codec import Size
from ..base.sentences import percent
from ..measurement.filtering import Array
from ..measurement.motion import Motion
from ..measurement.prepare import Prepared, Stretch, measured_force
from ..measurement.reversals import count_reversals
from ..model import Model
from .criteria import CRITERIA
from .residual import residuals


@dataclass(frozen=True)
class Repeatability:
    """Relative force errors on the rows whose motion is repeated, and their share of all rows.

    error: part of the force that differs from one pass to another (rms of one pass)
    left: error of the model on the same rows
    share: part of the rows of all records, 0 to 1
    squares: part of all squares that the model leaves, on the same rows, 0 to 1
    chance: relative force error that seems to repeat by chance, if all of `left` is noise
    """

    error: Size
    left: Size
    share: Size
    squares: Size
    chance: Size

    @property
    def repeating(self) -> float:
        """Part of the model's error that is the same on each pass; 0 where this may be chance."""
        same = float(np.sqrt(max(self.left**2 - self.error**2, 0.0)))
        return same if same > self.chance else 0.0

    def __str__(self) -> str:
        error, left, same = (percent(e, ".2g") for e in (self.error, self.left, self.repeating))
        same = f"{same} repeats" if self.repeating else "none surely repeats"
        return (
            f"{error} of the force differs from pass to pass over the same motion "
            f"({percent(self.share, '.0f')} of the rows); of {left} left there, {same}"
        )


@dataclass(frozen=True, eq=False)
class _Course:
    """Motion, residual and force of a stretch on the rows that count, which are evenly spaced.

    body: its name, with the spacing of the rows (s): only courses that share both are compared
    signals: positions and velocities (2 k, rows), of the body and of the joints beside it
    weight: number of rows of the record that each row stands for
    length: rows of a pass
    resolved: s by which one motion may be ahead of another that is the same
    hand: low-passed interaction force that was measured; zero where none was
    further: (m, rows), other signals on which effects depend, over their largest values
    """

    body: tuple[str, float]
    signals: Array
    residual: Array
    force: Array
    weight: float
    length: int
    resolved: float
    hand: Array
    further: Array


def repeatability(
    model: Model, prepared: Prepared, *, beside: Sequence[Sequence[Motion]] = ()
) -> Repeatability | None:
    """How far the residual of a model repeats; None where too little of a motion is repeated.

    beside: of each stretch, the motions of an arm's other joints: they must repeat as well
    """
    courses = list(_list_courses(model, prepared, beside))
    if not all(np.all(np.isfinite(course.residual)) for course in courses):
        return None  # a hidden body ran away
    squares = np.zeros(3)
    compared = whole = every = left_there = by_chance = 0.0
    for course in courses:
        alike = [other for other in courses if other.body == course.body]
        covered = np.zeros(len(course.force), dtype=bool)
        for first in _list_starts(len(course.force), course.length):
            here = slice(first, first + course.length)
            residual, force = course.residual[here], course.force[here]
            passes = [other.residual[there] for other, there in _find_again(course, here, alike)]
            if not passes:
                continue
            between = [residual - again for again in passes]
            apart = np.mean([d @ d for d in between])
            squares += course.weight * np.array([apart, residual @ residual, force @ force])
            # of one other pass: the mean over all passes counts
            alone = _alike_by_chance(between[0] / np.sqrt(2.0))
            by_chance += 2.0 * course.weight**2 * alone / len(passes)
            covered[here] = True
        every += course.weight * float(course.residual @ course.residual)
        left_there += course.weight * float(np.sum(course.residual[covered] ** 2))
        whole += course.weight * len(covered)
        compared += course.weight * float(covered.sum())
    if not (whole and compared > CRITERIA.passed_again * whole and squares[2] > 0.0):
        return None
    error, left = np.sqrt(squares[:2] / squares[2] / (2.0, 1.0))
    if not (np.isfinite(error) and np.isfinite(left)):
        return None
    # were all that is left noise, as much more of it is alike as it is larger than what differs
    deviation = np.sqrt(by_chance) / (0.5 * squares[0]) if squares[0] > 0.0 else 0.0
    chance = left * np.sqrt(CRITERIA.interval * deviation)
    part = left_there / every if every > 0.0 else 1.0
    return Repeatability(float(error), float(left), compared / whole, part, float(chance))


def _alike_by_chance(noise: Array) -> float:
    """Variance of the product of two passes (rows,) of such a noise, which are independent.

    Lags up to a quarter of a pass count: at longer ones, chance is larger than what is alike.
    """
    from scipy.signal import correlate

    rows = len(noise)
    lags = correlate(noise, noise)[rows - 1 : rows + rows // 4]
    return float((2.0 * lags @ lags - lags[0] ** 2) / rows)


def _list_courses(
    model: Model, prepared: Prepared, beside: Sequence[Sequence[Motion]]
) -> Iterator[_Course]:
    stretches = prepared.stretches
    left = [residual for residual, _ in residuals(model, stretches)]
    for i, (s, residual) in enumerate(zip(stretches, left, strict=True)):
        strides = np.unique(np.diff(s.keep))
        if len(strides) != 1:
            continue
        spacing = float(strides[0]) * s.motion.sample_time
        motions = (s.motion, *(beside[i] if beside else ()))
        signals = np.array([x[s.keep] for m in motions for x in (m.position, m.velocity)])
        seconds = max(CRITERIA.pass_periods / prepared.bandwidth, _cycle(s))
        length = int(min(seconds / spacing, len(s.keep) // 2))
        if length < 2:
            continue
        # as many digits as a clock has: spacings that agree to rounding are the same
        body = (s.motion.body, float(f"{spacing:.9g}"))
        yield _Course(
            body,
            signals,
            residual,
            measured_force(s),
            s.weight,
            length,
            resolved=CRITERIA.ahead / prepared.bandwidth,
            hand=s.motion.lowpassed(s.motion.interaction, s.keep),
            further=_further(s, stretches),
        )


def _further(stretch: Stretch, stretches: Sequence[Stretch]) -> Array:
    """The further signals on the rows that count, over their largest values in all stretches."""
    mine = stretch.motion.further
    rows = np.zeros((len(mine), len(stretch.keep)))
    for i, name in enumerate(sorted(mine)):
        every = (s.motion.further[name] for s in stretches if name in s.motion.further)
        largest = max(float(np.max(np.abs(x))) for x in every)
        rows[i] = mine[name][stretch.keep] / (largest or 1.0)
    return rows


def _cycle(stretch: Stretch) -> float:
    """Mean time (s) from one reversal to the next in the same direction; inf: no such time."""
    reversals = count_reversals(stretch.motion.direction)
    seconds = len(stretch.motion.time) * stretch.motion.sample_time
    return 2.0 * seconds / reversals if reversals else float("inf")


def _list_starts(rows: int, length: int) -> list[int]:
    """First rows of passes that cover all rows, each of them at most twice."""
    count = -(-rows // length)
    return [round(k) for k in np.linspace(0, rows - length, count)]


def _find_again(
    course: _Course, here: slice, others: Sequence[_Course]
) -> Iterator[tuple[_Course, slice]]:
    """Each course and its rows that repeat the motion of these rows, where they do it best.

    Rows that overlap with the pass itself do not count, nor does a pass with another force of the
    hand, because then the actuator's force is another one, too, and so is all that it loses on
    its way, or with another temperature or motion beside the body.
    """
    for other in others:
        if other.signals.shape[1] < course.length:
            continue
        apart = _differences(course.signals[:, here], other.signals, course.resolved)
        if other is course:
            apart[max(here.start - course.length + 1, 0) : here.stop] = np.inf
        alike = np.flatnonzero(apart < CRITERIA.one_motion**2)
        for near in np.split(alike, 1 + np.flatnonzero(np.diff(alike) > 1)):
            if len(near):
                first = int(near[np.argmin(apart[near])])
                there = slice(first, first + course.length)
                if _acts_alike(course, here, other, there):
                    yield other, there


def _acts_alike(course: _Course, here: slice, other: _Course, there: slice) -> bool:
    """Whether the hand and the further signals of two passes of one motion are the same, too."""
    hands, forces = course.hand[here] - other.hand[there], course.force[here]
    if hands @ hands > CRITERIA.one_motion**2 * (forces @ forces):
        return False
    if len(course.further) != len(other.further):
        return False
    apart = np.mean((course.further[:, here] - other.further[:, there]) ** 2, axis=1)
    return bool(np.all(apart <= CRITERIA.one_motion**2))


def _differences(signals: Array, others: Array, resolved: float) -> Array:
    """Mean square difference of a pass and each place of a course, over the pass's motion.

    signals: (2 k, length), positions and velocities in turn;  others: (2 k, rows)
    resolved: s; inf where a pass is ahead by more, in the mean (rms)
    returns: (rows - length + 1,); inf where a signal of the pass does not change
    """
    from scipy.signal import correlate

    length = signals.shape[1]
    apart = np.zeros(others.shape[1] - length + 1)
    for i, (mine, theirs) in enumerate(zip(signals, others, strict=True)):
        mean = float(mine.mean())
        here, size = mine - mean, mine if i % 2 else mine - mean
        # places far away are never alike, and their squares would hide the differences of others
        far = 3.0 * float(np.max(np.abs(size)))
        there = np.clip(theirs - mean, -far, far)
        sums = np.concatenate([[0.0], np.cumsum(there**2)])
        crossed = correlate(there, here, mode="valid", method="fft")
        squares = here @ here + sums[length:] - sums[:-length] - 2.0 * crossed
        if not size @ size > 0.0:
            return np.full_like(apart, np.inf)
        apart += np.maximum(squares, 0.0) / (size @ size)
        if i % 2 == 0:
            apart[squares > resolved**2 * float(signals[i + 1] @ signals[i + 1])] = np.inf
    return apart / len(signals)
