"""The noise floor: the force error that sensor errors alone would leave with a right model.

Readings are simulated: the smoothed motion is read by an encoder of the stated step with a random
    zero, and the stated noise is added. Where the scatter of the recorded readings grows with
    speed, the clock jitters, and the simulated readings jitter too. The floor is the change of the
    residual by the simulated readings, as a relative force error. The directions of motion stay
    those of the recorded readings. Where no resolution is stated, steps and noise of all channels
    are estimated from the readings, from their content near the Nyquist frequency, and the answer
    says so. Where a resolution is stated, only noise of measured forces that is not stated is
    estimated in this way.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from ..base.codec import At, Size
from ..base.frozen import ByValue
from ..check.sample_clock import jitter_of
from ..measurement.channel import Channel
from ..measurement.encoder import reading_noise, reading_step
from ..measurement.experiment import Experiment
from ..measurement.filtering import Array
from ..measurement.friction_curve import noise_of_points
from ..measurement.motion import Motion, motion_of
from ..measurement.prepare import Prepared, Stretch
from ..model import Model
from .criteria import CRITERIA
from .error import error_of, refer_to_command
from .residual import residuals

#: records with drawn noise for each noise floor; it differs by a few percent from draw to draw
DRAWS = 3


@dataclass(frozen=True, eq=False)
class NoiseFloor(ByValue):
    """The noise floor as a relative force error, and the origin of its numbers.

    value: the part that counts as noise;  drawn: the error that simulated readings left
    source: origin of step and noise of the sensors, in words
    at_command: floor of the error at the command (`refer_to_command`) over that of the force: 1
        where no effect lies between command and body; never less
    jitters: whether the readings show that their moments jitter
    """

    value: Annotated[Size, At("noise_floor")]
    source: Annotated[str, At("noise_floor_source")]
    drawn: Annotated[Size, At("floor.drawn")]
    at_command: Annotated[Size, At("floor.at_command")] = 1.0
    jitters: Annotated[bool, At("floor.jitters")] = False

    @property
    def value_at_command(self) -> float:
        """The floor of the error at the command."""
        return self.value * self.at_command

    @property
    def counted(self) -> float:
        """Share of the drawn floor that counts as noise."""
        return self.value / self.drawn if self.drawn else 1.0


def say_floors(left: float, form: str = ".1f") -> str:
    """An error in noise floors, in words: no number where it only says that the floor is zero.

    form: of the number, as in a format string
    """
    most = CRITERIA.countable
    return f"{left:{form}}" if left <= most else f"more than {most:g}"


def noise_floor(
    model: Model, prepared: Prepared, generator: np.random.Generator, *, use: str = "check"
) -> NoiseFloor:
    """Force error that a right model would show on the records of one use, by simulated readings.

    use: "fit" or "check"; without such records, the fit records
    generator: of the random errors of the readings
    """
    stretches = prepared.of(use) or prepared.of("fit")
    if prepared.is_curve:
        return _floor_of_points(model, prepared, stretches, generator)
    channels = prepared.experiment.channels
    stated = all(channels[f"{s.motion.body}.position"].resolution is not None for s in stretches)
    errors, before = [], residuals(model, stretches)
    command_errors, command_before = [], refer_to_command(model, stretches).residual
    for k in range(DRAWS):
        drawn = [_draw_reading(s, prepared, generator, k) for s in stretches]
        pairs = zip(residuals(model, drawn), before, strict=True)
        errors.append(error_of(drawn, [r - r0 for (r, _), (r0, _) in pairs]))
        moved = refer_to_command(model, drawn).residual - command_before
        command_errors.append(np.linalg.norm(moved) / np.sqrt(sum(s.measured for s in drawn)))
    source = (
        "stated resolution and noise" if stated else "step and noise estimated from the readings"
    )
    bodies = {s.motion.body for s in stretches}
    if stated and any(c.body in bodies and is_noise_estimated(c) for c in channels.values()):
        source = "stated resolution, noise of forces estimated from the readings"
    left = float(np.sqrt(np.mean(np.square(errors))))
    back = float(np.sqrt(np.mean(np.square(command_errors)))) / left if left else 1.0
    # at the command, sensor noise is larger if a law attenuates the command, and smaller with
    # one that amplifies it; the floor is at least the error that sensor noise makes in the force
    jitters = any(_jitter(s, prepared) > 0.0 for s in stretches)
    return NoiseFloor(left, source, drawn=left, at_command=max(back, 1.0), jitters=jitters)


def _floor_of_points(
    model: Model,
    prepared: Prepared,
    stretches: Sequence[Stretch],
    generator: np.random.Generator,
) -> NoiseFloor:
    """The floor of a friction curve: the noise of its force, stated or read from the points.

    A stated noise of the speed counts by the slope of the model's friction.
    """
    noise = prepared.experiment.channels["device.actuator_force"].noise
    source = "stated noise of the force"
    if noise is None:
        velocity = np.concatenate([s.motion.velocity for s in stretches])
        noise, source = noise_of_points(
            velocity, np.concatenate([s.motion.command for s in stretches])
        )
    rows = sum(len(s.keep) for s in stretches)
    of_speed = prepared.experiment.channels["device.velocity"].noise
    squares = rows * noise**2
    if of_speed is not None and "stated" in source:  # read from the points it is in the scatter
        drawn = [_with_speeds_drawn(s, of_speed, generator) for s in stretches]
        pairs = zip(residuals(model, drawn), residuals(model, stretches), strict=True)
        squares += sum(float(np.sum((r - before) ** 2)) for (r, _), (before, _) in pairs)
    left = float(np.sqrt(squares / sum(s.measured for s in stretches)))
    return NoiseFloor(left, source, drawn=left)


def _with_speeds_drawn(stretch: Stretch, noise: float, generator: np.random.Generator) -> Stretch:
    """The points of a friction curve with noise on their speeds; directions stay."""
    velocity = stretch.motion.velocity
    moved = velocity + noise * generator.standard_normal(len(velocity))
    return replace(stretch, motion=replace(stretch.motion, velocity=moved))


def _draw_reading(
    stretch: Stretch, prepared: Prepared, generator: np.random.Generator, draw: int
) -> Stretch:
    """The stretch with simulated readings, and with the directions of the recorded readings."""
    motion = read_again(stretch, prepared, generator)
    if stretch.motion.links is not None:
        motion = replace(motion, links=stretch.motion.links.drawn[draw])
    return replace(stretch, motion=replace(motion, direction=stretch.motion.direction))


def read_again(stretch: Stretch, prepared: Prepared, generator: np.random.Generator) -> Motion:
    """The motion of a stretch as the sensors would read it in another measurement."""
    motion, channels = stretch.motion, prepared.experiment.channels
    side = _side(motion.position)
    signals = next(r for r in prepared.experiment.records if r.file == motion.file).signals
    # a command is held between rows: a small time shift of the reading does not change it
    jitter = _jitter(stretch, prepared)
    late = jitter * generator.standard_normal(len(motion.time)) if jitter > 0.0 else 0.0
    rate = np.gradient(motion.interaction, motion.sample_time)

    def read(quantity: str, signal: Array) -> Array:
        name = f"{motion.body}.{quantity}"
        if name not in signals:
            return signal
        sensor = sensor_of(prepared.experiment, name, signals[name][motion.rows])
        return side * sensor.read(side * signal, generator)

    drawn = motion_of(
        body=motion.body,
        file=motion.file,
        time=motion.time,
        position=read("position", motion.position + late * motion.velocity),
        command=read("actuator_force", motion.command),
        interaction=read("interaction_force", motion.interaction + late * rate),
        sample_time=motion.sample_time,
        rows=motion.rows,
        bandwidth=prepared.bandwidth,
        resolution=channels[f"{motion.body}.position"].resolution,
    )
    return replace(drawn, further=motion.further)


def _jitter(stretch: Stretch, prepared: Prepared) -> float:
    """The rms error (s) of the moments of a stretch's readings, estimated from the readings."""
    return jitter_of(prepared.experiment, stretch.motion.body, stretch.motion.file)


