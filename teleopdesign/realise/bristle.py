"""Ideal friction as a simulation realises it: a spring that holds a body until it slides.

The spring of a simulation has a damper beside it, both held within the friction level, and slides
without creep (`with_stop`). A bristle that creeps before it slides (Dahl), or returns the energy
of its spring when the motion turns, moves a body that ideal friction would hold. With a deflection
of 10 um a driven mass was off by 3 % of its travel, and is by 1 %. Under 0.7 of its level and a
vibration of 0.2 beside it, a mass crept 0.4 mm in 2 s, and stays within the deflection.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp

from ..base.errors import ModelError
from ..base.recipes import remember
from ..blocks import Body
from ..blocks.body_equation import body_symbols, compose_equation, friction_level
from ..effects import EFFECTS, SIGNALS, Effect, State
from .traced import numpy_function

#: property of a bristle whose friction never exceeds the level (`Effect.always`)
WITHIN_LEVEL = "within the level"
#: m/s^2 or rad/s^2: an acceleration of the size that devices have, for the size of a load
LIVELY = 10.0
#: damping ratio of a bristle that moves a position by less than 1e-10 of its travel: none
UNDAMPED = 1e-9
#: part of the loaded friction level that must remain without a load for a damped bristle. The
#: damping of a LuGre bristle is a force of friction only at a steady level. With a level that goes
#: through zero a simulated servo left its record by 0.2 to 0.5 rad rms, with a twentieth by 0.02 to
#: 0.04, undamped by 0.016. Lower: such courses; higher: undamped contacts
STEADY = 0.2
#: least part of the loaded friction level that is simulated without a load, for a level of zero and
#: along records: with a level of zero the bristle has no stiffness there, and a simulated servo
#: left its record by 0.4 rad rms. Levels are known less well than to a part so small
LEAST = 0.002
#: place, speed (m, m/s; rad) and direction at which the size of a friction level is looked at
_ALONG = np.sin(np.arange(512.0)), np.array([[-1.0], [0.0], [1.0]]), np.array([[-1], [0], [1]])
#: forces in proportion to which a friction level may grow
_LOADS = SIGNALS["acting_force"], SIGNALS["carried_force"]


@lru_cache(maxsize=2)  # laws compare by identity
def _bristle(of_any_level: bool) -> Effect:
    """The effect presliding; of_any_level: for a tip or a user's friction level as well."""
    bristle = EFFECTS["presliding"]
    return replace(bristle, needs=frozenset()) if of_any_level else bristle


@lru_cache(maxsize=2)
def _rigid_bristle(of_any_level: bool) -> Effect:
    """The undamped bristle of ideal friction, whose force stays within the level in simulation."""
    plain = _bristle(of_any_level).without("bristle_damping")
    rigid = replace(plain, always=plain.always | {WITHIN_LEVEL})
    return remember(rigid, _rigid_bristle, of_any_level)


def _spring_and_damper(now: Any, p: Any) -> sp.Expr:
    """Force while it holds; `WITHIN_LEVEL` limits it where it slides."""
    return p.stiffness * now.bristle + p.bristle_damping * now.velocity


@lru_cache(maxsize=1)
def _stop() -> Effect:
    """The effect presliding without creep: its bristle follows the motion up to a stop."""
    bristle = State(
        "position", lambda now, p: now.velocity, stop=lambda now, p: now.level / p.stiffness
    )
    plain = _bristle(True)
    always = plain.always | {WITHIN_LEVEL}
    stop = replace(plain, law=_spring_and_damper, states={"bristle": bristle}, always=always)
    return remember(stop, _stop)


def with_stop(body: Body, deflection: float) -> Body:
    """Ideal Coulomb friction realised by a spring and a damper that slide together.

    deflection: of the spring where it begins to slide, m or rad. The damper is critical for the
        body's inertia on this spring
    returns: as `with_bristle`, with a bristle where the level follows a load: there the friction
        itself has a part in the level, which then cannot limit it
    raises ModelError: as `with_bristle`
    """
    if not _has_ideal_friction(body) or body.level().has(*_LOADS):
        return with_bristle(body, deflection)
    stiffness = _stiffness(body, deflection)
    damping = _damping(body, stiffness, 1.0)
    return body.with_effect(_stop(), {"stiffness": stiffness, "bristle_damping": damping})


