"""Environments for a design: a body with an object that it can touch.

    slave = soft_rubber(slave, stiffness=800.0, damping=2.0, level=0.3, give=5e-4, position=0.01)

Each function replaces the environment that the body had. SI; contact begins at `position` and
resists motion beyond it. Numbers in the documentation are examples: values of a material must be
measured.

A hand that holds the device: Z_H of the haptic interface, relative to position.

    simple = hand(mass=0.2, damping=4.0, stiffness=300.0)
    gripping = hand(mass=0.1, damping=2.0, stiffness=50.0, arm={"inertia": 1.5, ...})

These numbers are examples: with the grip and from person to person they vary by an order of
magnitude. The intention of the hand is a force (`R_V`) or a motion. For a motion, it is the force
that would move the free hand along it, from a simulation of the hand alone
(`haptic_interface(hand)` with this motion prescribed: its R_V).
"""

from __future__ import annotations

from collections.abc import Mapping

from ..effects import BLOCK_EFFECTS, CONTACT_ROLES, EFFECTS
from .body import Body
from .body_equation import CONTACT
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

        >>> td.hand(mass=0.15, damping=5.0, stiffness=200.0)
        Body, prismatic
          inertia = 0.15 kg
          viscous.damping = 5 N*s/m
          spring.stiffness = 200 N/m
    """
    body = Body(axis, {"inertia": Value(mass)})
    if arm is None:
        body = body.with_effect(EFFECTS["viscous"], {"damping": damping})
        return body.with_effect(EFFECTS["spring"], {"stiffness": stiffness})
    grip = {"grip_damping": damping, "grip_stiffness": stiffness}
    return body.with_effect(BLOCK_EFFECTS["arm"], {**grip, **arm})


def free_space(body: Body) -> Body:
    """The body without an environment: free motion, no contact force.

    Effects of contacts are removed; friction, structure and actuation of the body stay.
    """
    for effect in reversed(body.effects):
        if effect.role in CONTACT_ROLES:
            body = body.without_effect(effect.name)
    return body


def spring_damper(body: Body, *, stiffness: float, damping: float, position: float = 0.0) -> Body:
    """A wall with spring and damper that pushes and never pulls.

    stiffness: N/m;  damping: N s/m, makes the force jump at the first contact;  position: m
    """
    return _add_environment(body, stiffness, position, damping=damping)


def hunt_crossley(
    body: Body,
    *,
    stiffness: float,
    depth: float,
    reference_velocity: float,
    power: float = 1.5,
    position: float = 0.0,
) -> Body:
    """A force K d_0 (d/d_0)^n (1 + v/v_0): k d^n + c d^n v with k = K d_0^(1-n), c = k/v_0.

    stiffness: K, N/m, secant stiffness at the depth d_0 = `depth`, m
    reference_velocity: v_0, m/s;  power: n, 1.5 for a sphere on a flat (Hertz)
    """
    wall = _add_environment(body, stiffness, position)
    hard = wall.with_effect(EFFECTS["contact_hardening"], {"power": power, "depth": depth})
    return hard.with_effect(
        BLOCK_EFFECTS["impact_damping"], {"reference_velocity": reference_velocity}
    )


def soft_rubber(
    body: Body,
    *,
    stiffness: float,
    damping: float,
    level: float,
    give: float,
    recovery_time: float = 0.1,
    position: float = 0.0,
) -> Body:
    """A spring, a damper and a small friction inside the material, in parallel.

    stiffness: N/m;  damping: N s/m;  level: of the inner friction, N
    give: depth over which the inner friction builds up, m;  recovery_time: s;  position: m
    """
    wall = _add_environment(body, stiffness, position, damping=damping)
    inside = {"level": level, "stiffness": level / give, "recovery_time": recovery_time}
    return wall.with_effect(BLOCK_EFFECTS["contact_hysteresis"], inside)


def _add_environment(
    body: Body, stiffness: float, position: float, *, damping: float = 0.0
) -> Body:
    values = {"stiffness": stiffness, "damping": damping, "contact_position": position}
    return free_space(body).with_effect(CONTACT, values)
