"""A hand that holds the device: Z_H of the haptic interface, relative to position.

    simple = hand(mass=0.2, damping=4.0, stiffness=300.0)
    gripping = hand(mass=0.1, damping=2.0, stiffness=50.0, arm={"inertia": 1.5, ...})

These numbers are examples: with the grip and from person to person they vary by an order of
magnitude. What the hand wants comes in as force (`R_V`) or as motion: the force that would lead the
free hand along it, from a simulation of the hand alone (`haptic_interface(hand)` with that
motion prescribed: its R_V).
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
    """Mass, damper and spring from the handle to rest, or to an arm that itself moves.

    mass: what moves with the handle, kg;  damping: N s/m;  stiffness: N/m
    arm: `inertia`, `damping`, `stiffness` of the arm; then `damping` and `stiffness` are the grip's
    """
    body = Body(axis, {"inertia": Value(mass)})
    if arm is None:
        body = body.with_effect(EFFECTS["viscous"], {"damping": damping})
        return body.with_effect(EFFECTS["spring"], {"stiffness": stiffness})
    grip = {"grip_damping": damping, "grip_stiffness": stiffness}
    return body.with_effect(BLOCK_EFFECTS["arm"], {**grip, **arm})
