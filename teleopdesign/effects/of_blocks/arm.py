"""Arm: the spring and damper of the grip hold the device, with the mass of the arm behind the grip.

    F = K_g (x - x_a) + B_g (v - v_a),   m_a dv_a/dt = F - K_a x_a - B_a v_a

Below the resonance of arm and grip the hand feels like the arm. Above the resonance the hand feels
like the grip alone.
"""

from types import SimpleNamespace

from .. import spring, viscous
from .._effect import Effect, Parameter, State


def pull(position, velocity, stiffness, damping):
    now = SimpleNamespace(position=position, velocity=velocity)
    p = SimpleNamespace(stiffness=stiffness, damping=damping)
    return spring.law(now, p) + viscous.law(now, p)


def grip(now, p):
    stretch = now.position - now.arm_position, now.velocity - now.arm_velocity
    return pull(*stretch, p.grip_stiffness, p.grip_damping)


def arm_position(now, p):
    return now.arm_velocity


def arm_velocity(now, p):
    held = pull(now.arm_position, now.arm_velocity, p.stiffness, p.damping)
    return (grip(now, p) - held) / p.inertia


EFFECT = Effect(
    role="force",
    block="hand",
    energy="dissipates",
    law=grip,
    linear=True,
    states={
        "arm_position": State("position", arm_position),
        "arm_velocity": State("velocity", arm_velocity),
    },
    parameters={
        "inertia": Parameter("inertia", "m_a: inertia of the arm"),
        "damping": Parameter("damping", "B_a: damping between arm and trunk"),
        "stiffness": Parameter("stiffness", "K_a: stiffness between arm and trunk"),
        "grip_damping": Parameter("damping", "B_g: damping of the grip"),
        "grip_stiffness": Parameter("stiffness", "K_g: stiffness of the grip"),
    },
    absent={"grip_stiffness": 0.0, "grip_damping": 0.0},
    source="two masses on springs and dampers",
)
