"""How a servo follows a reference against friction: like a play, and not at once.

A servo pulls like a spring. After a reversal it has to turn its force round by twice the friction
before the body moves, so the body lies behind the reference by a play whose width the records show:
the reference covers it while the servo's force turns round.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..diagnose.prepare import Stretch
from ..measurement.filtering import Array
from ..measurement.motion import play
from ..model import Model
from ..realise.along_motion import residual_along

#: part of the samples that may exceed the rate of the force that is read from a record: single ones
#: are noise
OUTLYING = 1e-3
#: s: longest time in which the force reverses; a longer one means that the servo was hardly driven
LONGEST = 0.1
#: speed over the largest speed, above which a path counts as moving
MOVING = 1e-4


@dataclass(frozen=True)
class Servo:
    """turn: s in which its force turns friction round;  play: width of the body's lag behind the
    reference (SI of the body)
    """

    turn: float = 0.0
    play: float = 0.0


@dataclass(frozen=True)
class FollowedPath:
    """A path as it is followed, (n,), and the rows [from, to] at which the body sticks."""

    path: Array
    stuck: tuple[tuple[int, int], ...]


def servo_of(model: Model, stretches: Sequence[Stretch], body: str) -> Servo:
    """The servo that the records of a body show, with a model of its friction.

    A reference that turns leaves with t^2, and a spring-like force with it: the force then changes
    fastest at the end, at twice its mean rate.
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
    """The path (n,) that a body takes behind this reference."""
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
    """Stretches of rows in which the reference moves and the body does not."""
    speed = np.abs(np.diff(path))
    stuck = (np.diff(behind) == 0.0) & (speed > MOVING * speed.max())
    edges = np.flatnonzero(np.diff(np.concatenate([[0], stuck.astype(int), [0]])))
    return tuple((int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True))


def with_ramps(force: Array, stuck: Sequence[tuple[int, int]]) -> Array:
    """The force (n,) with a smooth change over each stretch of rows."""
    force = force.copy()
    for first, last in stuck:
        # friction has turned round a row or two after the body has set out
        after = min(last + 2, len(force) - 1)
        share = 0.5 - 0.5 * np.cos(np.pi * np.arange(after - first + 1) / (after - first))
        force[first : after + 1] = force[first] + share * (force[after] - force[first])
    return force
