"""First values of a model from the record itself: inertia, friction and damping, by least squares.

    actuator force + interaction force = m a + c sgn(v) + b v + k

A start for a diagnosis, which estimates again with all that this leaves out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .filtering import spectrum
from .record import Record

Array = NDArray[np.float64]

#: Hz, part of the sample rate and bounds of the low-pass before the fit
_BAND = (0.02, 2.0, 40.0)
#: part of the largest speed below which the direction of motion is not counted as known
_SLOW = 0.02


@dataclass(frozen=True)
class FirstGuess:
    """SI values of inertia, friction level and damping; `explained`: part of the force (0 to 1).

    errors: standard errors of the three, each second of the record counted as one reading
    left: rms of what they leave of the low-passed force, in its unit
    """

    inertia: float
    level: float
    damping: float
    explained: float
    errors: tuple[float, float, float]
    left: float = 0.0


def motion_columns(position: Array, sample_time: float) -> tuple[Array, Array, Array]:
    """Low-passed velocity, acceleration and direction of a position (n,)."""
    band = min(max(_BAND[0] / sample_time, _BAND[1]), _BAND[2])
    s = spectrum(len(position), sample_time)
    low = s.lowpass(band)
    moved = s.transform(position) * low
    velocity, acceleration = s.back(moved * s.derivative(1)), s.back(moved * s.derivative(2))
    speed = np.abs(velocity)
    direction = np.where(speed > _SLOW * speed.max(initial=0.0), np.sign(velocity), 0.0)
    return velocity, acceleration, s.multiply(direction, low)


def explain_force(force: Array, position: Array, sample_time: float) -> FirstGuess:
    """How a force (n,) follows from the motion of a position (n,), by least squares."""
    return explain_forces([(force, position)], sample_time)


def explain_forces(pairs: Sequence[tuple[Array, Array]], sample_time: float) -> FirstGuess:
    """As `explain_force`, over several stretches (force, position)."""
    rows, targets = [], []
    trim = max(1, round(0.25 / sample_time))
    band = min(max(_BAND[0] / sample_time, _BAND[1]), _BAND[2])
    for force, position in pairs:
        if len(force) < 4 * trim:
            continue
        v, a, direction = motion_columns(position, sample_time)
        s = spectrum(len(force), sample_time)
        inner = slice(trim, -trim)
        rows.append(np.stack([a, direction, v, np.ones(len(v))])[:, inner])
        targets.append(s.multiply(force, s.lowpass(band))[inner])
    nothing = FirstGuess(0.0, 0.0, 0.0, 0.0, (np.inf, np.inf, np.inf))
    if not rows:
        return nothing
    columns, target = np.concatenate(rows, axis=1), np.concatenate(targets)
    with np.errstate(over="ignore", invalid="ignore"):
        scale = np.sqrt(np.mean(columns**2, axis=1))
        if not np.isfinite([*scale, np.mean(target**2)]).all():  # values beyond 1e150
            return nothing
    scale[scale == 0] = 1.0
    normal = columns / scale[:, None]
    solution, *_ = np.linalg.lstsq(normal.T, target, rcond=1e-8)
    left = target - normal.T @ solution
    whole = float(np.mean((target - target.mean()) ** 2))
    explained = 1.0 - float(np.mean(left**2)) / whole if whole > 0 else 0.0
    seconds = max(len(target) * sample_time, 1.0)
    covariance = np.linalg.pinv(normal @ normal.T / len(target)) * np.mean(left**2) / seconds
    errors = np.sqrt(np.abs(np.diag(covariance))) / scale
    m, c, b = (solution / scale)[:3].tolist()
    of_each = float(errors[0]), float(errors[1]), float(errors[2])
    return FirstGuess(m, c, b, explained, of_each, float(np.sqrt(np.mean(left**2))))


def guess_from(records: Sequence[Record], body: str) -> FirstGuess:
    """The first values of one body from its records."""
    pairs = []
    for record in records:
        force = record.signals[f"{body}.actuator_force"]
        other = record.signals.get(f"{body}.interaction_force")
        total = force if other is None else force + other
        pairs += [(total[s], record.signals[f"{body}.position"][s]) for s in record.segments]
    return explain_forces(pairs, records[0].sample_time)
