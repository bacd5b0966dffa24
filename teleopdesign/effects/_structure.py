"""Structures: two sides of one body with a coupling between them; the hand holds the tip.

    m_t dv_t/dt = coupling + interaction force - contact - dry friction of the tip
    (m - m_t) a = acting force - coupling - ...

An effect states coupling(now, p), the force between the sides, once: on `now.stretch`, position
less that of the tip, and `now.stretch_rate`. From it follow the law of one body with a hidden tip,
the contact of the tip, and the connection of two bodies (`realise/tips.py`).

The inertia m of the body includes both sides, so with a stiff coupling the body is the rigid one.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from types import SimpleNamespace
from typing import Any

import sympy as sp

from ..base.arguments import check_types
from ..base.errors import ModelError
from ..base.recipes import remember
from ..base.units import MAINS
from ._effect import SIGNALS, Effect, Energy, Parameter, State
from ._facts import RecordFacts

Coupling = Callable[[Any, Any], Any]
#: a fitted resonance may be a hum if its frequency is within BESIDE (relative) of the mains and its
#: damping ratio is below TONE. Higher limits would doubt true transmissions
BESIDE, TONE = 0.05, 0.1
#: unexplained force over the friction of a tip, up to which this friction keeps it in step. Two
#: simulated gears are named whole with 2, 3, 5 and 30. With 1 one of them is taken for slipping
#: springs; without a bound, a trace of friction would change the whole motion of a tip
HOLDS = 3.0
#: a gap counts if K g/2 is at least this part of the largest measured force: this is the largest
#: difference between the coupling and a spring without a gap. Half a percent is less than models of
#: real machines leave. A lower limit names other differences from a spring a gap; a higher one
#: misses a small gap in a soft transmission
OBSERVABLE = 0.005


@check_types
def make_structure(
    *,
    coupling: Coupling,
    parameters: Mapping[str, Parameter],
    following: float = 0.0,
    energy: Energy = "supplies",
    linear: bool = False,
    source: str = "",
    plausible: Callable[[Any, RecordFacts], str | None] | None = None,
    undetermined: Callable[[Any, RecordFacts], str | None] | None = None,
) -> Effect:
    """The effect of a coupling between the actuator's side and a tip; absent: zero tip inertia.

    parameters: with `tip_inertia`, and with `stiffness` where `following` is not 0
    following: along a measured motion the unexplained force r corrects the tip's position by the
        velocity -rate r / K. `following` is the rate over the tip's natural frequency in contact
        and its part of the body's inertia: a lighter tip, whose force is less visible, is corrected
        less. The force for this, m_t rate / K dr/dt, is unexplained too. 0: no correction
    plausible: as in `Effect`; None: the tip's inertia must be a part of the body's
    undetermined: as in `Effect`
    raises ModelError: a parameter is missing
    """
    for name in ("tip_inertia", "stiffness") if following else ("tip_inertia",):
        if name not in parameters:
            raise ModelError(f'make_structure: found no parameter "{name}", expected one')

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
        plausible=plausible or tip_is_part,
        undetermined=undetermined,
        source=source,
    )


def rings_like_a_hum(p: Any, facts: RecordFacts) -> str | None:
    """A sentence on a tip that rings close to the mains' frequency; else None."""
    natural = math.sqrt(p.stiffness / p.tip_inertia)
    frequency = natural / (2.0 * math.pi)
    mains = min(MAINS, key=lambda f: abs(f - frequency))
    rings = p.damping < 2.0 * TONE * p.tip_inertia * natural
    if abs(frequency - mains) > BESIDE * mains or not rings:
        return None
    return (
        f"the tip rings at {frequency:.3g} Hz, close to the {mains:g} Hz of the mains: hum looks "
        "much the same. A record at rest with the drive on decides"
    )


def tip_is_part(p: Any, facts: RecordFacts) -> str | None:
    """A sentence where the tip's inertia is not less than that of the whole body; else None."""
    whole = facts.body["inertia"]
    if p.tip_inertia < whole:
        return None
    return (
        f"a tip of {facts.text(p.tip_inertia, 'inertia')} is no part of a body of "
        f"{facts.text(whole, 'inertia')}: no inertia is left for the actuator side; the "
        "effect imitates something else that lags behind the motion"
    )


