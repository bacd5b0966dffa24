"""Transmission compliance: actuator side and tip side are two bodies on a spring and damper.

    F = K (x - x_t) + C (v - v_t),   m_t dv_t/dt = F + interaction force

Cables, belts, harmonic drives. Position and friction are those of the actuator side; the
interaction force acts on the tip. Below the resonance it looks like `added_inertia`, or like
nothing at all where the inertia is free.
"""

from typing import Any

from ._effect import Effect, Parameter, State


def coupling(now: Any, p: Any) -> Any:
    return p.stiffness * (now.position - now.tip_position) + p.damping * (
        now.velocity - now.tip_velocity
    )


def law(now, p):
    # what the actuator side feels in place of the interaction force
    return coupling(now, p) + now.interaction_force


def tip_position(now, p):
    return now.tip_velocity


def tip_velocity(now, p):
    return (coupling(now, p) + now.interaction_force) / p.tip_inertia


EFFECT = Effect(
    role="structure",
    law=law,
    linear=True,
    states={
        "tip_position": State("position", tip_position, "position"),
        "tip_velocity": State("velocity", tip_velocity, "velocity"),
    },
    parameters={
        "tip_inertia": Parameter("inertia", "m_t: inertia of the tip side", starts=(0.1, 0.5)),
        "stiffness": Parameter(
            "stiffness",
            "K: stiffness of the transmission",
            starts=(0.004, 0.02, 0.1, 0.5),
            scale="resonance_stiffness",
        ),
        "damping": Parameter(
            "damping", "C: damping of the transmission", starts=(0.01,), scale="resonance_damping"
        ),
    },
    absent={"tip_inertia": 0.0},
    source="two masses on a spring; Mahvash, Okamura, IEEE CDC 2006",
)
