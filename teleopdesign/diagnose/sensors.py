"""What the sensors of an experiment do to a signal: steps and noise, as stated or as seen."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..measurement.channel import Channel
from ..measurement.encoder import reading_noise, reading_step
from ..measurement.experiment import Experiment
from ..measurement.filtering import Array


@dataclass(frozen=True)
class Sensor:
    """step: between readings, 0 for none;  noise: rms (SI)."""

    step: float = 0.0
    noise: float = 0.0

    def read(self, signal: Array, generator: np.random.Generator) -> Array:
        """The signal (n,) as this sensor reads it; where its steps lie is drawn."""
        read = signal + self.noise * generator.standard_normal(len(signal))
        if self.step <= 0:
            return read
        return self.step * np.round(read / self.step + generator.uniform(-0.5, 0.5))


def sensor_of(experiment: Experiment, name: str, readings: Array) -> Sensor:
    """The sensor of a channel ("device.position"), as stated.

    Where no resolution of its body's position is stated: as seen in these readings (n,). So is the
    noise of a force that was measured, where none is stated.
    """
    channel = experiment.channels[name]
    step, noise = channel.resolution or 0.0, channel.noise or 0.0
    if experiment.channels[f"{channel.body}.position"].resolution is None:
        noise = noise or reading_noise(readings)
        # levels of a force may be commanded ones; those of a position are its encoder's
        if channel.quantity == "position":
            step = step or reading_step(readings)
    elif is_noise_seen(channel):
        noise = math.sqrt(max(reading_noise(readings) ** 2 - step**2 / 12.0, 0.0))
    return Sensor(step, noise)


def is_noise_seen(channel: Channel) -> bool:
    """Whether a channel is a measured force of which no noise is stated: its readings tell it.

    A command is what it says, and the steps of an encoder are all that its readings err by.
    """
    force = channel.quantity == "interaction_force" or channel.measured
    return force and channel.noise is None


def sensors_of(experiment: Experiment) -> Mapping[str, Sensor]:
    """Channel ("device.position") -> its sensor, seen in the first record where none is stated."""
    return {
        name: sensor_of(experiment, name, experiment.records[0].signals[name])
        for name, channel in experiment.channels.items()
        if channel.body is not None and channel.quantity != "velocity"
    }
