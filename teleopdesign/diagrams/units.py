"""Units of a diagram's values."""

from __future__ import annotations

from ..base.units import unit_of
from ..blocks import Body
from .parts import AnyBlock, Control
from .wiring import Diagram


def first_axis(diagram: Diagram) -> str:
    """Axis of the first body, which also applies to blocks without an axis."""
    bodies = (b.body for b in diagram.bodies if isinstance(b.body, Body))
    return next((b.axis for b in bodies), "prismatic")


def unit_of_value(diagram: Diagram, name: str) -> str:
    """SI unit of a value of `diagram.values`; "1" if it has none."""
    block_name, _, rest = name.partition(".")
    block = diagram.block(block_name)
    if not isinstance(block, Control):
        body = block.body
        return body.unit(rest) if isinstance(body, Body) else "1"
    if isinstance(block.controller, AnyBlock):
        return "1"
    stage_name, _, parameter = rest.rpartition(".")
    stage = next(s for s in block.controller.stages if s.name == stage_name)
    return unit_of(stage.law.parameters[parameter].quantity, first_axis(diagram))
