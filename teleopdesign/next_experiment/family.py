"""The candidate motions: usual motions of a servo, within limits.

Each part starts and ends at rest in the middle of the stroke, so that parts can follow one another.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from ..measurement.filtering import Array
from .limits import Limits
from .path import Hold, Move, largest_factor, sines, travel, with_window

#: a function that writes a value of a quantity ("position", "velocity", "frequency", "time") with
#: unit
Show = Callable[[float, str], str]
#: speeds of runs over the largest speed: three decades, about three to a decade
SPEEDS = (1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002)
#: amplitudes of sums of sines over the largest amplitude
SHARES = (1.0, 0.4, 0.15)
#: fewest encoder steps of a motion
FEWEST_STEPS = 10.0
#: intended duration of a part, s; and longest duration of a sweep over the whole stroke, s
ABOUT, LONGEST = 4.0, 8.0
#: speed of the motion to the start of a part, over the largest speed
BRISK = 0.5


@dataclass(frozen=True)
class PathPart:
    """A part of a motion: a clause on the body's motion, and the path (n,) about the middle, SI."""

    sentence: str
    path: Array


@dataclass(frozen=True)
class Setting:
    """The conditions for the candidate motions.

    step: of the position readings;  bandwidth: of the comparison, Hz
    show: text of a value with its unit
    repeated: s, duration of a repeated run, where an effect depends on time itself; 0: none
    """

    limits: Limits
    step: float
    bandwidth: float
    sample_time: float
    show: Show
    repeated: float = 0.0


def family(setting: Setting) -> tuple[PathPart, ...]:
    """All candidate parts."""
    makers = (
        _sums_of_sines,
        _runs,
        _sweeps,
        _two_speeds,
        _starts_after_rest,
        _steps,
        _places,
        _grow_amplitude,
        _repeat_path,
    )
    return tuple(part for maker in makers for part in maker(setting))


def _part(setting: Setting, sentence: str, legs: list[Move | Hold]) -> PathPart:
    return PathPart(sentence, travel(legs, setting.limits, sample_time=setting.sample_time))


def _sums_of_sines(s: Setting) -> Iterator[PathPart]:
    top = s.bandwidth  # nothing above it is compared
    for low, high in (
        (0.3, 3.0),
        (1.0, 8.0),
        (0.05 * top, 0.25 * top),
        (0.15 * top, 0.5 * top),
        (0.3 * top, 0.9 * top),
    ):
        duration = min(max(ABOUT, 2.0 / low), LONGEST)
        for share in SHARES:
            path = sines(
                np.geomspace(low, high, 9),
                duration,
                s.limits,
                share=share,
                sample_time=s.sample_time,
            )
            size = float(np.abs(path).max())
            if size > FEWEST_STEPS * s.step:
                text = (
                    f"follow a sum of sines from {s.show(low, 'frequency')} to "
                    f"{s.show(high, 'frequency')}, up to {s.show(size, 'position')} from the middle"
                )
                yield PathPart(text, path)


def _reach(s: Setting, speed: float, time: float) -> float:
    return min(s.limits.high, speed * time)


def _runs(s: Setting) -> Iterator[PathPart]:
    for ratio in SPEEDS:
        speed = ratio * s.limits.speed
        reach = _reach(s, speed, 0.25 * ABOUT)
        if reach < FEWEST_STEPS * s.step:
            continue
        times = max(1, round(ABOUT * speed / (4 * reach)))
        legs: list[Move | Hold] = []
        for _ in range(times):
            legs += [Move(reach, speed), Move(-reach, speed)]
        text = _describe_back_and_forth(s, reach, speed)
        yield _part(s, text, [*legs, Move(0.0, speed)])


def _describe_back_and_forth(s: Setting, reach: float, speed: float) -> str:
    return (
        f"move back and forth over {s.show(2 * reach, 'position')} at {s.show(speed, 'velocity')}"
    )


def _sweeps(s: Setting) -> Iterator[PathPart]:
    brisk, whole = BRISK * s.limits.speed, 2 * s.limits.high
    for time in (0.5 * LONGEST, LONGEST):
        speed = min(whole / time, s.limits.speed)
        for end, way in ((1.0, "forward"), (-1.0, "backward")):
            far = end * s.limits.high
            legs: list[Move | Hold] = [Move(-far, brisk), Hold(0.3), Move(far, speed), Hold(0.3)]
            text = (
                f"move slowly {way} over {s.show(whole, 'position')} at {s.show(speed, 'velocity')}"
            )
            yield _part(s, text, [*legs, Move(0.0, brisk)])


