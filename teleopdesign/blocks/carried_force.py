"""The force that a transmission carries from its output to the load.

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

from dataclasses import replace
from functools import lru_cache

import sympy as sp

from ..base.errors import ModelError
from ..base.frozen import Frozen
from ..effects import SIGNALS, Effect, sort_by_action
from .body_equation import BodyEquation, body_symbols
from .environment import contact_force

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
