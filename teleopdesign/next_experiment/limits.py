"""Limits within which a motion is known to be safe: those that the records have shown.

A proposal exceeds them only if the user states other `Limits`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from ..base.errors import ModelError, unknown
from ..measurement.prepare import Prepared, Stretch

#: part of the samples that may exceed a limit that is read from a record: single samples are noise
OUTLYING = 1e-3


@dataclass(frozen=True)
class Limits:
    """Limits of one body (SI).

    low, high: ends of the stroke
    speed, acceleration, jerk, force: largest magnitudes; force is that of the command
    raises ModelError: high is not above low, or a magnitude is not positive
    """

    low: float
    high: float
    speed: float
    acceleration: float
    jerk: float
    force: float

    def __post_init__(self) -> None:
        if not self.high > self.low:
            raise ModelError(
                f"limits: the stroke ends at {self.high:g}, expected more than {self.low:g}"
            )
        for name in ("speed", "acceleration", "jerk", "force"):
            if not getattr(self, name) > 0:
                raise ModelError(f"limits: {name} is {getattr(self, name):g}, expected more than 0")

    def with_values(self, **values: float) -> Limits:
        """The limits with other values by name; raises ModelError: there is no such limit."""
        known = [f.name for f in fields(self)]
        for name in values:
            if name not in known:
                raise ModelError(f"limits: {unknown('limit', name, known)}")
        return replace(self, **values)

    def widen(self, factor: float) -> Limits:
        """All limits times a factor above 0; the stroke grows about its middle."""
        middle, half = 0.5 * (self.low + self.high), 0.5 * factor * (self.high - self.low)
        return Limits(
            middle - half,
            middle + half,
            factor * self.speed,
            factor * self.acceleration,
            factor * self.jerk,
            factor * self.force,
        )


def shown_limits(prepared: Prepared) -> dict[str, Limits]:
    """Body -> limits of a motion that the records of this body have shown to be safe.

    Records with a separate encoder zero do not share a stroke with others: their strokes count only
    where there are no other records.
    """
    bodies = dict.fromkeys(s.motion.body for s in prepared.stretches)
    return {
        b: _limits_of_records([s for s in prepared.stretches if s.motion.body == b]) for b in bodies
    }


def _limits_of_records(stretches: Sequence[Stretch]) -> Limits:
    common = [s for s in stretches if not s.has_zero_offset] or [stretches[0]]
    accelerations = [s.motion.lowpassed(s.motion.acceleration)[_inner_rows(s)] for s in stretches]
    jerks = [
        np.diff(a) / s.motion.sample_time for a, s in zip(accelerations, stretches, strict=True)
    ]
    return Limits(
        low=min(float(s.motion.position.min()) for s in common),
        high=max(float(s.motion.position.max()) for s in common),
        speed=_largest([s.motion.velocity[_inner_rows(s)] for s in stretches]),
        acceleration=_largest(accelerations),
        jerk=_largest(jerks),
        force=_largest_force(stretches),
    )


def _largest_force(stretches: Sequence[Stretch]) -> float:
    """The largest command; where the motor was off, the largest force of the hand."""
    commands, hands = (
        [getattr(s.motion, f) for s in stretches] for f in ("command", "interaction")
    )
    return max(float(np.abs(x).max()) for x in (commands if any(map(np.any, commands)) else hands))


def _inner_rows(stretch: Stretch) -> slice:
    """The rows with known derivatives: the ends of each record are left out."""
    return slice(int(stretch.keep[0]), int(stretch.keep[-1]) + 1)


def _largest(parts: Sequence[np.ndarray]) -> float:
    return float(np.quantile(np.abs(np.concatenate(parts)), 1.0 - OUTLYING))


@dataclass(frozen=True)
class BodyPaths:
    """How one path moves every body: position = middle + gain times the path (SI of the first).

    limits: of the path itself: low = -high, and the tightest values of all bodies
    """

    middle: Mapping[str, float]
    gain: Mapping[str, float]
    limits: Limits


def course_of(limits: Mapping[str, Limits], prepared: Prepared) -> BodyPaths:
    """One path for all bodies: coupled bodies keep their ratio, others use their whole strokes."""
    first = next(iter(limits))
    gain = {b: _ratio(first, b, limits, prepared) for b in limits}
    middle = {b: 0.5 * (limit.low + limit.high) for b, limit in limits.items()}

    def tightest(name: str) -> float:
        return min(float(getattr(limit, name)) / abs(gain[b]) for b, limit in limits.items())

    half = min(0.5 * (limit.high - limit.low) / abs(gain[b]) for b, limit in limits.items())
    bounds = {name: tightest(name) for name in ("speed", "acceleration", "jerk")}
    # each body is held to its force when the force is known
    return BodyPaths(middle, gain, Limits(-half, half, **bounds, force=limits[first].force))


#: correlation of two bodies' positions from which they count as coupled
COUPLED = 0.9


def _ratio(first: str, body: str, limits: Mapping[str, Limits], prepared: Prepared) -> float:
    if body == first:
        return 1.0
    one, other = (
        [
            s.motion.position - s.motion.position.mean()
            for s in prepared.stretches
            if s.motion.body == b
        ]
        for b in (first, body)
    )
    x, y = np.concatenate(one), np.concatenate(other)
    if len(x) == len(y) and float(np.corrcoef(x, y)[0, 1]) > COUPLED:
        return float(x @ y / (x @ x))
    strokes = [limits[b].high - limits[b].low for b in (first, body)]
    return strokes[1] / strokes[0]