def _two_speeds(s: Setting) -> Iterator[PathPart]:
    for reach in (s.limits.high, 0.3 * s.limits.high):
        fast, slow = s.limits.speed, max(2 * reach / LONGEST, 0.1 * s.limits.speed)
        if reach < FEWEST_STEPS * s.step or slow >= fast:
            continue
        legs: list[Move | Hold] = []
        for speed in (fast, slow):
            legs += [Move(reach, speed), Move(-reach, speed), Move(0.0, speed)]
        text = (
            f"move along one path of {s.show(2 * reach, 'position')} at {s.show(fast, 'velocity')} "
            f"and at {s.show(slow, 'velocity')}"
        )
        yield _part(s, text, legs)


def _starts_after_rest(s: Setting) -> Iterator[PathPart]:
    for ratio in (0.5, 0.05):
        speed = ratio * s.limits.speed
        reach = _reach(s, speed, 0.5)
        if reach < FEWEST_STEPS * s.step:
            continue
        legs: list[Move | Hold] = []
        for rest in (0.05, 0.2, 0.8):
            # on the same way after a rest, then back after a rest
            legs += [Move(0.5 * reach, speed), Hold(rest), Move(reach, speed), Hold(rest)]
            legs += [Move(0.0, speed), Hold(rest)]
        text = (
            f"start after rests of 0.05, 0.2 and 0.8 s, in the same direction and back, in moves "
            f"of {s.show(0.5 * reach, 'position')} at {s.show(speed, 'velocity')}"
        )
        yield _part(s, text, legs)


def _steps(s: Setting) -> Iterator[PathPart]:
    for share in (1.0, 0.2):
        size = share * s.limits.high
        if size < FEWEST_STEPS * s.step:
            continue
        legs: list[Move | Hold] = []
        for to in (0.6, -0.4, 1.0, -1.0, 0.3, -0.6, 0.0):
            legs += [Move(to * size, s.limits.speed), Hold(0.3)]
        yield _part(s, f"step between positions up to {s.show(2 * size, 'position')} apart", legs)


def _places(s: Setting) -> Iterator[PathPart]:
    brisk, small = BRISK * s.limits.speed, 0.15 * s.limits.high
    if small < FEWEST_STEPS * s.step:
        return
    for ratio in (0.5, 0.05):
        speed = max(ratio * s.limits.speed, small)  # four runs of a small stroke take 4 s at most
        legs: list[Move | Hold] = []
        for place in (-0.85, 0.0, 0.85):
            at = place * s.limits.high
            legs += [Move(at, brisk), Move(at + small, speed), Move(at - small, speed)]
            legs += [Move(at, speed)]
        text = (
            f"move over {s.show(2 * small, 'position')} at {s.show(speed, 'velocity')} at both "
            "ends of the stroke and in its middle"
        )
        yield _part(s, text, [*legs, Move(0.0, brisk)])


def _grow_amplitude(s: Setting) -> Iterator[PathPart]:
    t = np.arange(0.0, 1.5 * ABOUT, s.sample_time)
    for largest in (0.3 * s.limits.high, 100 * s.step):
        smallest = 0.5 * FEWEST_STEPS * s.step
        if largest < 2 * smallest:
            continue
        grown = smallest * (largest / smallest) ** (t / t[-1])
        y = with_window(grown * np.sin(2 * np.pi * 1.5 * t), ramp=0.3, sample_time=s.sample_time)
        y *= min(1.0, largest_factor(y, s.limits, sample_time=s.sample_time))
        text = (
            f"oscillate at 1.5 Hz with an amplitude that grows from {s.show(smallest, 'position')} "
            f"to {s.show(float(np.abs(y).max()), 'position')}"
        )
        yield PathPart(text, y)


def _repeat_path(s: Setting) -> Iterator[PathPart]:
    if s.repeated <= 0.0:
        return
    speed = BRISK * s.limits.speed
    reach = _reach(s, speed, 0.5 * ABOUT)
    times = max(1, round(s.repeated * speed / (4 * reach)))
    legs: list[Move | Hold] = [Move(reach, speed), Move(-reach, speed)] * times
    there = _describe_back_and_forth(s, reach, speed)
    text = f"{there} for {s.show(s.repeated, 'time')}, from a cold start"
    yield _part(s, text, [*legs, Move(0.0, speed)])
