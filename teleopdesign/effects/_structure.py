"""Structures: two sides of one body, joined by a coupling, of which a hand leads the tip.

    m_t dv_t/dt = coupling + interaction force - contact - dry friction of the tip
    (m - m_t) a = acting force - coupling - ...

An effect states coupling(now, p), the force between the sides, once: on `now.stretch`, position
less that of the tip, and `now.stretch_rate`. From it follow the law of one body with a hidden tip,
the contact that the tip has, and the joint of two bodies (`realise/tips.py`).

The inertia m of the body counts both sides, as what moves together where nothing gives: a stiff
coupling is the rigid body.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from types import SimpleNamespace
from typing import Any

import sympy as sp

from ..arguments import checked
from ..errors import ModelError
from ..recipes import remember
from ._effect import SIGNALS, Effect, Energy, Parameter, State

Coupling = Callable[[Any, Any], Any]


@checked
def make_structure(
    *,
    coupling: Coupling,
    parameters: Mapping[str, Parameter],
    following: float = 0.0,
    energy: Energy = "supplies",
    linear: bool = False,
    source: str = "",
) -> Effect:
    """The effect of a coupling between the actuator's side and a tip; absent: a tip of no inertia.

    parameters: among them `tip_inertia`, and `stiffness` where the tip is led
    following: along a measured motion the force r that is left unexplained leads the tip back to
        its course, by the velocity -rate r / K. This is the rate over the tip's natural frequency
        in contact and its part of the body's inertia: a lighter tip, whose force shows less, is led
        by less. What it takes to lead it, m_t rate / K dr/dt, is left unexplained too. 0: runs free
    raises ModelError: a parameter is missing
    """
    for name in ("tip_inertia", "stiffness") if following else ("tip_inertia",):
        if name not in parameters:
            raise ModelError(f'structure: found no parameter "{name}", expected one')

    def law(now: Any, p: Any) -> sp.Expr:
        return _join(coupling, now, p) + now.interaction_force - p.tip_inertia * now.acceleration

    return Effect(
        role="structure",
        coupling=coupling,
        law=law,
        states={
            "tip_position": State(
                "position",
                _tip_velocity,
                "position",
                _lead_back(following) if following else None,
            ),
            "tip_velocity": State("velocity", _accelerate(coupling), "velocity"),
        },
        led=_tip_inertia if following else None,
        parameters=parameters,
        absent={"tip_inertia": 0.0},
        energy=energy,
        linear=linear,
        source=source,
    )


@lru_cache(maxsize=64)  # laws compare by identity: one structure, one kernel
def touching(structure: Effect, contact: sp.Expr) -> Effect:
    """A structure whose tip, and not the actuator's side, touches the environment.

    contact: force that an environment takes, on the body's motion in `SIGNALS`
    """
    assert structure.coupling is not None
    tip = replace(structure.states["tip_velocity"], rate=_accelerate(structure.coupling, contact))
    states = {**structure.states, "tip_velocity": tip}
    return remember(replace(structure, states=states), touching, structure, contact)


@lru_cache(maxsize=64)
def rubbing(structure: Effect, level: sp.Expr) -> Effect:
    """A structure whose tip dry friction of that level holds.

    level: on parameters of the body's effects
    """
    tip = replace(structure.states["tip_velocity"], dry=lambda now, p: level / p.tip_inertia)
    states = {**structure.states, "tip_velocity": tip}
    return remember(replace(structure, states=states), rubbing, structure, level)


def _join(coupling: Coupling, now: Any, p: Any) -> sp.Expr:
    """Force between the body and its hidden tip."""
    stretch, rate = now.position - now.tip_position, now.velocity - now.tip_velocity
    return coupling(SimpleNamespace(stretch=stretch, stretch_rate=rate), p)


def _tip_velocity(now: Any, p: Any) -> sp.Expr:
    return now.tip_velocity


def _tip_inertia(p: Any) -> sp.Expr:
    return p.tip_inertia


def _accelerate(coupling: Coupling, contact: sp.Expr = sp.S.Zero) -> Coupling:
    """Acceleration of the tip, which touches an environment."""

    def tip_acceleration(now: Any, p: Any) -> sp.Expr:
        at_tip = {SIGNALS["position"]: now.tip_position, SIGNALS["velocity"]: now.tip_velocity}
        outside = now.interaction_force - contact.subs(at_tip)
        return (_join(coupling, now, p) + outside) / p.tip_inertia

    return tip_acceleration


def _lead_back(following: float) -> Coupling:
    """Velocity that corrects a tip's position by the force that the model leaves unexplained."""

    def towards(now: Any, p: Any) -> sp.Expr:
        rate = following * sp.sqrt(p.stiffness / p.tip_inertia) * p.tip_inertia / now.inertia
        return -rate * now.unexplained / p.stiffness

    return towards
