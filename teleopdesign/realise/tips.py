"""A compliant transmission as two moving bodies: what is simulated of `transmission_compliance`.

The body of a `Moving` block with that effect is parted at its transmission:

    Z_M      (m - m_t) with friction and actuator, on the motion L that sensors see
    Z_M_tip  m_t, on the motion L_tip; hand, loads and contact act here
    Z_M_transmission  force K (L - L_tip) + C (v - v_tip) from one to the other

in blocks that every simulated form knows already: the transmission is two analog laws, one on each
motion, and their difference.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache
from typing import Any

import sympy as sp

from ..blocks import Body, Value
from ..controllers import ControlLaw, Controller, Stage
from ..diagrams import Attached, Block, Control, Diagram, Junction, Moving
from ..effects import CONTACT_ROLES, EFFECTS
from ..errors import ModelError

COMPLIANCE = EFFECTS["transmission_compliance"]


def tip(motion: str) -> str:
    """Name of the motion of the tip behind that motion."""
    return f"{motion}_tip"


def with_tips(diagram: Diagram, *, prescribed: Iterable[str] = ()) -> Diagram:
    """The diagram with every compliant transmission as two bodies.

    prescribed: motions that are given; of a compliant body only the tip's can be
    raises ModelError: the tip is no lighter than the body, another structure, a motion given that
        no outside force drives
    """
    for part in diagram.blocks:
        if not isinstance(part, Moving) or not isinstance(part.body, Body):
            continue
        if not part.body.has(COMPLIANCE.name):
            continue
        if part.motion in prescribed:
            raise ModelError(
                f"{diagram.name}: {part.motion} is the actuator's side of a compliant transmission,"
                f" which no hand leads: give the motion {tip(part.motion)}"
            )
        diagram = _parted(diagram, part, part.body)
    return diagram


def _parted(diagram: Diagram, part: Moving, body: Body) -> Diagram:
    device, end = _sides(diagram, part, body)
    names = tuple(f"{part.name}_{n}" for n in ("transmission", "near", "far"))
    force, near, far = names
    values = body.parameters
    given = {n: values[f"{COMPLIANCE.name}.{n}"].value for n in ("stiffness", "damping")}
    law = Controller((Stage(_law(), given),))
    here, there = part.motion, tip(part.motion)
    split: list[Block] = [
        replace(part, body=device, loads={force: -1}),
        Moving(f"{part.name}_tip", end, there, force, part.loads, part.driver),
        Control(f"{part.name}_near_spring", law, here, near, here, analog=True),
        Control(f"{part.name}_far_spring", law, there, far, there, analog=True),
    ]
    blocks: list[Block] = []
    for block in diagram.blocks:
        if block is part:
            blocks += split
        elif isinstance(block, Attached) and block.motion == here:
            blocks.append(replace(block, motion=there))
        else:
            blocks.append(block)
    return replace(
        diagram,
        blocks=tuple(blocks),
        junctions=(*diagram.junctions, Junction(force, {near: 1, far: -1})),
        # no sensor sees it: electronics do, and the transmission is wired as such
        measured=(*diagram.measured, there),
        texts={**diagram.texts, there: "motion of the tip, behind the transmission"},
    )


def _sides(diagram: Diagram, part: Moving, body: Body) -> tuple[Body, Body]:
    """The actuator's side, and the tip with what it touches."""
    inertia = body.parameters["inertia"].value
    behind = body.parameters[f"{COMPLIANCE.name}.tip_inertia"].value
    if not 0 < behind < inertia:
        raise ModelError(
            f"{diagram.name}: {part.name}: the tip has {behind:g} {body.unit('inertia')} of the "
            f"body's {inertia:g}: it must be less, and more than none"
        )
    device = body.without_effect(COMPLIANCE.name).with_values({"inertia": inertia - behind})
    end = Body(body.axis, {"inertia": Value(behind)})
    for effect in body.effects:
        if effect.role in CONTACT_ROLES:
            values = {n: body.parameters[f"{effect.name}.{n}"].value for n in effect.parameters}
            end = end.with_effect(effect, values)
    for effect in reversed(end.effects):
        device = device.without_effect(effect.name)
    return device, end


@lru_cache(maxsize=1)
def _law() -> ControlLaw:
    """One side's share in the force of the transmission, the other side at rest."""

    def share(now: Any, p: Any) -> sp.Expr:
        here = {"position": now.input, "velocity": now.velocity, "acceleration": 0}
        there = {"tip_position": 0, "tip_velocity": 0, "interaction_force": 0}
        return COMPLIANCE.expression({**here, **there}, {**vars(p), "tip_inertia": 0})

    names = ("stiffness", "damping")
    parameters = {n: COMPLIANCE.parameters[n] for n in names}
    law = ControlLaw(law=share, parameters=parameters, linear=True, source=COMPLIANCE.source)
    return law.named("transmission", COMPLIANCE.text)
