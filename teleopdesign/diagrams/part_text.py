"""Parts of a diagram as text: the equation of each part, and its laws."""

from __future__ import annotations

from collections.abc import Iterable

import sympy as sp

from ..blocks import Body
from ..controllers import Controller
from .junctions import Kinematics, Weight
from .parts import Attached, Control, Linked, Moving, Part


def _write_sum(terms: Iterable[tuple[str, Weight]]) -> str:
    text = " ".join(_write_term(signal, weight) for signal, weight in terms)
    return text.removeprefix("+ ") or "0"


def _write_term(signal: str, weight: Weight) -> str:
    if isinstance(weight, sp.Expr) and not weight.is_number:
        return f"+ ({weight}) {signal}"
    value = float(weight)
    factor = "" if abs(value) == 1 else f"{abs(value):g} "
    return f"{'-' if value < 0 else '+'} {factor}{signal}"


def write_equation(part: Part) -> str:
    """The equation of a block, junction or kinematics, such as "Z_M X_M = R_D - R_M"."""
    if isinstance(part, Moving):
        return f"{part.name} {part.motion} = {_write_sum([(part.command, 1), *part.loads.items()])}"
    if isinstance(part, Attached):
        return f"{part.force} = {'-' if part.sign < 0 else ''}{part.name} {part.motion}"
    if isinstance(part, Linked):
        sign = "-" if part.sign < 0 else ""
        return f"({', '.join(part.forces)}) = {sign}{part.name} ({', '.join(part.motions)})"
    if isinstance(part, Control):
        law = part.name if part.dead_time is None else f"exp(-s {part.name})"
        return f"{part.output} = {law} {part.input}"
    if isinstance(part, Kinematics):
        return f"{part.output} = {part.expression}"
    return f"{part.output} = {_write_sum(part.terms.items())}"


def list_laws(part: Part) -> str:
    """Names of the laws or effects in a block; "" for sums and kinematics."""
    if isinstance(part, Control):
        stages = part.controller.stages if isinstance(part.controller, Controller) else ()
        return ", ".join(stage.name for stage in stages)
    if isinstance(part, Moving | Attached):
        return ", ".join(e.name for e in part.body.effects) if isinstance(part.body, Body) else ""
    return ""
