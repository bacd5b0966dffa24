"""What the sensors of an experiment do to a signal: steps and noise, as stated or as seen."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ...measurement.experiment import Experiment
from ...measurement.filtering import Array
from ...measurement.motion import reading_noise, reading_step


@dataclass(frozen=True)
class Sensor:
    """step: between readings, 0 for none;  noise: rms (SI)."""

    step: float = 0.0
    noise: float = 0.0

    def read(self, signal: Array, generator: np.random.Generator) -> Array:
        """The signal (n,) as this sensor reads it; where its steps lie is drawn."""
        read = signal + self.noise * generator.standard_normal(len(signal))
        offset = generator.uniform(-0.5, 0.5)
        return self.step * np.round(read / self.step + offset) if self.step > 0 else read


def sensors_of(experiment: Experiment) -> Mapping[str, Sensor]:
    """Channel ("device.position") -> its sensor; seen in the readings where nothing is stated."""
    found = {}
    for name, channel in experiment.channels.items():
        if channel.body is None or channel.quantity == "velocity":
            continue
        step, noise = channel.resolution or 0.0, channel.noise or 0.0
        if experiment.channels[f"{channel.body}.position"].resolution is None:
            readings = experiment.records[0].signals[name]
            noise = noise or reading_noise(readings)
            # levels of a force may be commanded ones; those of a position are its encoder's
            if channel.quantity == "position":
                step = step or reading_step(readings)
        found[name] = Sensor(step, noise)
    return found
