"""Force error in slow motion by the laws: no filter, sampling, presliding or compliance.

    force error = (inertia a + forces + level sgn v - C(v)) / (1 + H(v))

Each term is the law of the effect or controller itself. With Coulomb friction alone and without
inertia this is the residual friction r(v) of P13.

Friction left to the hand in slow steady motion, by the laws of friction, C and H.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp

from ..base.frozen import ByValue
from ..blocks import Body
from ..controllers import SIGNALS as CONTROL_SIGNALS
from ..controllers import Controller, parameter_symbol
from ..diagrams import Diagram, four_cases, haptic_interface
from ..effects import SIGNALS
from ..measurement.filtering import Array
from ..realise.simulated import without_absent
from ..realise.tips import move_to_tip_body
from .assumptions import StatedMotion

#: roles of effects that need dynamic states: in slow motion they are left out, or at steady state
_ROLES = ("friction_shape", "friction_speed", "structure", "actuation", "contact", "contact_shape")


def slow_body(body: Body) -> Body:
    """The body in slow motion: without presliding, memory, compliance, actuation and contact.

    The tip then moves with the body, so that friction of the tip acts on the body.
    """
    body = without_absent(body)
    for effect in [e for e in body.effects if e.role == "tip_level"]:
        values = {n: body.parameters[f"{effect.name}.{n}"].value for n in effect.parameters}
        body = body.without_effect(effect.name).with_effect(move_to_tip_body(effect), values)
    for effect in [e for e in body.effects if e.role in _ROLES]:
        if body.has(effect.name):
            body = body.without_effect(effect.name)
    return body


def force_needed(body: Body, motion: StatedMotion, *, rows: int = 2000) -> tuple[Array, Array]:
    """Force that slow motion needs along a cycle: total, and friction alone, (rows,) each."""
    body = slow_body(body)
    equation = body.equation()
    _, position, velocity, acceleration = motion.cycle(rows)
    values = {
        SIGNALS["time"]: np.zeros(rows),
        SIGNALS["position"]: position,
        SIGNALS["velocity"]: velocity,
        SIGNALS["acceleration"]: acceleration,
        SIGNALS["direction"]: np.sign(velocity),
    }
    friction = equation.friction
    other = equation.inertia * SIGNALS["acceleration"] + equation.force
    # a force that grows with the load is met at the load that the motion itself needs
    carried = body.carried_force().subs(SIGNALS["interaction_force"], 0)
    friction = friction.subs(SIGNALS["carried_force"], carried)
    acting = other + friction.subs(SIGNALS["acting_force"], other)
    friction = friction.subs(SIGNALS["acting_force"], acting)
    return _force_along(other, body, values) + (f := _force_along(friction, body, values)), f


def _force_along(law: sp.Expr, body: Body, values: dict[sp.Symbol, Array]) -> Array:
    call = sp.lambdify(list(values), sp.sympify(law, strict=True).subs(body.numbers()), "numpy")
    rows = next(iter(values.values())).shape
    return np.broadcast_to(np.asarray(call(*values.values()), dtype=float), rows)


def slow_output(controller: Controller, drive: Array, velocity: Array) -> Array:
    """Steady output of a controller at an input and a velocity, (n,) each.

    States have their steady value at that velocity; a low-pass passes, a bristle slides, a clock
    stands at 0. The command without the controller is 0.
    """
    signals = {n: CONTROL_SIGNALS[n] for n in CONTROL_SIGNALS}
    equation = controller.equation("slow", signals)
    speed, travel = CONTROL_SIGNALS["speed"], CONTROL_SIGNALS["velocity"]
    output = equation.output
    for state, rate in equation.rates.items():
        here = rate.subs(CONTROL_SIGNALS["travel_rate"], travel).subs(sp.Abs(travel), speed)
        steady = sp.solve(here, state)
        output = output.subs(state, steady[0] if steady else 0)
    numbers = {parameter_symbol("slow", n): v for n, v in controller.names().items()}
    numbers[CONTROL_SIGNALS["command"]] = 0.0
    call = sp.lambdify([CONTROL_SIGNALS["input"], travel, speed], output.subs(numbers), "numpy")
    force_out = call(drive, velocity, np.abs(velocity))
    return np.broadcast_to(np.asarray(force_out, dtype=float), velocity.shape)


def quasi_static_error(diagram: Diagram, motion: StatedMotion, *, rows: int = 2000) -> Array:
    """Force error R_D - R_M along a cycle in slow motion at R_D = 0, (rows,)."""
    _, position, velocity, _ = motion.cycle(rows)
    (body,) = (b.body for b in diagram.bodies if b.name == "Z_M")
    assert isinstance(body, Body)
    force, _ = force_needed(body, motion, rows=rows)
    return remaining_force(diagram, force, position, velocity)


def remaining_force(diagram: Diagram, force: Array, position: Array, velocity: Array) -> Array:
    """The part (n,) of a resisting force (n,) that C and H leave to the hand in slow motion."""
    gain = np.zeros_like(force)
    for block in diagram.controls:
        assert isinstance(block.controller, Controller)
        if block.name == "C":
            force = force - slow_output(block.controller, position, velocity)
        elif block.name == "H":
            gain = slow_output(block.controller, np.ones_like(force), velocity)
    left: Array = force / (1 + gain)
    return left


#: speeds over the recorded peak speed
SHARES = np.geomspace(0.01, 1.0, 41)


@dataclass(frozen=True, eq=False)
class ResidualFriction(ByValue):
    """Friction left at each speed, in each case of compensation.

    speeds: (n,), m/s or rad/s;  rows: case -> friction left, (n,), N or N m
    """

    speeds: Array
    rows: Mapping[str, Array]


def residual_friction(
    body: Body,
    *,
    cancellation: Controller | None,
    force_feedback: Controller,
    speeds: Array,
    position: float,
) -> ResidualFriction:
    """Residual friction of the four cases, in forward motion at one position, without a load.

    speeds: (n,), m/s or rad/s;  position: m or rad
    """
    body = slow_body(body)
    signals: dict[sp.Symbol, Array] = {
        SIGNALS["velocity"]: speeds,
        SIGNALS["direction"]: np.ones_like(speeds),
        SIGNALS["position"]: np.full_like(speeds, position),
        SIGNALS["time"]: np.zeros_like(speeds),
        SIGNALS["acting_force"]: np.zeros_like(speeds),
        SIGNALS["carried_force"]: np.zeros_like(speeds),
    }
    level, _ = law_along(body, body.level(), signals)
    device = haptic_interface(body, cancellation=cancellation, force_feedback=force_feedback)
    rows = {
        case: remaining_force(d, np.array(level), signals[SIGNALS["position"]], speeds)
        for case, d in four_cases(device, every=True).items()
    }
    return ResidualFriction(speeds, rows)


def law_along(body: Body, law: sp.Expr, signals: Mapping[sp.Symbol, Any]) -> tuple[Array, Array]:
    """A law of a body and the bound of its standard error, in the broadcast shape of the signals.

    The bound is the sum of abs(dlaw/dp) times the error of each parameter p: for any correlation of
    the parameters the error is not larger.

    law: on symbols of the body's parameters and of the signals
    signals: symbol of `effects.SIGNALS` or of a hidden state -> array
    Parameters that are fixed, or have no standard error, count as exact.
    """
    numbers, symbols, names = body.numbers(), body.symbols(), list(signals)
    values = [np.asarray(v, dtype=float) for v in signals.values()]
    shape = np.broadcast_shapes(*(v.shape for v in values))

    def at(expression: sp.Expr) -> Array:
        call = sp.lambdify(names, expression.subs(numbers), "numpy")
        return np.broadcast_to(np.asarray(call(*values), dtype=float), shape)

    error = np.zeros(shape)
    for name, value in body.parameters.items():
        if not value.fixed and math.isfinite(value.stderr) and law.has(symbols[name]):
            error = error + np.abs(at(sp.diff(law, symbols[name]))) * value.stderr
    return at(law), error
