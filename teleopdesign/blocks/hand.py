"""A hand that holds the device: Z_H of the haptic interface, relative to position.

    simple = hand(mass=0.2, damping=4.0, stiffness=300.0)
    gripping = hand(mass=0.1, damping=2.0, stiffness=50.0, arm={"inertia": 1.5, ...})

These numbers are examples: with the grip and from person to person they vary by an order of
magnitude. The intention of the hand is a force (`R_V`) or a motion. For a motion, it is the force
that would move the free hand along it, from a simulation of the hand alone
(`haptic_interface(hand)` with this motion prescribed: its R_V).
"""

from __future__ import annotations

from collections.abc import Mapping

from ..effects import BLOCK_EFFECTS, EFFECTS
from .body import Body
from .value import Value


def hand(
    *,
    mass: float,
    damping: float,
    stiffness: float,
    arm: Mapping[str, float] | None = None,
    axis: str = "prismatic",
) -> Body:
    """Mass, damper and spring between the handle and a fixed point, or an arm that moves itself.

    mass: moving with the handle, kg;  damping: N s/m;  stiffness: N/m
    arm: `inertia`, `damping`, `stiffness` of the arm; then `damping` and `stiffness` are the grip's
    """
    body = Body(axis, {"inertia": Value(mass)})
    if arm is None:
        body = body.with_effect(EFFECTS["viscous"], {"damping": damping})
        return body.with_effect(EFFECTS["spring"], {"stiffness": stiffness})
    grip = {"grip_damping": damping, "grip_stiffness": stiffness}
    return body.with_effect(BLOCK_EFFECTS["arm"], {**grip, **arm})
