"""What sensors alone would leave in the force error of a model that is right.

The records are made anew: along the smoothed motion the interaction force is set to what the model
needs exactly, positions are read off by an encoder of the stated step with a random zero, and the
stated noise is drawn. What the comparison then finds is the floor. Where nothing is stated, step
and noise are estimated from the readings themselves, and the answer says so.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..measurement.motion import Motion, motion_of, reading_noise, reading_step
from ..model import Model
from ..realise.along_motion import residual_along
from .force_error import Prepared, Stretch, error_of, residuals

#: records drawn anew per floor; its spread from draw to draw is a few percent
DRAWS = 3


@dataclass(frozen=True)
class NoiseFloor:
    """The floor as a relative force error, and where its numbers come from."""

    value: float
    source: str


def noise_floor(
    model: Model, prepared: Prepared, generator: np.random.Generator, *, use: str = "check"
) -> NoiseFloor:
    """Force error that a right model would show on the records of one use, by drawing them anew."""
    stretches = prepared.of(use) or prepared.of("fit")
    channels = prepared.experiment.channels
    stated = all(channels[f"{s.motion.body}.position"].resolution is not None for s in stretches)
    errors = []
    for _ in range(DRAWS):
        drawn = [replace(s, motion=_drawn(model, s, prepared, generator)) for s in stretches]
        errors.append(error_of(drawn, [r for r, _ in residuals(model, drawn)]))
    source = "stated resolution and noise" if stated else "step and noise seen in the readings"
    return NoiseFloor(float(np.sqrt(np.mean(np.square(errors)))), source)


def _drawn(
    model: Model, stretch: Stretch, prepared: Prepared, generator: np.random.Generator
) -> Motion:
    motion, channels = stretch.motion, prepared.experiment.channels
    position, force = (
        channels[f"{motion.body}.position"],
        channels.get(f"{motion.body}.interaction_force"),
    )
    record = next(r for r in prepared.experiment.records if r.file == motion.file)
    reading = record.signals[f"{motion.body}.position"][motion.rows]
    left = residual_along(model.body(motion.body), motion).residual.value
    x = motion.position
    n = len(x)
    step = position.resolution or reading_step(reading)
    noise = position.noise or 0.0
    if position.resolution is None:
        noise = max(noise, reading_noise(reading))
    x = x + noise * generator.standard_normal(n)
    if step > 0:
        x = step * np.round(x / step + generator.uniform(-0.5, 0.5))
    interaction = motion.interaction - left
    if force is not None and force.noise:
        interaction = interaction + force.noise * generator.standard_normal(n)
    if force is not None and force.resolution:
        interaction = force.resolution * np.round(interaction / force.resolution)
    command = channels[f"{motion.body}.actuator_force"]
    acting = motion.command
    if command.noise:
        acting = acting + command.noise * generator.standard_normal(n)
    if command.resolution:
        acting = command.resolution * np.round(acting / command.resolution)
    drawn = motion_of(
        body=motion.body,
        file=motion.file,
        time=motion.time,
        position=x,
        command=acting,
        interaction=interaction,
        sample_time=motion.sample_time,
        rows=motion.rows,
        bandwidth=prepared.bandwidth,
        resolution=position.resolution,
    )
    # when the drawn readings tell the direction a sample earlier or later is no sensor noise
    return replace(drawn, direction=motion.direction)
