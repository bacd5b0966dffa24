"""Bodies prepared for simulation: without absent effects, ideal friction with a short bristle."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import sympy as sp

from ..base.errors import ModelError
from ..blocks import Body, MatrixImpedance
from ..controllers import Controller, require_exact_steps
from ..diagrams import Attached, Block, Control, Diagram, Linked, Moving, with_shared_states
from ..effects import SIGNALS
from .bristle import with_stop
from .tips import led_motion, linear_tips, with_tips
from .traced import numpy_function

#: m/s or rad/s: a speed above which no friction level changes
_FAST = 1e6


def without_absent(body: Body, *, surely: bool = False) -> Body:
    """The body without absent effects, effects that need them, and parameters that are zero.

    An optional parameter at zero is left out too, because the equations are simpler without it.
    surely: keep effects whose values have a standard error, because they may be present
    """
    values = body.parameters

    def exact(name: str) -> bool:
        return not surely or values[name].fixed or not math.isfinite(values[name].stderr)

    def equals(name: str, value: float) -> bool:
        return values[name].value == value and exact(name)

    gone = {
        e.name
        for e in body.effects
        if e.absent and all(equals(f"{e.name}.{n}", v) for n, v in e.absent.items())
    }
    levels = {e.name for e in body.effects if e.role == "friction_level"}
    if levels <= gone:
        gone |= {e.name for e in body.effects if e.role == "friction_shape"}
    if any(e.role == "structure" for e in body.effects if e.name in gone):
        gone |= {e.name for e in body.effects if e.role == "tip_level"}
    needed = {n for e in body.effects if e.name not in gone for n in e.needs}
    gone -= needed
    # an effect that needs others is removed before them
    while gone:
        held = {n for e in body.effects for n in e.needs}
        for name in sorted(gone - held):
            body = body.without_effect(name)
        gone &= held
    for effect in body.effects:
        for name, parameter in effect.parameters.items():
            if parameter.optional and equals(f"{effect.name}.{name}", 0.0):
                body = body.without_parameter(effect.name, name)
    return body


def check_levels(body: Body, where: str) -> None:
    """Refuse friction below zero in a direction of motion, at rest or in fast sliding.

    A bristle of such friction would grow without bound while it slides, and the force with it.
    raises ModelError: with the level and its effects
    """
    levels = least_levels(body, body.numbers().get) if may_be_negative(body) else {}
    for way, level in levels.items():
        if level < 0:
            names = ", ".join(e.name for e in body.effects if e.role == "friction_level")
            raise ModelError(
                f"{where}: friction of {float(level):g} {body.unit('coulomb.level')} {way} "
                f"({names}): expected no less than 0"
            )


def may_be_negative(body: Body) -> bool:
    """Whether an effect of the friction level does not declare itself non-negative."""
    levels = (e for e in body.effects if e.role == "friction_level")
    return not all("non-negative" in e.always for e in levels)


def least_levels(body: Body, value: Callable[[sp.Symbol], Any]) -> dict[str, Any]:
    """Direction -> least friction level of the body, at rest and in fast sliding.

    value: symbol of a parameter -> number or array; levels have its shape
    """
    equation = body.equation()
    at_rest = dict.fromkeys(SIGNALS.values(), 0) | dict.fromkeys(equation.rates, 0)
    levels = {}
    for way, direction in (("forward", 1), ("backward", -1)):
        speeds = (0.0, direction * _FAST)
        now = {SIGNALS["direction"]: direction}
        at = [equation.level.subs(at_rest | now | {SIGNALS["velocity"]: v}) for v in speeds]
        symbols = sorted(set().union(*(x.free_symbols for x in at)), key=str)
        call = numpy_function(symbols, at)
        # numpy combines conditions of a law only if all arrays have the same length
        levels[way] = np.minimum(*call(*np.broadcast_arrays(*map(value, symbols))))
    return levels


def realise_in_computer(diagram: Diagram, period: float) -> Diagram:
    """The diagram with controllers as a computer of this period (s) realises them.

    States that several controllers share exist once.
    raises ModelError: a state has no exact step
    """
    realised = {
        part.name: part.controller.sampled(period)
        for part in diagram.controls
        if isinstance(part.controller, Controller) and not part.analog
    }
    require_exact_steps(stage for law in realised.values() for stage in law.stages)
    return with_shared_states(_with_blocks(diagram, realised))


def without_no_delay(controller: Controller) -> Controller:
    """The controller without dead times that are zero."""
    stages = tuple(g for g in controller.stages if g.value_of("dead_time") != 0.0)
    return controller if len(stages) == len(controller.stages) else Controller(stages)


def _with_blocks(diagram: Diagram, contents: Mapping[str, Body | Controller]) -> Diagram:
    """The diagram with these contents of its blocks, by name; itself where nothing changes."""

    def placed(part: Block) -> Block:
        if part.name not in contents:
            return part
        new = contents[part.name]
        if isinstance(new, Controller) and isinstance(part, Control):
            same = new is part.controller or new.stages == part.controller.stages  # type: ignore[union-attr]
            return part if same else replace(part, controller=new)
        assert isinstance(new, Body) and isinstance(part, Moving | Attached)
        return part if new is part.body else replace(part, body=new)

    blocks = tuple(map(placed, diagram.blocks))
    changed = any(new is not old for new, old in zip(blocks, diagram.blocks, strict=True))
    return replace(diagram, blocks=blocks) if changed else diagram


def prepare_for_simulation(
    diagram: Diagram, deflection: float, prescribed: Iterable[str] = ()
) -> Diagram:
    """The diagram with bodies for simulation: no absent effects, ideal friction with a bristle.

    deflection: of the bristle, m or rad;  prescribed: prescribed motions
    raises ModelError: a block is known by its name only, or a friction level is negative
    """
    bodies: dict[str, Body | Controller] = {}
    for part in diagram.blocks:
        content = part.controller if isinstance(part, Control) else part.body
        if not isinstance(content, Body | MatrixImpedance | Controller):
            raise ModelError(f"{diagram.name}: {part.name} is known by its name only, no equations")
        if isinstance(content, Controller):
            bodies[part.name] = without_no_delay(content)
        if isinstance(content, Body):
            there = without_absent(content)
            check_levels(there, f"{diagram.name}: {part.name}")
            bodies[part.name] = with_stop(there, deflection)
    apart = with_tips(_with_blocks(diagram, bodies), prescribed=prescribed)
    # tips with dry friction need a bristle, too
    tips = {b.name: with_stop(b.body, deflection) for b in apart.bodies if isinstance(b.body, Body)}
    return _with_blocks(apart, dict(tips))


def refuse_massless(diagram: Diagram, prescribed: Iterable[str] = ()) -> None:
    """Raise ModelError if nothing on a motion has inertia: no acceleration follows from its forces.

    Motions to which kinematics or a linked impedance may give inertia are not judged.
    """
    linked = {m for b in diagram.blocks if isinstance(b, Linked) for m in b.motions}
    for part in diagram.blocks if not diagram.kinematics else ():
        if not isinstance(part, Moving) or part.motion in linked.union(prescribed):
            continue
        on_it = [b.body for b in diagram.bodies if b.motion == part.motion]
        if all(isinstance(body, Body) and _has_no_inertia(body) for body in on_it):
            raise ModelError(
                f"{diagram.name}: nothing on {part.motion} has inertia, so no acceleration "
                f"follows from its forces: {part.name}.inertia must be more than 0"
            )


def _has_no_inertia(body: Body) -> bool:
    if body.parameters["inertia"].value > 0:
        return False
    inertia = sp.sympify(body.equation().inertia).subs(body.numbers())
    return not inertia.free_symbols and float(inertia) == 0


def linear_parted(diagram: Diagram, motions: tuple[str, ...]) -> tuple[Diagram, Mapping[str, str]]:
    """The diagram with linear structures as two bodies, and each prescribed motion -> the led one.

    A hand moves the tip, so a prescribed motion is that of the tip.
    Backlash has no linear form: there the body stays whole, and its left-out effects name it.
    """
    apart = linear_tips(diagram)
    there = {name: led_motion(diagram, name) for name in motions}
    return apart, {name: tip if tip in apart.signals else name for name, tip in there.items()}


def simulated_parted(diagram: Diagram, motion: str) -> tuple[Diagram, str]:
    """The diagram with every structure as two bodies, and the motion that a hand leads."""
    for part in diagram.bodies:
        if isinstance(part.body, Body) and any(e.role == "structure" for e in part.body.effects):
            diagram = diagram.with_block(part.name, without_absent(part.body))
    return with_tips(diagram), led_motion(diagram, motion)
