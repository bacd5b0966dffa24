"""Sensors of an experiment: steps and noise of their readings, as stated or as estimated."""

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
