"""How a servo follows a reference against friction: with play, and with a delay.

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
