"""The equation of one body, composed from the laws of its effects by their roles."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import sympy as sp

from ..base.frozen import Frozen
from ..effects import INERTIA, SIGNALS, Effect, sort_by_action
from .environment import contact_force


@dataclass(frozen=True)
class BodyEquation:
    """The composed equation of one body, in sympy, on the symbols of `effects.SIGNALS`.

    inertia: total inertia;  force: forces that are subtracted, without their part in the inertia
    level: friction level;  friction: friction force (sgn v times level without a friction shape)
    acting: acting force from `command`, with `delayed(...)` where the actuation has a delay
    rates: hidden state -> rate of change;  stages: states of the actuation among these
    """

    inertia: sp.Expr
    force: sp.Expr
    level: sp.Expr
    friction: sp.Expr
    acting: sp.Expr
    rates: Mapping[sp.Symbol, sp.Expr]
    stages: tuple[sp.Symbol, ...]


def compose_equation(effects: tuple[Effect, ...]) -> BodyEquation:
    """The equation of a body with these effects."""
    acceleration, velocity = SIGNALS["acceleration"], SIGNALS["velocity"]
    forces = [*sort_by_action(effects, "force"), *sort_by_action(effects, "structure")]
    force = sp.expand(sum((e.expression() for e in forces), sp.S(0)))
    share = force.coeff(acceleration, 1)
    rates: dict[sp.Symbol, sp.Expr] = {}
    level = friction_level(effects)
    friction = level * sp.sign(velocity)
    acting: sp.Expr = SIGNALS["command"]
    stages: list[sp.Symbol] = []
    for effect in effects:
        level_symbol = {"level": level} if effect.role == "friction_shape" else {}
        if effect.role == "actuation":
            continue
        symbols = effect.state_symbols()
        rates |= {symbols[n]: r for n, r in effect.rates(level_symbol).items()}
        if effect.role == "friction_shape":
            friction = effect.expression(level_symbol)
    for effect in sort_by_action(effects, "actuation"):
        symbols = effect.state_symbols()
        rates |= {symbols[n]: r for n, r in effect.rates({"command": acting}).items()}
        acting = effect.expression({"command": acting})
        stages += symbols.values()
    return BodyEquation(
        inertia=body_symbols(effects)["inertia"] + share,
        force=sp.expand(force - share * acceleration) + contact_force(effects),
        level=level,
        friction=friction,
        acting=acting,
        rates=Frozen(rates),
        stages=tuple(stages),
    )


def impedance_of(effects: tuple[Effect, ...], s: sp.Symbol) -> tuple[sp.Expr, tuple[str, ...]]:
    """Inertia s^2 plus the linear forms of effects, and names of effects without one."""
    z: sp.Expr = body_symbols(effects)["inertia"] * s**2
    left_out = []
    for effect in effects:
        if effect.role == "actuation":
            continue
        part = effect.linear_form(s)
        if part is None:
            left_out.append(effect.name)
        else:
            z += part
    return z, tuple(left_out)


def actuation_of(effects: tuple[Effect, ...], s: sp.Symbol) -> tuple[sp.Expr, tuple[str, ...]]:
    """Transfer function of the actuation stages, and names of stages without a linear form."""
    transfer: sp.Expr = sp.S(1)
    left_out = []
    for effect in sort_by_action(effects, "actuation"):
        part = effect.linear_form(s)
        if part is None:
            left_out.append(effect.name)
        else:
            transfer *= part
    return transfer, tuple(left_out)


# laws on symbols are asked for at every evaluation of a residual: they are built once


@lru_cache(maxsize=256)
def body_symbols(effects: tuple[Effect, ...]) -> dict[str, sp.Symbol]:
    """Parameter name -> sympy symbol: "coulomb.level" -> coulomb_level; "inertia" as well."""
    of_effects = {f"{e.name}.{n}": s for e in effects for n, s in e.symbols().items()}
    return {"inertia": INERTIA, **of_effects}


@lru_cache(maxsize=256)
def friction_level(effects: tuple[Effect, ...]) -> sp.Expr:
    """Sum of the levels times their factors, at the speed that it depends on."""
    factors = sort_by_action(effects, "friction_factor")
    level = sp.S(0)
    for effect in sort_by_action(effects, "friction_level"):
        of_this_level = [f.expression() for f in factors if not f.needs or effect.name in f.needs]
        level += effect.expression() * sp.Mul(*of_this_level)
    for effect in sort_by_action(effects, "friction_speed"):
        level = level.subs(SIGNALS["velocity"], effect.expression())
    return level
