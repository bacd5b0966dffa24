"""The impedance of a body as its records show it, without a model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..base.units import unit_of
from ..frequency import FrequencyResponse, recorded_response
from ..measurement.filtering import Array
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
    motion_of, force = _signals(model, prepared, place, modelled=modelled)
    some = next(s.motion for s in prepared.stretches if s.motion.body == place)
    made = recorded_response(
        motion_of,
        force,
        sample_time=some.sample_time,
        up_to=some.bandwidth,
        unit=unit_of("stiffness", model.body(place).axis),
        noise="both",
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


def _signals(
    model: Model, prepared: Prepared, place: str, *, modelled: bool
) -> tuple[list[Array], list[Array]]:
    """Position and acting force (n,) of each stretch, over the rows that count."""
    positions, forces = [], []
    for stretch in prepared.stretches:
        if stretch.motion.body != place:
            continue
        motion = as_logged(model, stretch.motion)
        rows = slice(stretch.keep[0], stretch.keep[-1] + 1)
        positions.append(motion.position[rows])
        force = motion.at_rows(motion.command) + motion.interaction
        if modelled:
            force = force - residual_along(model.body(place), motion).residual.value
        forces.append(force[rows])
    return positions, forces
