"""Units of a diagram's signals and hidden states."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ..blocks import Body
from ..diagrams import Attached, Control, Diagram, Linked, Moving
from ..diagrams.parts import Weight
from ..quantity import unit_of


def signal_units(diagram: Diagram) -> Callable[[str], str]:
    """Name of a signal or hidden state -> its SI unit on its axis."""
    axes, quantities = _axes(diagram), _quantities(diagram)
    states = _states(diagram)
    first = next((b.body.axis for b in diagram.bodies if isinstance(b.body, Body)), "prismatic")

    def unit(name: str) -> str:
        if name in states:
            quantity, block = states[name]
            return unit_of(quantity, axes.get(block, first))
        for end in ("velocity", "acceleration"):
            stem = name.removesuffix(f"_{end}")
            if stem != name and quantities.get(stem) == "position":
                return unit_of(end, axes.get(stem, first))
        return unit_of(quantities.get(name, "force"), axes.get(name, first))

    return unit


def _states(diagram: Diagram) -> dict[str, tuple[str, str]]:
    """Hidden state -> its quantity and a signal of its block."""
    by_name = {}
    for block in diagram.blocks:
        laws = [(e.name, e.states) for e in getattr(getattr(block, "body", None), "effects", ())]
        stages = getattr(getattr(block, "controller", None), "stages", ())
        for law, states in (*laws, *((g.name, g.law.states) for g in stages)):
            for state, declared in states.items():
                name = f"{block.name}_{law}_{state}"
                by_name[name] = (declared.quantity, block.outputs[0])
    return by_name


def _quantities(diagram: Diagram) -> dict[str, str]:
    quantities = dict(diagram.outside)
    for block in diagram.blocks:
        if isinstance(block, Moving):
            quantities[block.motion] = "position"
    quantities |= {k.output: "position" for k in diagram.kinematics}
    for junction in diagram.junctions:
        if any(quantities.get(s) == "position" for s in junction.terms):
            quantities[junction.output] = "position"
    return quantities


def _axes(diagram: Diagram) -> dict[str, str]:
    """Axis of each signal: that of its body, carried on by blocks and sums."""
    axes = {k.output: k.axis for k in diagram.kinematics}
    for block in diagram.bodies:
        axis = getattr(block.body, "axis", None)
        if axis is None:
            continue
        if isinstance(block, Moving):
            axes |= dict.fromkeys((block.motion, *block.inputs, f"{block.name}_friction"), axis)
        else:
            axes |= dict.fromkeys((block.motion, block.force, f"{block.name}_friction"), axis)
    groups: list[tuple[str, ...]]
    groups = [(b.input, b.output) for b in diagram.blocks if isinstance(b, Control)]
    groups += [(b.motion, b.force) for b in diagram.blocks if isinstance(b, Attached)]
    for linked in (b for b in diagram.blocks if isinstance(b, Linked)):
        groups += zip(linked.motions, linked.forces, strict=True)
    # a lever joins two axes; a sum does not
    groups += [(j.output, *j.terms) for j in diagram.junctions if not j.arms and _is_sum(j.terms)]
    for _ in range(len(groups)):
        before = len(axes)
        for group in groups:
            axis = next((axes[s] for s in group if s in axes), None)
            if axis is not None:
                axes |= {s: axis for s in group if s not in axes}
        if len(axes) == before:
            break
    return axes


def _is_sum(terms: Mapping[str, Weight]) -> bool:
    return all(abs(w) == 1 for w in terms.values())
