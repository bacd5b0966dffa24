"""A body with compliance or backlash as two moving bodies, for simulation.

The body of a `Moving` block with an effect of role "structure" is divided at its transmission:

    Z_M      (m - m_t) with friction and actuator, on the motion L that sensors see
    Z_M_tip  m_t, on the motion L_tip; hand, loads and contact act here
    Z_M_transmission  the structure's force, from L - L_tip and its rate, from one to the other

in blocks that every simulated form knows already: the transmission is an analog law on the
difference of the two motions.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache
from types import SimpleNamespace
from typing import Any

import sympy as sp

from ..base.errors import ModelError
from ..blocks import Body
from ..controllers import ControlLaw, Controller, Stage
from ..diagrams import Attached, Block, Control, Diagram, Junction, Linked, Moving
from ..effects import CONTACT_ROLES, Effect


def tip(motion: str) -> str:
    """Name of the motion of the tip behind this motion."""
    return f"{motion}_tip"


def _structures(diagram: Diagram) -> list[tuple[Moving, Body, Effect]]:
    """The bodies that have a structure between two sides, each with it."""
    return [
        (part, part.body, effect)
        for part in diagram.moving
        if isinstance(part.body, Body)
        for effect in part.body.effects
        if effect.role == "structure"
    ]


def led_motion(diagram: Diagram, motion: str) -> str:
    """The motion that a hand leads: the tip's where the body has a structure, else this motion."""
    return tip(motion) if any(p.motion == motion for p, *_ in _structures(diagram)) else motion


def linear_tips(diagram: Diagram) -> Diagram:
    """The diagram with two bodies for each linear structure; absent structures are left out.

    A structure without a linear form (backlash) is not divided: linear forms leave it out, by name.
    """
    for part, body, structure in _structures(diagram):
        values = {n: body.parameters[f"{structure.name}.{n}"].value for n in structure.absent}
        if structure.linear and values == dict(structure.absent):
            diagram = diagram.with_block(part.name, body.without_effect(structure.name))
        elif structure.linear:
            diagram = _part_body(diagram, part, body, structure)
    return diagram


def with_tips(diagram: Diagram, *, prescribed: Iterable[str] = ()) -> Diagram:
    """The diagram with every body that has a structure as two bodies.

    prescribed: prescribed motions; of such a body only the tip's can be prescribed
    raises ModelError: the tip is not lighter than the body, or the actuator's side is prescribed
    """
    for part, body, structure in _structures(diagram):
        if part.motion in prescribed:
            raise ModelError(
                f"{diagram.name}: {part.motion} is the actuator's side of {structure.name}, which "
                f"no hand leads: give the motion {tip(part.motion)}"
            )
        diagram = _part_body(diagram, part, body, structure)
    return diagram


def _part_body(diagram: Diagram, part: Moving, body: Body, structure: Effect) -> Diagram:
    device, end = _sides(diagram, part, body, structure)
    values = body.parameters
    law = transmission(structure)
    numbers = {n: values[f"{structure.name}.{n}"].value for n in law.parameters}
    here, there = part.motion, tip(part.motion)
    force, twist = f"{part.name}_transmission", f"{here}_twist"
    joining = Controller((Stage(law, numbers),))
    split: list[Block] = [
        replace(part, body=device, loads={force: -1}),
        Moving(f"{part.name}_tip", end, there, force, part.loads, part.driver),
        Control(f"{part.name}_structure", joining, twist, force, twist, analog=True),
    ]
    blocks: list[Block] = []
    for block in diagram.blocks:
        if block is part:
            blocks += split
        elif isinstance(block, Attached) and block.motion == here:
            blocks.append(replace(block, motion=there))
        elif isinstance(block, Linked):
            motions = tuple(there if m == here else m for m in block.motions)
            blocks.append(replace(block, motions=motions))
        else:
            blocks.append(block)
    return replace(
        diagram,
        blocks=tuple(blocks),
        junctions=(*diagram.junctions, Junction(twist, {here: 1, there: -1})),
        # no sensor sees it: electronics do, and the transmission is wired as such
        measured=(*diagram.measured, there),
        texts={**diagram.texts, there: "motion of the tip, behind the transmission"},
    )


def _sides(diagram: Diagram, part: Moving, body: Body, structure: Effect) -> tuple[Body, Body]:
    """The actuator's side, and the tip with its contact effects.

    raises ModelError: the tip's inertia is not between zero and the body's
    """
    inertia = body.parameters["inertia"].value
    behind = body.parameters[f"{structure.name}.tip_inertia"].value
    if not 0 < behind < inertia:
        raise ModelError(
            f"{diagram.name}: {part.name}: the tip has {behind:g} {body.unit('inertia')} of the "
            f"body's {inertia:g}: it must be less, and more than none"
        )
    end = [e for e in body.effects if e.role in (*CONTACT_ROLES, "tip_level")]
    device = [e for e in body.effects if e not in (*end, structure)]
    of_tip = [move_to_tip_body(e) if e.role == "tip_level" else e for e in end]
    return _take(body, inertia - behind, device), _take(body, behind, of_tip)


def _take(body: Body, inertia: float, effects: list[Effect]) -> Body:
    """A body of this inertia with some of the effects of another one."""
    names = {e.name for e in effects}
    values = {n: v for n, v in body.parameters.items() if n.partition(".")[0] in names}
    values["inertia"] = replace(body.parameters["inertia"], value=inertia)
    return Body(body.axis, values, tuple(effects))


@lru_cache(maxsize=8)  # laws compare by identity
def move_to_tip_body(effect: Effect) -> Effect:
    """Friction of a tip, as the friction level of a separate body."""
    return replace(effect, role="friction_level", needs=frozenset())


@lru_cache(maxsize=8)  # laws compare by identity: one structure, one kernel
def transmission(structure: Effect) -> ControlLaw:
    """The force of a structure from the difference of its two motions, as a control law."""

    def force(now: Any, p: Any) -> sp.Expr:
        assert structure.coupling is not None
        return structure.coupling(SimpleNamespace(stretch=now.input, stretch_rate=now.velocity), p)

    parameters = {n: p for n, p in structure.parameters.items() if n != "tip_inertia"}
    law = ControlLaw(
        law=force, parameters=parameters, linear=structure.linear, source=structure.source
    )
    return law.named(structure.name, structure.text)
