"""The equation of one body, composed from the laws of its effects by their roles.

A transmission carries a force from its output to the load:

    carried = inertia a + forces of the place - interaction        along a measured motion
            = acting force - damping - friction                    by the body's equation

Gear teeth press on each other with this force. An actuator that is driven by a voltage loses a part
of its acting force to the back-EMF before the gears: friction of the gears then follows the carried
force, not the acting force. Forces that depend on the velocity, and forces with hidden states,
count as forces before the transmission; all others are a part of its load.

Friction that grows with the carried force reduces this force. The second form is solved for the
carried force, with the friction of a body that slides or starts to slide:

    level = A + M abs(carried),  y = acting force - damping - A sgn v
    carried = y / (1 + M sgn(v y))
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import sympy as sp

from ..base.errors import ModelError
from ..base.frozen import Frozen
from ..effects import BLOCK_EFFECTS, CONTACT_ROLES, INERTIA, SIGNALS, Effect, sort_by_action

CONTACT = BLOCK_EFFECTS["environment"]


def contact_force(effects: Sequence[Effect]) -> sp.Expr:
    """Force of the environment that resists the body; 0 where no effect is a contact."""
    if not any(e.role in CONTACT_ROLES for e in effects):
        return sp.S(0)
    penetration = SIGNALS["position"] - CONTACT.symbols()["contact_position"]
    felt: sp.Expr = penetration
    for effect in effects:
        if effect.role == "contact_shape":
            felt = effect.expression({"penetration": penetration})
    laws = (e.expression({"penetration": felt}) for e in effects if e.role == "contact")
    force = sp.Add(*laws)
    return sp.Piecewise((force, sp.And(penetration > 0, force > 0)), (0, True))


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


_CARRIED, _DIRECTION = SIGNALS["carried_force"], SIGNALS["direction"]
#: what makes a force one of the actuator's side
_BEFORE = tuple(SIGNALS[n] for n in ("velocity", "direction", "acting_force", "carried_force"))
#: least divisor 1 + M sgn(v y). From M = 1 on a load that drives a gear back locks it, which is a
#: collision. The lock is a brake of up to 100 times the force instead, which steps can resolve
LOCKED = 0.01


# asked for at every evaluation of a residual, and at every simulation


@lru_cache(maxsize=256)
def carried_force(effects: tuple[Effect, ...]) -> sp.Expr:
    """Carried force on signals of a measured motion, positive as the acting force."""
    forces = sum((e.expression() for e in _of_the_load(effects)), sp.S(0))
    moved = body_symbols(effects)["inertia"] * SIGNALS["acceleration"]
    return moved + forces + contact_force(effects) - SIGNALS["interaction_force"]


def solve_carried_force(equation: BodyEquation, effects: tuple[Effect, ...]) -> BodyEquation:
    """The equation with the carried force solved for, in terms of acting force and motion.

    raises ModelError: the friction level is not a constant part plus a part in proportion to
        abs(carried force), for each direction
    """
    if not any(e.has(_CARRIED) for e in (equation.friction, *equation.rates.values())):
        return equation
    carried = _solve(equation.level, effects)
    return replace(
        equation,
        level=equation.level.subs(_CARRIED, carried),
        friction=equation.friction.subs(_CARRIED, carried),
        rates=Frozen({s: rate.subs(_CARRIED, carried) for s, rate in equation.rates.items()}),
    )


def _of_the_load(effects: tuple[Effect, ...]) -> list[Effect]:
    """Forces behind the transmission."""
    forces = sort_by_action(effects, "force")
    return [e for e in forces if not e.states and not e.expression().has(*_BEFORE)]


@lru_cache(maxsize=256)
def _solve(level: sp.Expr, effects: tuple[Effect, ...]) -> sp.Expr:
    """Carried force that balances all forces on a sliding body.

    raises ModelError: as `solve_carried_force`
    """
    load = _of_the_load(effects)
    before = [e.expression() for e in sort_by_action(effects, "force") if e not in load]
    base = level.subs(_CARRIED, 0)
    ahead, back = (level.subs(_CARRIED, way) - base for way in (1, -1))
    for way, slope in ((2, ahead), (-2, back)):
        if sp.simplify(level.subs(_CARRIED, way) - base - 2 * slope) != 0:
            raise ModelError(
                "friction level: not in proportion to now.carried_force: such a law has no "
                "simulated form"
            )
    rest = SIGNALS["acting_force"] - sp.Add(*before) - base * _DIRECTION
    slope = ahead if ahead == back else sp.Piecewise((ahead, rest > 0), (back, True))
    return rest / sp.Max(1 + slope * _DIRECTION * sp.sign(rest), sp.Float(LOCKED))
