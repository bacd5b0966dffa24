"""The impedance of a body as its records show it, without a model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..base.units import unit_of
from ..frequency import FrequencyResponse, recorded_response
from ..measurement.prepare import Prepared
from ..model import Model
from ..realise.along_motion import residual_along
from .record_offsets import as_logged


def recorded_impedance(
    model: Model, prepared: Prepared, place: str, *, modelled: bool = False
) -> FrequencyResponse:
    """Force from command and hand over the motion of a body: E/L of the device alone.

    Forces that nobody recorded and noise of the readings both widen the interval of its magnitude.
    Of all records, up to the bandwidth of the comparison; model: by how much the logs are late
    modelled: of the force that the model needs along the same motion, its nonlinear laws included
    raises ModelError: the records are too short for it
    """
    of_body = [s for s in prepared.stretches if s.motion.body == place]
    positions, forces = [], []
    for stretch in of_body:
        motion = as_logged(model, stretch.motion)
        rows = slice(stretch.keep[0], stretch.keep[-1] + 1)
        force = motion.at_rows(motion.command) + motion.interaction
        if modelled:
            force = force - residual_along(model.body(place), motion).residual.value
        positions.append(motion.position[rows])
        forces.append(force[rows])
    made = recorded_response(
        positions,
        forces,
        sample_time=of_body[0].motion.sample_time,
        up_to=of_body[0].motion.bandwidth,
        unit=unit_of("stiffness", model.body(place).axis),
    )
    if not modelled:
        return made
    return replace(made, cases=("model",), measured=False, band=None, coherence=None)


def energetic_speed(model: Model, prepared: Prepared, place: str) -> float:
    """Speed (m/s or rad/s) at which friction of a constant level is the damper of equal energy.

    Along all records: the mean square velocity over the mean speed
    """
    velocity = np.concatenate(
        [s.motion.velocity[s.keep] for s in prepared.stretches if s.motion.body == place]
    )
    return float(np.mean(velocity**2) / np.mean(np.abs(velocity)))
