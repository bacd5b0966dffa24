"""Timing of the forces on one body: the time by which each log lags the motion.

A force that is late by `shift` is corrected by f(t + shift) = f + shift df/dt + ..., so its
derivative is one more column of the balance. Each step moves the forces by the estimated shift; the
first steps use low frequencies only, where a period is long. If all forces share one shift, the log
of the motion is shifted instead.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..blocks import Body
from ..measurement.filtering import Array
from ..measurement.first_guess import hardly_varies
from ..measurement.motion import Motion
from ..measurement.prepare import Stretch
from ..realise.along_motion import residual_along

#: bandwidths, as parts of the comparison's bandwidth, at which shifts are fitted, one after another
BANDS = (0.125, 0.25, 0.5, 1.0, 1.0)
#: part of the measured force: if more is left unexplained, the fit also starts from other shifts,
#: up to LATE (s) to either side
STARTS_ANEW, LATE = 0.2, 0.06
#: shifts count only if they leave at most this part (REMAINS) of the unexplained force. One shift
#: alone counts if it explains at least this part (ALONE) of what all shifts explain
REMAINS, ALONE = 0.85, 0.8
#: a row counts if the low-passed share of samples in sure motion is above this
CLEAR_MOTION = 0.98
#: ratio of `phase_of_shift` above which a motion has one frequency: 0.9 for a sine on a real motor,
#: 0.4 for a motion of many frequencies
ONE_FREQUENCY = 0.7
#: shifts of forces that are in step with the motion, s
ON_TIME: Mapping[str, float] = {"actuator_force": 0.0, "interaction_force": 0.0}


@dataclass(frozen=True)
class BandTransforms:
    """One stretch in one band: transforms of both forces, and the other terms of the balance.

    forces: channel -> Fourier transform;  keep: the rows that count
    others: (1 + p, rows) low-passed: the rest of the model, and the columns of the p strengths
    """

    motion: Motion
    keep: NDArray[np.intp]
    forces: Mapping[str, NDArray[np.complex128]]
    others: Array


def transform_in_band(
    body: Body, stretch: Stretch, names: Sequence[str], band: float
) -> BandTransforms:
    """One stretch below `band` times the comparison's bandwidth.

    names: the strengths with columns
    """
    motion, s = stretch.motion, stretch.motion.spectrum
    along = residual_along(body, motion, names)
    columns = -along.residual.tangent
    values = np.array([body.parameters[n].value for n in names])
    acting = along.acting.value
    rest = acting + motion.interaction - along.residual.value - values @ columns
    moving = motion.lowpassed(np.abs(motion.direction).astype(np.float64))
    keep = stretch.keep[moving[stretch.keep] > CLEAR_MOTION]
    low = s.lowpass(band * motion.bandwidth)
    forces = {
        "actuator_force": s.transform(acting) * low,
        "interaction_force": s.transform(motion.interaction) * low,
    }
    return BandTransforms(
        motion, keep, forces, s.multiply(np.vstack([rest[None], columns]), low)[:, keep]
    )


def sum_of_forces(part: BandTransforms) -> BandTransforms:
    """The same with both forces as one, under either name."""
    whole = np.sum(list(part.forces.values()), axis=0)
    return replace(part, forces=dict.fromkeys(part.forces, whole))


def phase_of_shift(stretches: Sequence[Stretch], seconds: float) -> float:
    """Phase (rad) of a shift (s) for a motion of nearly one frequency; 0 for other motions.

    Velocity squared over position times acceleration, rms about their means: 1 for a sine.

    stretches: of one body
    """
    motions = [s.motion for s in stretches]
    position, velocity, acceleration = (
        float(np.sqrt(sum(np.sum((y - y.mean()) ** 2) for y in signals)))
        for signals in zip(
            *((m.position, m.velocity, m.acceleration) for m in motions), strict=True
        )
    )
    if not velocity**2 > ONE_FREQUENCY * position * acceleration:
        return 0.0
    return seconds * acceleration / velocity


def rows_of(parts: Sequence[BandTransforms], shifts: Mapping[str, float]) -> Array:
    """Acting force, interaction force, their derivatives, the rest and the columns, (5 + p, rows).

    shifts: channel -> s by which the force is late, corrected here
    """
    rows = []
    for part in parts:
        s = part.motion.spectrum
        both = [y * np.exp(2j * np.pi * s.frequency * shifts[n]) for n, y in part.forces.items()]
        signals = [s.back(y)[part.keep] for y in both]
        signals += [s.back(y * s.derivative(1))[part.keep] for y in both]
        rows.append(np.vstack([*signals, part.others]))
    return np.hstack(rows)


@dataclass(frozen=True)
class BalanceFit:
    """Time shifts of groups of forces after iteration, and the force balance at these shifts.

    solution: strengths, gain of the other force where there is one, last steps of the shifts
    rows: of `rows_of` at these shifts
    left: residual force (rows,);  jacobian: columns of the balance (rows, solution)
    """

    groups: Sequence[tuple[str, ...]]
    shifts: Mapping[str, float]
    rows: Array
    solution: Array
    jacobian: Array
    left: Array

    @property
    def size(self) -> float:
        """Rms of the residual force."""
        return float(np.sqrt(np.mean(self.left**2)))


def with_shifts(
    bands: Mapping[float, list[BandTransforms]],
    forces: Sequence[str],
    plain: BalanceFit,
    measured: float,
) -> BalanceFit:
    """The balance with the fewest shifts that explain the residual; `plain` where none does.

    A force that stays constant wherever the body moves has no shift: it tells nothing of its time.
    """
    each = [(f,) for f in forces if not _stays_constant(bands[1.0], f)]
    if not each:
        return plain
    free = _from_starts(bands, forces, each, measured)
    if free.size > REMAINS * plain.size:
        return plain
    alone = [*each, tuple(forces)] if len(each) > 1 else []
    single = [_from_starts(bands, forces, [g], measured) for g in alone]
    best = min(single, key=lambda s: s.size, default=free)
    explained = (plain.size**2 - best.size**2) / (plain.size**2 - free.size**2)
    return best if explained > ALONE else free


def _stays_constant(parts: Sequence[BandTransforms], force: str) -> bool:
    """Whether a force has one value in all rows that count, as a motor that spins up after a step.

    What its low-pass shows there is the step itself, which lies before the motion.
    """
    is_command = force == "actuator_force"
    rows = [(p.motion.command if is_command else p.motion.interaction)[p.keep] for p in parts]
    return hardly_varies(np.concatenate(rows))


def _from_starts(
    bands: Mapping[float, list[BandTransforms]],
    forces: Sequence[str],
    groups: Sequence[tuple[str, ...]],
    measured: float,
) -> BalanceFit:
    """The balance iterated from zero shifts, or from other starts where that leaves too much."""
    best = fit_balance(bands, forces, groups, ON_TIME)
    if best.size < STARTS_ANEW * measured:
        return best
    starts = [
        {**ON_TIME, **dict.fromkeys(g, t)}
        for g in {*groups, tuple(f for g in groups for f in g)}
        for t in (-LATE, -LATE / 2, LATE / 2, LATE)
    ]
    coarse = [fit_balance(bands, forces, groups, s, BANDS[:2]) for s in starts]
    start = min(coarse, key=lambda b: b.size).shifts
    return min(best, fit_balance(bands, forces, groups, start), key=lambda b: b.size)


def fit_balance(
    bands: Mapping[float, list[BandTransforms]],
    forces: Sequence[str],
    groups: Sequence[tuple[str, ...]],
    shifts: Mapping[str, float],
    steps: Sequence[float] = BANDS,
) -> BalanceFit:
    """The balance after one step of the shifts in each band, of at most an eighth of a second."""
    timing, gain = dict(shifts), 1.0
    for band in (*steps, steps[-1]):
        rows = rows_of(bands[band], timing)
        solution, jacobian, left = _solve(rows, forces, groups, gain)
        now = BalanceFit(groups, dict(timing), rows, solution, jacobian, left)
        if len(forces) > 1:
            gain = float(solution[len(rows) - 5])
        for group, step in zip(groups, solution[len(solution) - len(groups) :], strict=True):
            for name in group:
                timing[name] += float(np.clip(step, -0.125, 0.125))
    return now


def _solve(
    rows: Array, forces: Sequence[str], groups: Sequence[tuple[str, ...]], gain: float
) -> tuple[Array, Array, Array]:
    """Solution of the balance, its columns, and the residual.

    The solution has strengths, the gain of the other force, and steps of the shifts.
    gain: of the other force, from the step before
    """
    value = {"actuator_force": rows[0], "interaction_force": rows[1]}
    slope = {"actuator_force": rows[2], "interaction_force": rows[3]}
    weight = {n: 1.0 if n == forces[0] else gain for n in forces}
    columns = [*rows[5:], *(-value[n] for n in forces[1:])]
    columns += [-sum((weight[n] * slope[n] for n in g), np.zeros(rows.shape[1])) for g in groups]
    matrix = np.stack(columns, axis=1)
    size = np.linalg.norm(matrix, axis=0)
    size[size == 0.0] = 1.0
    target = value[forces[0]] - rows[4]
    solution = np.linalg.lstsq(matrix / size, target, rcond=1e-9)[0] / size
    return solution, matrix, target - matrix @ solution