def tip_springs_back(p: Any, facts: RecordFacts) -> str | None:
    """A sentence where the tip does not oscillate on its spring, or as `tip_is_part`; else None.

    Belts, cables and gears oscillate with damping ratios of some hundredths to a half. From a ratio
    of one on there is no resonance: the tip only lags behind the motion, as many other effects do.
    """
    critical = 2.0 * math.sqrt(p.stiffness * p.tip_inertia)
    if p.damping < critical or not critical:
        return tip_is_part(p, facts)
    ratio = p.damping / critical
    return (
        f"a tip with a damping ratio of {ratio:.3g} creeps and does not spring back: the effect "
        "imitates something else that lags behind the motion"
    )


def gap_is_observable(p: Any, facts: RecordFacts) -> str | None:
    """A sentence where the gap is not crossed or hardly changes the force, or as `tip_is_part`."""
    if math.isinf(facts.stroke):
        return (
            f"a gap of {facts.text(p.gap, 'position')} is crossed once at most where the motion "
            "never reverses: the effect imitates the beginning of friction in a record"
        )
    worth = p.stiffness * p.gap / 2
    if worth >= OBSERVABLE * facts.force:
        return tip_is_part(p, facts)
    return (
        f"a gap of {facts.text(p.gap, 'position')} changes the force by no more than "
        f"{facts.text(worth, 'force')}, and {facts.text(facts.force, 'force')} act: the effect "
        "imitates a transmission that is no linear spring, or friction behind the transmission"
    )


@lru_cache(maxsize=64)  # laws compare by identity: one structure, one kernel
def make_touching_structure(structure: Effect, contact: sp.Expr) -> Effect:
    """A structure whose tip touches the environment, in place of the actuator's side.

    contact: force of the environment that resists the motion, on the body's motion in `SIGNALS`
    """
    assert structure.coupling is not None
    tip = replace(structure.states["tip_velocity"], rate=_accelerate(structure.coupling, contact))
    states = {**structure.states, "tip_velocity": tip}
    return remember(replace(structure, states=states), make_touching_structure, structure, contact)


@lru_cache(maxsize=64)
def make_rubbing_structure(structure: Effect, level: sp.Expr) -> Effect:
    """A structure whose tip has dry friction.

    level: of this friction, on parameters of the body's effects
    """
    tip = replace(structure.states["tip_velocity"], dry=lambda now, p: level / p.tip_inertia)
    position = structure.states["tip_position"]
    if position.correction is not None:
        position = replace(position, correction=_against_friction(position.correction, level))
    states = {"tip_position": position, "tip_velocity": tip}
    return remember(replace(structure, states=states), make_rubbing_structure, structure, level)


def _against_friction(correction: Coupling, level: sp.Expr) -> Coupling:
    """The correction by what exceeds a multiple of a friction level of the unexplained force.

    Dry friction stops a tip between its meetings, so that it stays in step by itself. And it holds
    a tip without a force for the correction: a light one would follow any machine.
    """

    def beyond(now: Any, p: Any) -> sp.Expr:
        left, held = now.unexplained, HOLDS * level
        more = sp.Piecewise((left - held, left > held), (left + held, left < -held), (0, True))
        return correction(SimpleNamespace(**{**vars(now), "unexplained": more}), p)

    return beyond


def _join(coupling: Coupling, now: Any, p: Any) -> sp.Expr:
    """Force of the coupling between the body and its hidden tip."""
    stretch, rate = now.position - now.tip_position, now.velocity - now.tip_velocity
    return coupling(SimpleNamespace(stretch=stretch, stretch_rate=rate), p)


def _tip_velocity(now: Any, p: Any) -> sp.Expr:
    return now.tip_velocity


def _tip_inertia(p: Any) -> sp.Expr:
    return p.tip_inertia


def _accelerate(coupling: Coupling, contact: sp.Expr = sp.S.Zero) -> Coupling:
    """Acceleration of the tip, with the force of an environment on it."""

    def tip_acceleration(now: Any, p: Any) -> sp.Expr:
        at_tip = {SIGNALS["position"]: now.tip_position, SIGNALS["velocity"]: now.tip_velocity}
        outside = now.interaction_force - contact.subs(at_tip)
        return (_join(coupling, now, p) + outside) / p.tip_inertia

    return tip_acceleration


def _lead_back(following: float) -> Coupling:
    """Velocity that corrects a tip's position by the unexplained force."""

    def towards(now: Any, p: Any) -> sp.Expr:
        rate = following * sp.sqrt(p.stiffness / p.tip_inertia) * p.tip_inertia / now.inertia
        return -rate * now.unexplained / p.stiffness

    return towards
