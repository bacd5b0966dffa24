"""Simulated records of a device, with a model as the truth.

The motion is prescribed. The model gives the force along it, and the command that causes this force
through the model's actuator. Ideal friction gets a short bristle, so that it has a value at rest
too: the value after the last motion.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ..blocks import Body
from ..diagnose.noise_floor import Sensor
from ..measurement.experiment import Experiment
from ..measurement.filtering import Array
from ..measurement.motion import Motion, motion_of
from ..measurement.record import Record
from ..model import Model
from ..realise.along_motion import residual_along
from ..realise.bristle import with_bristle
from ..realise.simulated import without_absent
from .limits import BodyPaths
from .path import Servo, follow_path, with_ramps

#: deflection of ideal friction before it slides, in encoder steps: too small to be read
BRISTLE_STEPS = 0.3
#: speed over the largest speed, below which a body is at rest: far below one encoder step a sample
AT_REST = 1e-5
#: most corrections of the command, and the part of the force that may then be left
CORRECTIONS, LEFT = 8, 1e-3
#: gain below which an actuator is not inverted, because the force does not pass
PASSES = 0.05
#: sines in the force of a hand that pushes
PUSHES = 7


def exact_motion(
    body: str,
    position: Array,
    *,
    sample_time: float,
    bandwidth: float,
) -> Motion:
    """The motion of a body that follows these positions (n,) exactly, with zero command."""
    n = len(position)
    stroke = max(float(np.ptp(position)), 1e-12)
    motion = motion_of(
        body=body,
        file="",
        time=np.asarray(sample_time * np.arange(n, dtype=np.float64)),
        position=position,
        command=np.zeros(n),
        interaction=None,
        sample_time=sample_time,
        rows=slice(0, n),
        bandwidth=bandwidth,
        resolution=1e-6 * stroke,
    )
    speed = np.abs(motion.velocity)
    moving = speed > AT_REST * float(speed.max())
    direction = np.where(moving, np.sign(motion.velocity), 0.0).astype(np.int8)
    return replace(motion, direction=direction, step=0.0)


def command_along(
    body: Body, motion: Motion, *, deflection: float, stuck: Sequence[tuple[int, int]] = ()
) -> Array:
    """The command (n,) that makes the model follow this motion, within its bandwidth.

    deflection: of ideal friction (SI);  stuck: rows in which the servo's force reverses
    """
    body = with_bristle(without_absent(body), deflection)
    command = np.zeros(len(motion.time))
    inverse: NDArray[np.complex128] | None = None
    for _ in range(CORRECTIONS):
        along = residual_along(body, replace(motion, command=command))
        needed = with_ramps(along.acting.value - along.residual.value, stuck)
        left = along.acting.value - needed
        whole = float(np.std(motion.lowpassed(needed)))
        if inverse is None:
            inverse = _inverse(body, motion, whole)
        elif float(np.std(motion.lowpassed(left))) < LEFT * whole:
            break
        command = command - motion.spectrum.multiply(left, inverse)
    return command


def _inverse(body: Body, motion: Motion, force: float) -> NDArray[np.complex128]:
    """Transfer function from acting force to command, by a small pulse of the command."""
    n = len(motion.time)
    pulse = np.zeros(n)
    pulse[n // 2] = 1e-3 * force or 1.0
    rest = residual_along(body, motion).acting.value
    answer = residual_along(body, replace(motion, command=pulse)).acting.value - rest
    commanded = motion.spectrum.transform(pulse)
    # a short record is continued with the pulse itself, which can cancel it at a frequency
    power = np.maximum(np.abs(commanded) ** 2, 1e-6 * float(np.max(np.abs(commanded) ** 2)))
    gain = motion.spectrum.transform(answer) * np.conj(commanded) / power
    return np.asarray(motion.smoothing * np.conj(gain) / (np.abs(gain) ** 2 + PASSES**2))


@dataclass(frozen=True)
class Bench:
    """The set-up of simulated records: the experiment with its sensors, and the bodies' course.

    attached: body -> inertia of a known mass on it, which acts as a known force (SI)
    push: body -> rms of a measured force that pushes it (SI)
    floor: force (rms) that sensors leave on the present records
    servos: body -> the servo that moves it
    """

    experiment: Experiment
    bandwidth: float
    sample_time: float
    sensors: Mapping[str, Sensor]
    course: BodyPaths
    floor: float = 0.0
    servos: Mapping[str, Servo] = field(default_factory=dict)
    attached: Mapping[str, float] = field(default_factory=dict)
    push: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class PlannedMotion:
    """The motion of each body behind one path, and the rows where each body sticks."""

    exact: Mapping[str, Motion]
    stuck: Mapping[str, tuple[tuple[int, int], ...]]


def plan_motion(path: Array, bench: Bench) -> PlannedMotion:
    """The motions of the bodies whose servos follow this path (n,)."""
    exact, stuck = {}, {}
    for body, gain in bench.course.gain.items():
        follows = follow_path(
            bench.course.middle[body] + gain * path,
            bench.servos.get(body, Servo()),
            sample_time=bench.sample_time,
        )
        motion = exact_motion(
            body, follows.path, sample_time=bench.sample_time, bandwidth=bench.bandwidth
        )
        exact[body] = replace(motion, interaction=_known_force(motion, bench))
        stuck[body] = follows.stuck
    return PlannedMotion(exact, stuck)


def _known_force(motion: Motion, bench: Bench) -> Array:
    """The known force on a body: zero, that of a known mass, or a push with a sum of sines."""
    force = -bench.attached.get(motion.body, 0.0) * motion.acceleration
    size = bench.push.get(motion.body, 0.0)
    if size > 0.0:
        frequencies = np.geomspace(0.5, 0.3 * bench.bandwidth, PUSHES)
        phase = -np.pi * np.arange(PUSHES) ** 2 / PUSHES
        push = np.sin(2 * np.pi * np.outer(frequencies, motion.time) + phase[:, None]).sum(0)
        push *= np.clip(np.minimum(motion.time, motion.time[::-1]) / 0.5, 0.0, 1.0)
        force = force + size * push / float(np.std(push))
    return np.asarray(force)


def record_under(
    model: Model,
    plan: PlannedMotion,
    bench: Bench,
    generator: np.random.Generator,
    *,
    file: str,
    use: str,
) -> Record:
    """The record of a planned motion with this model as the truth, as the sensors read it.

    Two models with generators of one seed have the same readings of position.
    """
    signals: dict[str, Array] = {}
    for body, exact in plan.exact.items():
        position = bench.sensors[f"{body}.position"]
        step = position.step or position.noise or 1e-6 * float(np.ptp(exact.position))
        true = {
            "position": exact.position,
            "actuator_force": command_along(
                model.body(body), exact, deflection=BRISTLE_STEPS * step, stuck=plan.stuck[body]
            ),
        }
        if f"{body}.interaction_force" in bench.sensors:
            true["interaction_force"] = exact.interaction
        for quantity, signal in true.items():
            name = f"{body}.{quantity}"
            signals[name] = bench.sensors[name].read(signal, generator)
    time = next(iter(plan.exact.values())).time
    whole = (slice(0, len(time)),)
    return Record(file, use, frozenset(), time, bench.sample_time, whole, signals)
