"""What a user's effects and laws declare, derived from their equations; nothing is believed.

An effect of the catalogue, known by its whole content, is checked by the tests of the package. What
a user's effect does with energy follows from a dissipation inequality with a storage function, by
interval arithmetic over all signals, states and parameters. The bound and the shape of a law follow
as `law_facts` says. What could not be derived leaves a claim open, and the claim names the step.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.integrals.manualintegrate import manualintegrate

from ..base.errors import ModelError
from ..blocks import Body
from ..controllers import Stage, broken_declarations
from ..diagrams import Control, Diagram
from ..effects import BLOCK_EFFECTS, EFFECTS, SIGNALS, Effect, acts_linearly
from ..realise.friction_interval import DIRECTION, lowest_of
from ..realise.reach import Reach
from .inequalities import ANY

_X, _V, _A = (SIGNALS[n] for n in ("position", "velocity", "acceleration"))
_DEFLECTION = sp.Symbol("deflection", real=True)


def is_shipped(effect: Effect) -> bool:
    """Whether an effect is from the catalogue, with or without its optional parameters.

    Its whole content counts: laws, states, role, and the bounds of its parameters.
    """
    known = {**EFFECTS, **BLOCK_EFFECTS}.get(effect.name)
    if known is None or not set(effect.parameters) <= set(known.parameters):
        return False
    for gone in set(known.parameters) - set(effect.parameters):
        if not known.parameters[gone].optional:
            return False
        known = known.without(gone)
    return _content(effect) == _content(known)


@lru_cache(maxsize=256)
def _content(effect: Effect) -> tuple[Any, ...]:
    """All of an effect on which its forces and what a claim says of them depend."""
    laws = effect.expression(), effect.rates(), effect.stops(), effect.dry_bounds()
    words = effect.role, effect.block, effect.energy, effect.linear, dict(effect.absent)
    states = {n: (s.quantity, s.start) for n, s in effect.states.items()}
    bounds = {n: (p.quantity, p.lower, p.upper) for n, p in effect.parameters.items()}
    return *laws, *words, states, bounds


def falsely_linear(diagram: Diagram) -> list[str]:
    """Names of effects and laws whose linear forms are not those of their equations.

    returns: "block.effect" for an effect, "block" for a controller
    """
    names = []
    for part in diagram.blocks:
        body = getattr(part, "body", None)
        if isinstance(body, Body):
            declaring = (e for e in body.effects if e.linear and not is_shipped(e))
            names += [f"{part.name}.{e.name}" for e in declaring if not acts_linearly(e)]
        if isinstance(part, Control):
            names += [part.name] * any(not is_kept(stage) for stage in part.stages)
    return names


@lru_cache(maxsize=1024)
def is_kept(stage: Stage) -> bool:
    """Whether the equations of a law keep what it declares, at the values of the stage."""
    return not broken_declarations(stage.law, stage)


def underived_energy(body: Body, reach: Reach | None = None, *, errors: float) -> dict[str, str]:
    """A user's effects that declare to supply no energy -> the step that does not follow.

    Friction levels and shapes of friction are judged elsewhere, whatever they declare.

    errors: standard errors of the parameters to either side
    """
    declaring = (
        e
        for e in body.effects
        if e.energy != "supplies" and not e.role.startswith("friction") and not is_shipped(e)
    )
    missing = {e.name: _missing_step(e, body, reach, errors) for e in declaring}
    return {name: step for name, step in missing.items() if step}


def _missing_step(effect: Effect, body: Body, reach: Reach | None, errors: float) -> str:
    """The first step of the dissipation inequality that fails, in words; "" where it holds."""
    law, rates = effect.expression(), effect.rates()
    if effect.role != "force":
        return f"no storage function is known of the role {effect.role}"
    if law.atoms(AppliedUndef) or effect.dry_bounds():
        return "its force depends on more than its signals and states now"
    inertia = sp.diff(law, _A)
    if inertia.free_symbols & {*SIGNALS.values(), *effect.state_symbols().values()}:
        return "its force is no constant inertia times the acceleration"
    force = law - inertia * _A
    if effect.energy == "stores" and force.free_symbols & set(SIGNALS.values()) - {_X}:
        return "its force is none of the position alone"
    moving = {z: rates[n] for n, z in effect.state_symbols().items()}
    ways = [(force, moving)]
    if len(moving) == 1:  # a state may be the place of an inner point: its deflection stores
        ((z, rate),) = moving.items()
        beyond = {_X: z + _DEFLECTION}
        ways.append((force.subs(beyond), {_DEFLECTION: _V - rate.subs(beyond)}))
    free = dict.fromkeys((*moving, _DEFLECTION), ANY)

    def least(power: sp.Expr) -> float:
        """A bound of a power at any motion, and at rest; any of its forms may show one."""
        forms = {sp.expand(power), sp.factor_terms(power)}
        at_rest = [{}, *({_V: 0, DIRECTION: way} for way in (-1, 0, 1))]
        return min(
            max(
                lowest_of(body, one.subs(now), reach, errors=errors, ranges=free)[0].low
                for one in forms
            )
            for now in at_rest
        )

    missing = [_missing_of_storage(inertia, *way, least=least) for way in ways]
    return "" if "" in missing else missing[0]


def _missing_of_storage(
    inertia: sp.Expr,
    force: sp.Expr,
    rates: Mapping[sp.Symbol, sp.Expr],
    *,
    least: Callable[[sp.Expr], float],
) -> str:
    """What is missing of a storage function V = m v^2/2 + U(x) + sum of V_i(z_i), in words.

    The terms of the force that depend on the position alone, or on one state alone, are U' and
    V_i'. With the rates r_i of the states,

        F v - dV/dt = (F - m a - U' - sum V_i') v + sum V_i' (v - r_i) >= 0

    least: a bound that an expression is never below
    """
    by_state: dict[sp.Symbol, sp.Expr] = dict.fromkeys(rates, sp.S(0))
    by_place, signals = sp.S(0), {*SIGNALS.values(), *rates}
    for term in sp.Add.make_args(sp.expand(force)):
        used = term.free_symbols & signals
        if used <= {_X}:
            by_place += term
        elif len(used) == 1 and used <= by_state.keys():
            by_state[used.pop()] += term
    power = (force - by_place - sp.Add(*by_state.values())) * _V
    power += sp.Add(*(f * (_V - rates[z]) for z, f in by_state.items()))
    wanted = {"its inertia": inertia, "the power that it takes": power}
    wanted |= {f"the energy of its state {z}": f * z for z, f in by_state.items()}
    for what, number in wanted.items():
        try:
            if not (low := least(number)) >= 0:
                return f"{what} may be {low:.3g}" if math.isfinite(low) else f"no bound of {what}"
        except ModelError as problem:
            return f"{what}: {problem}"
    return "" if _has_lowest(by_place, least) else "no lower bound of its potential energy"


def _has_lowest(force: sp.Expr, least: Callable[[sp.Expr], float]) -> bool:
    """Whether the potential of a force of the position is known to have a lower bound."""
    try:
        if least(force * _X) >= 0:
            return True
        potential = manualintegrate(force, _X)
        return not potential.has(sp.Integral) and math.isfinite(least(potential))
    except ModelError:
        return False
