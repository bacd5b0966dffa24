"""Slips of units: one unit stated as another, recognised by its factors on the parameters."""

from __future__ import annotations

import math
from collections.abc import Mapping

from ..base.units import unit_of

#: decades by which strengths may differ from those of a slip of units: a user's values are guesses
NEAR = 0.5
#: power of (force, position) in each quantity's unit
POWERS = {
    "force": (1, 0),
    "inertia": (1, -1),
    "damping": (1, -1),
    "stiffness": (1, -1),
    "drag": (1, -2),
    "cubic_stiffness": (1, -3),
}
#: factors that come from one unit stated as another, by axis: on the position ...
_POSITION_SLIPS = {
    "prismatic": {"mm": 1e3, "cm": 1e2, "km": 1e-3},
    "revolute": {"deg": 180 / math.pi, "mrad": 1e3, "turns": 1 / (2 * math.pi)},
}
#: ... and on the forces
_FORCE_SLIPS = {
    "prismatic": {"mN": 1e3, "kN": 1e-3},
    "revolute": {"N*mm": 1e3, "kN*m": 1e-3},
}
#: ... and on the model's inertia
_INERTIA_SLIPS = {
    "prismatic": {"g": 1e-3},
    "revolute": {"kg*cm^2": 1e-4, "g*cm^2": 1e-7, "g*m^2": 1e-3},
}


def slips(
    axis: str, ratios: Mapping[str, float], quantities: Mapping[str, str], *, near: float = NEAR
) -> list[str]:
    """The slips of units that bring every strength near the model's, best first, in words.

    ratios: strength -> estimated over stated value;  quantities: strength -> its quantity
    near: decades that count as near
    """
    position, force, inertia = (unit_of(q, axis) for q in ("position", "force", "inertia"))
    alternatives: dict[str, dict[str, float]] = {}
    for unit, factor in _POSITION_SLIPS[axis].items():
        write = f'write unit = "{unit}" at channels.position'
        alternatives[f"the position is in {unit}, given as {position} ({write})"] = {
            n: factor ** POWERS[q][1] for n, q in quantities.items()
        }
    for unit, factor in _FORCE_SLIPS[axis].items():
        write = f'write unit = "{unit}" at channels.actuator_force'
        alternatives[f"the forces are in {unit}, given as {force} ({write})"] = {
            n: factor ** POWERS[q][0] for n, q in quantities.items()
        }
    for unit, factor in _INERTIA_SLIPS[axis].items():
        write = f'write unit = "{unit}" at the inertia'
        alternatives[f"the model's inertia is meant in {unit}, given as {inertia} ({write})"] = {
            n: factor if n == "inertia" else 1.0 for n in quantities
        }
    worst = {
        text: max(abs(math.log10(ratios[n] / expected[n])) for n in ratios)
        for text, expected in alternatives.items()
    }
    likely = [t for t in sorted(worst, key=lambda t: worst[t]) if worst[t] < near]
    return [t for t in likely if worst[t] < worst[likely[0]] + 0.1]


def scale_of_forces(ratios: Mapping[str, float]) -> list[str]:
    """A sentence that all strengths differ from the model's by one factor; else empty."""
    if len(ratios) < 2:
        return []
    factor = 10 ** (sum(math.log10(r) for r in ratios.values()) / len(ratios))
    if max(abs(math.log10(r / factor)) for r in ratios.values()) > NEAR:
        return []
    return [
        f"the forces are about {factor:.1g} times what the model requires, as by a torque constant "
        "or a gear ratio"
    ]
