"""Which number of a design differs from a recording made with the compensation on.

Numbers of the compensator (strengths, gain, zero of the position, velocity filter, delay) and of
the device (inertia, strengths of its effects, delay of the force) are fitted one by one. The one
that leaves least is accepted where it explains most of what is left, up to three of them. Where the
command with C was recorded, the computer is compared at the command and the device at the force:
nothing of one moves the other. Where not, both move one force, and what explains it is listed
together.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..base.units import unit_after_number, unit_of
from ..controllers import Controller
from ..diagnose.criteria import CRITERIA
from ..diagnose.evidence import gain_score
from ..diagnose.fit import block_numbers, standard_errors
from ..effects import Parameter
from ..measurement.filtering import Array
from .second_recording import (
    DELAY,
    FILTER,
    GAIN,
    SENSOR,
    SHAPE,
    Key,
    SecondRecording,
    force_like,
)

#: most numbers that are named: more than three at once were never told apart
_MOST = 3
ZERO = "zero"
#: least scale of a force sensor that a fit tries: a tenth is another unit
_LEAST_SCALE = 0.05
#: part of a command by which another is the same: what a reader sees as the same figure
_SAME = 0.02
#: parts of the shortest period, or of the travel, at which a fit of a zero starts
_PLACES = np.linspace(-0.45, 0.45, 10)


@dataclass(frozen=True)
class Deviation:
    """One number of a design, and the value that the recording asks for, SI.

    at: its block, "computer" for filter and delay;  stderr: of the value and of the design's
    """

    at: str
    parameter: str
    designed: float
    value: float
    stderr: float
    unit: str

    def __str__(self) -> str:
        unit = unit_after_number(self.unit)
        numbers = f"{self.value:.3g}{unit}, designed {self.designed:.3g}{unit}"
        return f"{self.at}: {self.parameter} {numbers}"


@dataclass(frozen=True)
class _Number:
    """A number that may differ: its designed value, starts of a fit, and a step that counts."""

    key: Key
    designed: float
    starts: tuple[float, ...]
    step: float
    lower: float
    unit: str
    stderr: float = 0.0


@dataclass(frozen=True)
class _Attempt:
    number: _Number
    values: Mapping[Key, float]
    residual: Array
    stderr: float

    @property
    def rms(self) -> float:
        return float(np.sqrt(np.mean(self.residual**2)))

    @property
    def score(self) -> float:
        """Distance from the design in standard errors."""
        return abs(self.values[self.number.key] - self.number.designed) / max(self.stderr, 1e-300)

    @property
    def deviation(self) -> Deviation:
        one = self.number
        return Deviation(*one.key, one.designed, self.values[one.key], self.stderr, one.unit)


@dataclass(frozen=True)
class _Channel:
    """What one comparison leaves, over its numbers.

    enough: rms that asks for nothing
    shared: computer and device move one force, and nothing else tells them apart
    """

    numbers: tuple[_Number, ...]
    residual: Callable[[Mapping[Key, float]], Array]
    blocks: NDArray[np.intp]
    enough: float
    shared: bool = False

    @cached_property
    def deviations(self) -> tuple[tuple[Deviation, ...], ...]:
        """Numbers that differ, each first of those that explain as much."""
        groups: list[tuple[Deviation, ...]] = []
        values: dict[Key, float] = {}
        accepted: list[_Number] = []
        here = self.residual({})
        while len(groups) < _MOST and (left := _rms(here)) > self.enough:
            attempts = [self._fit(n, accepted, values) for n in self.numbers if n not in accepted]
            most = left**2 - CRITERIA.mostly * (left**2 - self.enough**2)
            able = [a for a in attempts if a.score >= CRITERIA.significance and a.rms**2 <= most]
            if not able:
                break
            able.sort(key=lambda a: a.rms)
            alike = [a for a in able[1:] if self._is_alike(a, able[0])]
            groups.append(tuple(a.deviation for a in (able[0], *alike)))
            values, here = dict(able[0].values), able[0].residual
            accepted.append(able[0].number)
        return tuple(groups)

    def _is_alike(self, one: _Attempt, best: _Attempt) -> bool:
        """Whether both explain the recording as well; where they share a force, mostly will do."""
        if self.shared and one.number.key[0] != best.number.key[0]:
            return True
        behind = gain_score(one.residual, best.residual, self.blocks)
        near = (1.0 + CRITERIA.relative_improvement) * best.rms**2
        return behind < CRITERIA.indistinguishable or one.rms**2 <= near

    def _fit(
        self, number: _Number, accepted: list[_Number], values: Mapping[Key, float]
    ) -> _Attempt:
        """The value of a number, with those that were accepted fitted again."""
        from scipy.optimize import least_squares

        free = [*accepted, number]
        steps = np.array([n.step for n in free])
        others = [values[n.key] for n in accepted]

        def at(x: Array) -> dict[Key, float]:
            pairs = zip(free, (x * steps).tolist(), strict=True)
            return {n.key: max(v, n.lower) for n, v in pairs}

        def left(x: Array) -> Array:
            return self.residual(at(x))

        starts = [np.array([*others, s]) / steps for s in number.starts]
        best = min(starts, key=lambda x: _rms(left(x))) if len(starts) > 1 else starts[0]
        solved = least_squares(
            left, best, diff_step=[1e-2] * len(free), xtol=1e-4, ftol=1e-5, max_nfev=8
        )
        errors = standard_errors(np.asarray(solved.jac), solved.fun, self.blocks) * steps
        error = float(np.hypot(errors[-1], number.stderr))
        return _Attempt(number, at(solved.x), solved.fun, error)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def deviations_of(
    on: SecondRecording, without: SecondRecording | None, *, enough: float
) -> tuple[tuple[Deviation, ...], ...]:
    """Numbers of a design that differ from a recording, each first of those that explain as much.

    without: a recording of the same device without compensation
    enough: rms force that readings and the diagnosis leave of the right device, N or N m
    """
    blocks = block_numbers(on.stretches)
    if on.has_command:
        logged = _lateness_of_log(on, blocks, enough)
        recorded = [on.low(i, s.motion.command) for i, s in enumerate(on.stretches)]
        size = _rms(np.concatenate(recorded))

        def at_command(values: Mapping[Key, float]) -> Array:
            return np.concatenate(_apart(on, recorded, values, logged))

        known = _Channel(_of_computer(on), at_command, blocks, _SAME * size).deviations
        numbers = _of_device(on)
    else:
        logged, known, numbers = 0.0, (), (*_of_computer(on), *_of_device(on))

    def at_force(values: Mapping[Key, float]) -> Array:
        body = on.changed_body(values)
        late = on.sampling.delay - logged + values.get(_force_delay(on), 0.0)
        commands = [s.motion.command for s in on.stretches] if on.has_command else None
        if commands is None:
            late, commands = values.get(_force_delay(on), 0.0), on.commands(values)
        scale = values.get(SENSOR, 1.0)
        parts = on.left_by(commands, body, late=late, scale=scale)
        if without is not None:
            off = [s.motion.command for s in without.stretches]
            parts += without.left_by(off, body, late=on.sampling.delay, scale=scale)
        return np.concatenate(parts)

    if without is not None:
        blocks = np.concatenate([blocks, block_numbers(without.stretches) + blocks.max() + 1])
    shared = without is None and not on.has_command
    return (*known, *_Channel(numbers, at_force, blocks, enough, shared).deviations)


def _apart(
    on: SecondRecording, recorded: list[Array], values: Mapping[Key, float], logged: float
) -> list[Array]:
    """The recorded less the predicted command, low-passed; logged: s by which its log is late."""
    delay = values.get(DELAY, on.sampling.delay) - on.sampling.delay + logged
    made = on.commands({**values, DELAY: delay})
    return [z - on.low(i, u) for i, (z, u) in enumerate(zip(recorded, made, strict=True))]


def _lateness_of_log(on: SecondRecording, blocks: NDArray[np.intp], enough: float) -> float:
    """Whether the command was logged as computed (0) or as applied (the delay), s.

    The force says when the command acts. Where it leaves more than enough, something else differs,
    which may move this moment: then the command decides if one of the two is as designed. Where
    the force is too little to see, the nearer command counts.
    """
    recorded = [on.low(i, s.motion.command) for i, s in enumerate(on.stretches)]
    same, ends = _SAME * _rms(np.concatenate(recorded)), (0.0, on.sampling.delay)
    missed = {late: _rms(np.concatenate(_apart(on, recorded, {}, late))) for late in ends}
    nearer = min(missed, key=lambda late: missed[late])
    written = [s.motion.command for s in on.stretches]
    now, later = (np.concatenate(on.left_by(written, late=late)) for late in ends)
    apart = abs(gain_score(now, later, blocks) - gain_score(later, now, blocks))
    is_designed = missed[nearer] <= same < max(missed.values())
    if apart < CRITERIA.significance or (is_designed and min(_rms(now), _rms(later)) > enough):
        return nearer
    return 0.0 if _rms(later) < _rms(now) else on.sampling.delay


def _force_delay(on: SecondRecording) -> Key:
    return on.mover.name, "delay"


def _of_computer(on: SecondRecording) -> tuple[_Number, ...]:
    """Numbers of the controllers, of the velocity filter and of the delay."""
    row, numbers = on.sampling.period, []
    for block in on.diagram.controls:
        assert isinstance(block.controller, Controller)
        known, lengths, scaled = block.controller.names(), [on.travel], 0
        for stage in block.controller.stages:
            for n, p in stage.law.parameters.items():
                name, value = f"{stage.name}.{n}", known[f"{stage.name}.{n}"]
                lengths += [value] if p.quantity == "position" and n != ZERO and value else []
                scaled += force_like(p) and value != 0
                if p.quantity not in SHAPE and value:
                    numbers.append(_strength((block.name, name), value, p, on))
        zeros = [n for n in known if n.rpartition(".")[2] == ZERO]
        numbers += [_zero((block.name, n), known[n], min(lengths), on) for n in zeros]
        if scaled > 1:
            numbers.append(_Number((block.name, GAIN), 1.0, (1.0,), 1.0, -np.inf, ""))
    filtered, delay = on.sampling.velocity_bandwidth, on.sampling.delay
    if np.isfinite(filtered):
        starts = tuple(filtered * np.array([0.25, 0.5, 1.0, 2.0]))
        numbers.append(_Number(FILTER, filtered, starts, filtered, 0.01 * filtered, "Hz"))
    starts = tuple(delay + row * np.array([0.0, 2.0, 5.0, 10.0]))
    return (*numbers, _Number(DELAY, delay, starts, row, 0.0, "s"))


def _of_device(on: SecondRecording) -> tuple[_Number, ...]:
    """Strengths of the device, a delay of the force, and the scale of the hand's force sensor."""
    numbers = [_Number(SENSOR, 1.0, (1.0,), 1.0, _LEAST_SCALE, "")]
    for name, known in on.body.parameters.items():
        declared = on.body.parameter(name)
        if declared.quantity not in SHAPE and known.value:
            stderr = known.stderr if np.isfinite(known.stderr) else 0.0
            key = (on.mover.name, name)
            numbers.append(_strength(key, known.value, declared, on, stderr=stderr))
    starts = tuple(on.sampling.period * np.array([0.0, 3.0, 8.0]))
    return (*numbers, _Number(_force_delay(on), 0.0, starts, on.sampling.period, -np.inf, "s"))


def _strength(
    key: Key, value: float, declared: Parameter, on: SecondRecording, *, stderr: float = 0.0
) -> _Number:
    unit = unit_of(declared.quantity, on.body.axis)
    return _Number(key, value, (value,), abs(value), declared.lower, unit, stderr)


def _zero(key: Key, value: float, length: float, on: SecondRecording) -> _Number:
    starts = tuple(value + length * _PLACES)
    return _Number(key, value, starts, 0.1 * length, -np.inf, unit_of("position", on.body.axis))
