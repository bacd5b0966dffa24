"""Friction in linear theory: taken out, or as a damper; and whether the whole diagram is stable.

At a speed v > 0 friction is the damper level(v)/v, the same secant by which a smoothed cancellation
is frozen. At v = 0 friction has no linear form. A diagram that leaves friction out, and keeps its
cancellation, has a negative damper without its counterpart.
"""

from __future__ import annotations

from collections.abc import Collection

import sympy as sp

from ..base.errors import ModelError
from ..blocks import Body, Value
from ..controllers import CANCEL
from ..derive.all_states import all_states
from ..diagrams import Attached, Diagram, Moving
from ..effects import EFFECTS, SIGNALS
from .late_zeros import describe_growth

FRICTION = ("friction_level", "friction_factor", "friction_speed", "friction_shape")


def without_friction(body: Body, *, damping: float = 0.0, stiffness: float = 0.0) -> Body:
    """The body without friction; a damper (N s/m) and spring (N/m) are added, sums at least 0."""
    for effect in [e for e in reversed(body.effects) if e.role in FRICTION]:
        body = body.without_effect(effect.name)
    for name, parameter, more in (
        ("viscous", "damping", damping),
        ("spring", "stiffness", stiffness),
    ):
        full = f"{name}.{parameter}"
        if not body.has(name):
            body = body.with_effect(EFFECTS[name])
        value = max(body.parameters[full].value + more, 0.0)
        body = body.with_values({full: Value(value)})
    return body


def with_frozen_friction(diagram: Diagram, speed: float) -> Diagram:
    """The diagram with friction as dampers at a constant speed > 0, m/s or rad/s.

    A level that also depends on place, load or time stays what it is: it is left out, and named.
    """
    for part in diagram.blocks:
        body = part.body if isinstance(part, Moving | Attached) else None
        if not isinstance(body, Body) or body.level() == 0:
            continue
        steady = {SIGNALS["velocity"]: sp.Float(speed), SIGNALS["direction"]: sp.S(1)}
        steady |= {x: sp.Float(speed) for x in body.equation().rates if x.name.endswith("_film")}
        level = body.level().subs(steady).subs(body.numbers())
        if level.is_number:
            frozen = without_friction(body, damping=float(level) / speed)
            diagram = diagram.with_block(part.name, frozen)
    return diagram


def cancellations_left_over(diagram: Diagram, left_out: Collection[str]) -> tuple[str, ...]:
    """Names of controllers that cancel friction in linear theory, while friction is left out."""
    gone = {
        f"{part.name}.{effect.name}"
        for part in diagram.bodies
        if isinstance(part.body, Body)
        for effect in part.body.effects
        if effect.role in FRICTION
    }
    if not gone & set(left_out):
        return ()
    return tuple(
        part.name
        for part in diagram.controls
        if part.name not in left_out
        and any(
            stage.law.bound or (stage.law.name == CANCEL and _takes_friction(stage.values))
            for stage in part.stages
        )
    )


def _takes_friction(names: Collection[str]) -> bool:
    """Whether parameters such as "coulomb.level" are those of friction."""
    effects = {name.partition(".")[0] for name in names} & EFFECTS.keys()
    return any(EFFECTS[effect].role in FRICTION for effect in effects)


def growing_modes(diagram: Diagram, *, speed: float = 0.0) -> str | None:
    """Modes of the whole linear diagram that grow, in words, continuous; "" where none does.

    Every state counts, also one that no transfer function shows.
    returns: None where a block is sampled, code or measured, so that nothing is known
    """
    for part in diagram.controls:
        if part.is_code or part.is_measured or any(s.law.in_z is not None for s in part.stages):
            return None
    try:
        states = all_states(diagram, speed=speed)
        determinant = states.determinant()
        return describe_growth(determinant, states.times) if determinant else None
    except (ModelError, sp.PolynomialError):
        return None
