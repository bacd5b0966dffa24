"""Typical size of every quantity along the records, for start values and steps of a fit."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .motion import Motion

#: size (SI) up to which a signal is none, and largest size that counts: cubes of sizes between
#: them, and quotients of these, are numbers
LEAST, LARGEST = 1e-60, 1e60


def scales(motions: Sequence[Motion], bandwidth: float) -> dict[str, float]:
    """Quantity -> typical size along these motions (SI): rms values and their quotients.

    "lowest_position", "highest_position" and "largest_velocity" are ends of all motions together;
    "travel" is the widest range of positions in one motion, "duration" the longest.
    """

    def rms(parts: list[np.ndarray]) -> float:
        size = float(np.sqrt(np.mean(np.concatenate(parts) ** 2)))
        return min(size, LARGEST) if size > LEAST else 1e-12

    force = rms([m.lowpassed(m.at_rows(m.command) + m.interaction) for m in motions])
    position = rms([m.position - m.position.mean() for m in motions])
    velocity = rms([m.velocity for m in motions])
    acceleration = rms([m.lowpassed(m.acceleration) for m in motions])
    return {
        "time": 1.0 / (2 * np.pi * bandwidth),
        "position": position,
        "velocity": velocity,
        "acceleration": acceleration,
        "force": force,
        "largest_force": max(float(np.abs(m.command + m.interaction).max()) for m in motions)
        or force,
        "inertia": force / acceleration,
        "damping": force / velocity,
        "stiffness": force / position,
        "resonance_stiffness": force / acceleration * (2 * np.pi * bandwidth) ** 2,
        "resonance_position": acceleration / (2 * np.pi * bandwidth) ** 2,
        "resonance_damping": force / acceleration * 2 * np.pi * bandwidth,
        "drag": force / velocity**2,
        "cubic_stiffness": force / position**3,
        "per_square_of_position": 1.0 / position**2,
        "travel": max(float(np.ptp(m.position)) for m in motions) or 1e-12,
        "lowest_position": min(float(m.position.min()) for m in motions),
        "highest_position": max(float(m.position.max()) for m in motions),
        "largest_velocity": max(float(np.abs(m.velocity).max()) for m in motions) or 1e-12,
        "duration": max(float(np.ptp(m.time)) for m in motions),
        "frequency": bandwidth,
        "angle": 1.0,
        "dimensionless": 1.0,
        "temperature": 1.0,
        "temperature_coefficient": 1.0,
    }
