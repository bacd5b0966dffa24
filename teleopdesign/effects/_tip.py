"""A tip: a second body behind the actuator side, which the interaction force acts on.

    m_t dv_t/dt = coupling + interaction force,   (m - m_t) a = acting force - coupling - ...

The inertia m of the body counts both sides, as what moves together where nothing gives: a stiff
coupling is the rigid body. Needs a parameter `tip_inertia`.
"""

from collections.abc import Callable
from typing import Any

from sympy import sqrt

from ._effect import State

Expression = Callable[[Any, Any], Any]


def behind(
    coupling: Expression, correction: Expression | None = None
) -> tuple[Expression, dict[str, State]]:
    """Law and hidden states of a structure whose coupling(now, p) joins it to its tip.

    correction: velocity by which the tip is led back to its course along a measured motion
    """

    def law(now: Any, p: Any) -> Any:
        return coupling(now, p) + now.interaction_force - p.tip_inertia * now.acceleration

    def tip_position(now: Any, p: Any) -> Any:
        return now.tip_velocity

    def tip_velocity(now: Any, p: Any) -> Any:
        return (coupling(now, p) + now.interaction_force) / p.tip_inertia

    return law, {
        "tip_position": State("position", tip_position, "position", correction),
        "tip_velocity": State("velocity", tip_velocity, "velocity"),
    }


def led_back(following: float) -> Expression:
    """Velocity of a tip towards where the unexplained force r says that it is: -rate r / K.

    What it takes to lead the tip so, m_t rate / K dr/dt, is left unexplained as well: an effect
    says so by `led`. Needs a parameter `stiffness`.
    following: rate over the tip's natural frequency in contact and its part of the body's inertia:
        a lighter tip, whose force shows less, is led by less
    """

    def towards(now: Any, p: Any) -> Any:
        rate = following * sqrt(p.stiffness / p.tip_inertia) * p.tip_inertia / now.inertia
        return -rate * now.unexplained / p.stiffness

    return towards
