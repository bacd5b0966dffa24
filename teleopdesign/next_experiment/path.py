"""Smooth paths within limits: positions over time that a servo can follow.

A path is a polyline of moves at constant speed and holds, smoothed by a raised-cosine window. The
window's length follows from the limits: for a range R of speeds,

    acceleration <= 2 R / T,   jerk <= 4 pi R / T^2

for a window of length T and any line.

How a servo follows a reference against friction: with play, and with a delay.

A servo acts like a spring. After a reversal its force must change by twice the friction before the
body moves. So the body follows the reference with a play, whose width the records show: the travel
of the reference while the servo's force reverses.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..measurement.filtering import Array
from ..measurement.motion import play
from ..measurement.prepare import Stretch
from ..model import Model
from ..realise.along_motion import residual_along
from .limits import Limits

#: s: rest at each end of a part
REST = 0.3


@dataclass(frozen=True)
class Move:
    """A move to a position at a constant speed."""

    to: float
    speed: float


@dataclass(frozen=True)
class Hold:
    """A rest for some time (s)."""

    time: float


def travel(legs: Sequence[Move | Hold], limits: Limits, *, sample_time: float) -> Array:
    """The smoothed line through these legs, from rest at 0 to rest at the end of the last leg.

    sample_time: s
    returns: positions, shape (n,), one per sample
    """
    times, places, lowest, highest = [0.0], [0.0], 0.0, 0.0
    for leg in legs:
        if isinstance(leg, Hold):
            times.append(times[-1] + leg.time)
            places.append(places[-1])
            continue
        distance = leg.to - places[-1]
        if distance == 0.0:
            continue
        times.append(times[-1] + abs(distance) / leg.speed)
        places.append(leg.to)
        lowest = min(lowest, leg.speed * np.sign(distance))
        highest = max(highest, leg.speed * np.sign(distance))
    width = window_length(highest - lowest, limits)
    margin = REST + 0.5 * width
    t = np.arange(0.0, times[-1] + 2 * margin, sample_time) - margin
    return round_corners(np.interp(t, times, places), width, sample_time)


def window_length(range_of_speed: float, limits: Limits) -> float:
    """Length (s) of the raised cosine that keeps acceleration and jerk within the limits."""
    return max(
        2.0 * range_of_speed / limits.acceleration,
        float(np.sqrt(4.0 * np.pi * range_of_speed / limits.jerk)),
    )


def round_corners(line: Array, width: float, sample_time: float) -> Array:
    """The line after a raised-cosine window of length `width` (s); its ends do not change."""
    samples = max(3, 2 * round(0.5 * width / sample_time) + 1)
    window = np.hanning(samples + 2)[1:-1]
    half = samples // 2
    padded = np.concatenate([np.full(half, line[0]), line, np.full(half, line[-1])])
    return np.asarray(np.convolve(padded, window / window.sum(), mode="valid"))


def sines(
    frequencies: Array, duration: float, limits: Limits, *, share: float, sample_time: float
) -> Array:
    """Sum of sines in a smooth window, as large as the limits allow times `share`.

    frequencies: Hz, shape (k,). Amplitudes fall so that none dominates the acceleration; phases are
        Schroeder's (a low peak for the power)
    """
    t = np.arange(0.0, duration, sample_time)
    k = np.arange(len(frequencies))
    corner = float(np.sqrt(frequencies[0] * frequencies[-1]))
    amplitude = 1.0 / (1.0 + (frequencies / corner) ** 2)
    phase = -np.pi * k * (k + 1) / len(frequencies)
    y = amplitude @ np.sin(2 * np.pi * np.outer(frequencies, t) + phase[:, None])
    y = with_window(y, ramp=min(0.5, 0.2 * duration), sample_time=sample_time)
    return share * y * largest_factor(y, limits, sample_time=sample_time)


def with_window(y: Array, *, ramp: float, sample_time: float) -> Array:
    """The signal with a smooth start and end of length `ramp` (s), and a rest before and after."""
    t = np.arange(len(y)) * sample_time
    rise = np.clip(np.minimum(t, t[-1] - t) / ramp, 0.0, 1.0)
    rest = np.zeros(round(REST / sample_time))
    # sixth order at both ends: no jump of jerk
    return np.concatenate(
        [rest, y * rise**4 * (35 - 84 * rise + 70 * rise**2 - 20 * rise**3), rest]
    )


def largest_factor(y: Array, limits: Limits, *, sample_time: float) -> float:
    """The largest factor by which a path keeps its limits (stroke, speed, acceleration, jerk)."""
    peaks = [y]
    for _ in range(3):
        peaks.append(np.gradient(peaks[-1], sample_time))
    bounds = (limits.high, limits.speed, limits.acceleration, limits.jerk)
    return min(
        bound / max(float(np.abs(p).max()), 1e-300) for bound, p in zip(bounds, peaks, strict=True)
    )


#: part of the samples that may exceed the rate of the force that is read from a record: single ones
#: are noise
OUTLYING = 1e-3
#: s: longest time in which the force reverses; a longer one means that the servo was hardly driven
LONGEST = 0.1
#: speed over the largest speed, above which a path counts as moving
MOVING = 1e-4


@dataclass(frozen=True)
class Servo:
    """A servo as it follows a reference against friction.

    turn: s in which its force reverses friction;  play: width of the play (m, rad)
    """

    turn: float = 0.0
    play: float = 0.0


@dataclass(frozen=True)
class FollowedPath:
    """The path of a body behind a reference, (n,), and rows [from, to] where the body sticks."""

    path: Array
    stuck: tuple[tuple[int, int], ...]


def servo_of(model: Model, stretches: Sequence[Stretch], body: str) -> Servo:
    """The servo that the records of a body show, with a model of its friction.

    After a reversal the distance of the reference grows with t^2, and so does a spring-like force:
    it changes fastest at the end, at twice its mean rate.
    returns: no play where the records have no motion or no force
    """
    levels, rates, accelerations = [], [], []
    for motion in (s.motion for s in stretches if s.motion.body == body):
        friction = residual_along(model.body(body), motion).friction.value
        levels.append(np.abs(friction[motion.direction != 0]))
        force = motion.lowpassed(motion.at_rows(motion.command))
        rates.append(np.abs(np.diff(force)) / motion.sample_time)
        accelerations.append(motion.lowpassed(motion.acceleration))
    level = np.concatenate(levels)
    rate = float(np.quantile(np.concatenate(rates), 1.0 - OUTLYING))
    if not len(level) or rate <= 0.0:
        return Servo()
    time = min(2.0 * 2.0 * float(np.median(level)) / rate, LONGEST)
    typical = float(np.sqrt(np.mean(np.concatenate(accelerations) ** 2)))
    return Servo(time, 0.5 * typical * time**2)


def follow_path(path: Array, servo: Servo, *, sample_time: float) -> FollowedPath:
    """The path (n,) of a body behind this reference (n,)."""
    length = round(2.0 * servo.turn / sample_time)
    if length < 2 or servo.play <= 0.0:
        return FollowedPath(path, ())
    behind = play(path, servo.play)
    stuck = _sticking_rows(path, behind)
    followed = behind.copy()
    ends = [first for first, _ in stuck[1:]] + [len(path)]
    for (_, last), end in zip(stuck, ends, strict=True):
        # from rest at once to the reference's speed is more than a servo can: it catches up
        rows = slice(last, min(last + length, end))
        s = np.linspace(0.0, 1.0, rows.stop - rows.start)
        share = s**3 * (10 - 15 * s + 6 * s**2)
        followed[rows] = behind[last] + (behind[rows] - behind[last]) * share
    return FollowedPath(followed, stuck)


def _sticking_rows(path: Array, behind: Array) -> tuple[tuple[int, int], ...]:
    """Ranges of rows in which the reference moves and the body does not."""
    speed = np.abs(np.diff(path))
    stuck = (np.diff(behind) == 0.0) & (speed > MOVING * speed.max())
    edges = np.flatnonzero(np.diff(np.concatenate([[0], stuck.astype(int), [0]])))
    return tuple((int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True))


def with_ramps(force: Array, stuck: Sequence[tuple[int, int]]) -> Array:
    """The force (n,) with a smooth change over each of these ranges of rows."""
    force = force.copy()
    for first, last in stuck:
        # friction has turned round a row or two after the body has set out
        after = min(last + 2, len(force) - 1)
        share = 0.5 - 0.5 * np.cos(np.pi * np.arange(after - first + 1) / (after - first))
        force[first : after + 1] = force[first] + share * (force[after] - force[first])
    return force