def with_bristle(body: Body, deflection: float, *, damping_ratio: float = 0.0) -> Body:
    """Ideal Coulomb friction realised by a bristle that deflects by `deflection` before it slides.

    deflection: m or rad;  damping_ratio: of the inertia on this bristle while it sticks; of a
        friction that nearly vanishes without a load `UNDAMPED` at most
    returns: the body itself where it has no friction level, or a friction shape already
    raises ModelError: a deflection of zero, that of a record that never moves
    """
    if not _has_ideal_friction(body):
        return body
    stiffness = _stiffness(body, deflection)
    unloaded, level = _levels_by_load(body)
    if unloaded == 0.0:
        body = with_least_level(body)
    if unloaded < STEADY * level:
        damping_ratio = min(damping_ratio, UNDAMPED)
    of_any_level = bool(body.lacks(EFFECTS["presliding"]))
    if not damping_ratio:
        plain = _bristle(of_any_level).without("bristle_damping")
        # a level that follows a load may need the friction itself
        rigid = plain if body.level().has(*_LOADS) else _rigid_bristle(of_any_level)
        return body.with_effect(rigid, {"stiffness": stiffness})
    damping = _damping(body, stiffness, damping_ratio)
    return body.with_effect(
        _bristle(of_any_level), {"stiffness": stiffness, "bristle_damping": damping}
    )


def _has_ideal_friction(body: Body) -> bool:
    roles = {e.role for e in body.effects}
    return "friction_level" in roles and "friction_shape" not in roles


def _stiffness(body: Body, deflection: float) -> float:
    """Of a bristle that deflects by so much where the friction level is largest."""
    if not deflection > 0.0:
        raise ModelError("a bristle needs a length: the recorded position never moves")
    _, level = _levels_by_load(body)
    if (law := _level_in_motion(body.effects)) is not None:
        # where the level is small, the bristle would be far too soft elsewhere
        level = max(level, float(np.nanmax(law(*_ALONG, *body.numbers().values()))))
    return level / deflection


def _damping(body: Body, stiffness: float, ratio: float) -> float:
    return float(2.0 * ratio * (stiffness * body.parameters["inertia"].value) ** 0.5)


def with_least_level(body: Body) -> Body:
    """The body with a Coulomb level of at least `LEAST` of the friction level under a load."""
    unloaded, level = _levels_by_load(body)
    if not unloaded < LEAST * level or "coulomb.level" not in body.parameters:
        return body
    return body.with_values({"coulomb.level": LEAST * level})


@lru_cache(maxsize=16)  # bristles of several lengths are put into one body
def _levels_by_load(body: Body) -> tuple[float, float]:
    """Friction level at rest without a load, and under a typical load."""
    equation = body.equation()
    law = equation.level.subs(body.numbers())
    at_rest = dict.fromkeys(SIGNALS.values(), 0) | dict.fromkeys(equation.rates, 0)
    unloaded = float(law.subs(at_rest))
    if not law.has(*_LOADS):
        return unloaded, unloaded
    loaded = at_rest | dict.fromkeys(_LOADS, _typical_load(body))
    return unloaded, float(law.subs(loaded))


@lru_cache(maxsize=64)  # compiled once for all values of a fit
def _level_in_motion(effects: tuple[Effect, ...]) -> Any:
    """Unloaded friction level, by place, speed, direction, parameters; None: that at rest."""
    level, lagging = friction_level(effects), compose_equation(effects).rates
    signals = [SIGNALS[n] for n in ("position", "velocity", "direction")]
    fixed = dict.fromkeys(set(SIGNALS.values()) - set(signals), sp.S(0))
    law = level.xreplace(fixed | dict.fromkeys(lagging, sp.Abs(SIGNALS["velocity"])))
    varies, symbols = level.has(*signals, *lagging), body_symbols(effects).values()
    return numpy_function([*signals, *symbols], law) if varies else None


def _typical_load(body: Body) -> float:
    """A force of the size that the transmission of a body carries, N or N m.

    A level that is a part of the load is zero without one, and so would be its bristle's stiffness.
    """
    law = body.carried_force().subs(body.numbers())
    rest = dict.fromkeys((s for s in SIGNALS.values() if s != SIGNALS["position"]), 0)
    places = (0.0, 0.5 * math.pi, math.pi, 1.5 * math.pi) if body.axis == "revolute" else (0.0,)
    forces = (abs(float(law.subs(rest | {SIGNALS["position"]: x}))) for x in places)
    return max(forces) + LIVELY * body.parameters["inertia"].value
