"""A tip: a second body behind the actuator side, which the interaction force acts on.

    m_t dv_t/dt = coupling + interaction force,   (m - m_t) a = acting force - coupling - ...

The inertia m of the body counts both sides, as what moves together where nothing gives: a stiff
coupling is the rigid body. Needs a parameter `tip_inertia`.
"""

from collections.abc import Callable
from typing import Any

from ._effect import State

Expression = Callable[[Any, Any], Any]


def behind(coupling: Expression) -> tuple[Expression, dict[str, State]]:
    """Law and hidden states of a structure whose coupling(now, p) joins it to its tip."""

    def law(now: Any, p: Any) -> Any:
        return coupling(now, p) + now.interaction_force - p.tip_inertia * now.acceleration

    def tip_position(now: Any, p: Any) -> Any:
        return now.tip_velocity

    def tip_velocity(now: Any, p: Any) -> Any:
        return (coupling(now, p) + now.interaction_force) / p.tip_inertia

    return law, {
        "tip_position": State("position", tip_position, "position"),
        "tip_velocity": State("velocity", tip_velocity, "velocity"),
    }
