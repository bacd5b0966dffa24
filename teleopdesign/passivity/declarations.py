"""Declarations of energy and of bounds in a user's files, checked before a claim uses them.

Tests check the declarations of the effects and laws in the catalogue. A declaration in a user's
file counts only where the equations show that it is true. They can show it for a force without
states that opposes the velocity for all values of its parameters, for a force that depends on
position alone, and for a law whose size algebra or interval arithmetic bounds. A declaration that
nothing has checked leaves the claim open, and the claim names it.
"""

from __future__ import annotations

import math

import sympy as sp

from ..base.errors import ModelError
from ..blocks import Body
from ..controllers import (
    CONTROLLERS,
    SIGNALS,
    Controller,
    Stage,
    broken_declarations,
    exact_decimal,
    make_exact,
    parameter_symbol,
)
from ..derive.polynomials import has_positive_root, is_non_negative
from ..diagrams import Control, Diagram
from ..effects import BLOCK_EFFECTS, EFFECTS, Effect, acts_linearly
from ..effects import SIGNALS as BODY_SIGNALS
from ..realise.damping_interval import least_damping
from ..realise.extremes import least_value
from ..realise.reach import Reach

_ANY = (-math.inf, math.inf)


def is_shipped(effect: Effect) -> bool:
    """Whether an effect is from the catalogue, with or without its optional parameters."""
    known = {**EFFECTS, **BLOCK_EFFECTS}.get(effect.name)
    if known is None or not set(effect.parameters) <= set(known.parameters):
        return False
    for gone in set(known.parameters) - set(effect.parameters):
        known = known.without(gone)
    same = (known.energy, known.linear) == (effect.energy, effect.linear)
    return same and known.expression() == effect.expression() and known.rates() == effect.rates()


def unchecked_energy(body: Body, reach: Reach | None = None, *, errors: float) -> tuple[str, ...]:
    """Names of a user's effects that declare to supply no energy while nothing shows this.

    Friction levels and shapes of friction are judged elsewhere, whatever they declare.

    errors: standard errors of the parameters to either side
    """
    declaring = (
        e
        for e in body.effects
        if e.energy != "supplies" and not e.role.startswith("friction") and not is_shipped(e)
    )
    return tuple(e.name for e in declaring if not _shows_energy(e, body, reach, errors))


def _shows_energy(effect: Effect, body: Body, reach: Reach | None, errors: float) -> bool:
    if effect.role != "force" or effect.states:
        return False
    if effect.energy == "stores":
        signals = effect.expression().free_symbols & set(BODY_SIGNALS.values())
        return bool(signals <= {BODY_SIGNALS["position"]})
    least = least_damping(body, [effect], reach, errors)
    return least is not None and least.low >= 0


def falsely_linear(diagram: Diagram) -> list[str]:
    """Names of effects and laws that are declared linear and are not.

    returns: "block.effect" for an effect, "block" for a controller
    """
    names = []
    for part in diagram.blocks:
        body = getattr(part, "body", None)
        if isinstance(body, Body):
            declaring = (e for e in body.effects if e.linear and not is_shipped(e))
            names += [f"{part.name}.{e.name}" for e in declaring if not acts_linearly(e)]
        if isinstance(part, Control) and isinstance(part.controller, Controller):
            names += [part.name] * any(not is_kept(stage) for stage in part.controller.stages)
    return names


def is_kept(stage: Stage) -> bool:
    """Whether the law of a stage keeps its declarations, as far as its equations show."""
    law = stage.law
    known = CONTROLLERS.get(law.name) is law or law.source == "python-control"
    return known or not broken_declarations(law)


def keeps_its_bound(stage: Stage) -> bool:
    """Whether the force of a law certainly stays within the bound that the law declares."""
    law, bound = stage.law, stage.value_of("bound")
    if bound is None or CONTROLLERS.get(law.name) is law:
        return bound is not None
    if not is_kept(stage):
        return False
    if law.bristle_stiffness or law.smoothing:
        return True  # those shapes never leave their level
    if law.states:
        return False
    return all(_stays_within(Controller((stage,)), bound, way) for way in (1, -1))


def _stays_within(alone: Controller, bound: float, way: int) -> bool:
    """Whether a law without states stays within its bound at all speeds in one direction.

    way: 1 or -1, the sign of the velocity
    """
    v = sp.Symbol("v", positive=True)
    signals = {**SIGNALS, "velocity": way * v, "speed": v, "period": sp.S(0)}
    force = alone.equation("law", signals).output
    numbers = {parameter_symbol("law", n): x for n, x in alone.names().items()}
    square = sp.cancel(
        make_exact(force.subs({n: exact_decimal(x) for n, x in numbers.items()})) ** 2
    )
    if square.free_symbols <= {v} and square.is_rational_function(v):
        return _is_below(square, exact_decimal(bound) ** 2, v)
    share = sp.Symbol("share", positive=True)
    force = sp.cancel(force.subs(v, share / (1 - share)))  # every speed, and a range that ends
    ranges = {SIGNALS["input"]: _ANY, SIGNALS["travel_rate"]: _ANY, share: (0.0, 1.0)}
    ranges |= {n: (x, x) for n, x in numbers.items()}
    try:
        return min(least_value(sign * force, ranges).bound for sign in (1, -1)) >= -bound
    except ModelError:
        return False


def _is_below(square: sp.Expr, limit: sp.Expr, v: sp.Symbol) -> bool:
    """Whether 0 <= square <= limit for all v >= 0, exactly; the square is rational in v."""
    above, below = (sp.Poly(part, v) for part in sp.fraction(sp.together(square)))
    if below.eval(0) == 0 or has_positive_root(below.sqf_part()):
        return False  # it has a pole
    return is_non_negative(above * below) and is_non_negative((limit * below - above) * below)
