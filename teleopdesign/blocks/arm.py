"""An arm behind a grip: what holds the device is a spring and a damper with a mass behind it.

    F = K_g (x - x_a) + B_g (v - v_a),   m_a dv_a/dt = F - K_a x_a - B_a v_a

Below the resonance of arm and grip the hand feels like the arm, above it like the grip alone.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import sympy as sp

from ..effects import EFFECTS, Effect, Parameter, State

_SPRING, _DAMPER = EFFECTS["spring"], EFFECTS["viscous"]


def _pull(position: Any, velocity: Any, stiffness: Any, damping: Any) -> sp.Expr:
    """Force of a spring beside a damper."""
    now = SimpleNamespace(position=position, velocity=velocity)
    p = SimpleNamespace(stiffness=stiffness, damping=damping)
    return sp.sympify(_SPRING.law(now, p) + _DAMPER.law(now, p), strict=True)


def _grip(now: Any, p: Any) -> sp.Expr:
    stretch = now.position - now.arm_position, now.velocity - now.arm_velocity
    return _pull(*stretch, p.grip_stiffness, p.grip_damping)


def _arm_position(now: Any, p: Any) -> sp.Expr:
    return now.arm_velocity


def _arm_velocity(now: Any, p: Any) -> sp.Expr:
    held = _pull(now.arm_position, now.arm_velocity, p.stiffness, p.damping)
    return (_grip(now, p) - held) / p.inertia


ARM = Effect(
    role="force",
    energy="dissipates",
    law=_grip,
    linear=True,
    states={
        "arm_position": State("position", _arm_position),
        "arm_velocity": State("velocity", _arm_velocity),
    },
    parameters={
        "inertia": Parameter("inertia", "m_a: of the arm"),
        "damping": Parameter("damping", "B_a: between arm and trunk"),
        "stiffness": Parameter("stiffness", "K_a: between arm and trunk"),
        "grip_damping": Parameter("damping", "B_g: of the grip"),
        "grip_stiffness": Parameter("stiffness", "K_g: of the grip"),
    },
    absent={"grip_stiffness": 0.0, "grip_damping": 0.0},
    source="two masses on springs and dampers",
).named("arm", __doc__ or "")
