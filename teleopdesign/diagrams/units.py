"""Axes of motions, and units of a diagram's values.

What shares one motion is on one axis: a radian is no metre.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import inf
from typing import TYPE_CHECKING

from ..base.errors import ModelError
from ..base.units import unit_of
from ..blocks import Body
from ..effects import Parameter, require_distinct
from .junctions import Junction, Kinematics
from .parts import AnyBlock, Attached, Block, Control, Moving

if TYPE_CHECKING:
    from .wiring import Diagram


def first_axis(diagram: Diagram) -> str:
    """Axis of the first body, which also applies to blocks without an axis."""
    bodies = (b.body for b in diagram.bodies if isinstance(b.body, Body))
    return next((b.axis for b in bodies), "prismatic")


def declaration_of(diagram: Diagram, name: str) -> Parameter | None:
    """How the block of a value of `diagram.values` declares it; None: no body's, no law's."""
    block_name, _, rest = name.partition(".")
    block = diagram.block(block_name)
    if not isinstance(block, Control):
        return block.body.parameter(rest) if isinstance(block.body, Body) else None
    if isinstance(block.controller, AnyBlock):
        return None
    stage_name, _, parameter = rest.rpartition(".")
    stages = (s for s in block.controller.stages if s.name == stage_name)
    return next((s.law.parameters.get(parameter) for s in stages), None)


def unit_of_value(diagram: Diagram, name: str) -> str:
    """SI unit of a value of `diagram.values`; "1" if it has none."""
    declared, block = declaration_of(diagram, name), diagram.block(name.partition(".")[0])
    body = None if isinstance(block, Control) else block.body
    axis = body.axis if isinstance(body, Body) else first_axis(diagram)
    return "1" if declared is None else unit_of(declared.quantity, axis)


def bounds_of_value(diagram: Diagram, name: str) -> tuple[float, float]:
    """Least and largest value of a parameter; infinite where its block states none."""
    declared = declaration_of(diagram, name)
    return (-inf, inf) if declared is None else (declared.lower, declared.upper)


def require_distinct_names(name: str, blocks: Sequence[Block]) -> None:
    """Refuse parameters and states of blocks that have one symbol.

    name: of the diagram;  raises ModelError: with the two
    """
    require_distinct((n for block in blocks for n in _values_and_states(block)), name)


def _values_and_states(block: Block) -> Iterator[str]:
    """Full names of the parameters and hidden states of a block, "Z_M.presliding.bristle"."""
    if isinstance(block, Control):
        if not isinstance(block.controller, AnyBlock):
            yield from (f"{block.name}.{n}" for n in block.controller.names())
            for stage in block.controller.stages:
                yield from (f"{block.name}.{stage.name}.{s}" for s in stage.law.states)
    elif isinstance(block.body, Body):
        yield from (f"{block.name}.{n}" for n in block.body.parameters)
        for effect in block.body.effects:
            yield from (f"{block.name}.{effect.name}.{s}" for s in effect.states)


def require_one_axis(
    name: str,
    blocks: Sequence[Block],
    kinematics: Sequence[Kinematics],
    junctions: Sequence[Junction],
) -> None:
    """Raise a ModelError where angles and lengths are one motion, or are added one to one.

    A weight other than 1 and -1 may be the lever that makes a length of an angle.
    """
    axes = {k.output: k.axis for k in kinematics}
    for block in blocks:
        if isinstance(block, Moving) and isinstance(block.body, Body):
            axes[block.motion] = block.body.axis
    for _ in junctions:  # a sum may come before the sums that it adds
        for junction in junctions:
            if (axis := _axis_of_sum(name, junction, axes)) is not None:
                axes[junction.output] = axis
    for block in blocks:
        if not isinstance(block, Attached) or not isinstance(block.body, Body):
            continue
        if (axis := axes.get(block.motion, block.body.axis)) != block.body.axis:
            raise ModelError(
                f"{name}: {block.name} is {block.body.axis} and holds {block.motion}, which is "
                f"{axis}: expected bodies of one axis on one motion"
            )


def _axis_of_sum(name: str, junction: Junction, axes: dict[str, str]) -> str | None:
    """Axis of a sum of motions; None: of other signals, or one with levers as weights."""
    if not junction.terms or not {*junction.terms} <= {*axes}:
        return None
    if any(weight not in (1, -1) for weight in junction.terms.values()):
        return None
    of_terms = {s: axes[s] for s in junction.terms}
    if len({*of_terms.values()}) > 1:
        listed = ", ".join(f"{s} is {axis}" for s, axis in of_terms.items())
        raise ModelError(
            f"{name}: {junction.output} adds angles to lengths ({listed}): expected a weight such "
            "as 0.05, a lever in m"
        )
    return next(iter(of_terms.values()))