def _side(position: Array) -> float:
    """1 or -1: the direction in which a motion first leaves its start.

    Sensor errors are drawn relative to this direction. If the sign of an axis is reversed, the
    errors are reversed too, and estimates stay the same.
    """
    moved = np.flatnonzero(position != position[0])
    return 1.0 if len(moved) == 0 or position[moved[0]] > position[0] else -1.0


@dataclass(frozen=True)
class Sensor:
    """Errors of a sensor; step: between readings, 0 for none;  noise: rms (both SI)."""

    step: float
    noise: float

    def read(self, signal: Array, generator: np.random.Generator) -> Array:
        """The signal (n,) as this sensor reads it, with drawn noise and offset of its steps."""
        read = signal + self.noise * generator.standard_normal(len(signal))
        if self.step <= 0:
            return read
        return self.step * np.round(read / self.step + generator.uniform(-0.5, 0.5))


def sensor_of(experiment: Experiment, name: str, readings: Array) -> Sensor:
    """The sensor of a channel ("device.position"), as stated or as estimated.

    Where no resolution of its body's position is stated, step and noise are estimated from these
    readings (n,). So is the noise of a measured force, where none is stated.
    """
    channel = experiment.channels[name]
    step, noise = channel.resolution or 0.0, channel.noise or 0.0
    if experiment.channels[f"{channel.body}.position"].resolution is None:
        noise = noise or reading_noise(readings)
        # levels of a force may be commanded ones; those of a position are its encoder's
        if channel.quantity == "position":
            step = step or reading_step(readings)
    elif is_noise_estimated(channel):
        noise = math.sqrt(max(reading_noise(readings) ** 2 - step**2 / 12.0, 0.0))
    return Sensor(step, noise)


def is_noise_estimated(channel: Channel) -> bool:
    """Whether a channel is a measured force without stated noise, which its readings then show.

    A command has no noise, and the steps of an encoder are the only error of its readings.
    """
    force = channel.quantity == "interaction_force" or channel.measured
    return force and channel.noise is None


def sensors_of(experiment: Experiment) -> Mapping[str, Sensor]:
    """Channel ("device.position") -> its sensor; unstated errors are those of the first record."""
    return {
        name: sensor_of(experiment, name, experiment.records[0].signals[name])
        for name, channel in experiment.channels.items()
        if channel.body is not None and channel.quantity != "velocity"
    }
