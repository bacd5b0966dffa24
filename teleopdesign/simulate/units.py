"""Units of a diagram's signals and hidden states."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ..base.units import unit_of
from ..diagrams import Attached, Control, Diagram, Linked, Moving
from ..diagrams.junctions import Weight
from ..diagrams.units import first_axis


def signal_units(diagram: Diagram) -> Callable[[str], str]:
    """Name of a signal or hidden state -> its SI unit on its axis."""
    axes, quantities = _axes(diagram), _quantities(diagram)
    states = _states(diagram)
    first = first_axis(diagram)

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
    by_state = {}
    for block in diagram.blocks:
        laws = [(e.name, e.states) for e in getattr(getattr(block, "body", None), "effects", ())]
        stages = getattr(block, "stages", ())
        for law, states in (*laws, *((g.name, g.law.states) for g in stages)):
            for state, declared in states.items():
                name = f"{block.name}_{law}_{state}"
                by_state[name] = (declared.quantity, block.outputs[0])
    return by_state


def _quantities(diagram: Diagram) -> dict[str, str]:
    """Quantity of each signal, from bodies through sums; of a controller's output, from its target.

    The output of a controller that enters a sum has the quantity of the sum, a position if it is
    compared with one. An output that enters only controllers has the quantity of the input: a
    filter.
    """
    by_signal = dict(diagram.outside)
    for block in diagram.blocks:
        if isinstance(block, Moving):
            by_signal[block.motion] = "position"
            by_signal |= dict.fromkeys(block.inputs, "force")
        elif isinstance(block, Attached):
            by_signal[block.force] = "force"
        elif isinstance(block, Linked):
            by_signal |= dict.fromkeys(block.forces, "force")
    by_signal |= {k.output: "position" for k in diagram.kinematics}
    filters = [c for c in diagram.controls if _feeds_controllers_alone(diagram, c.output)]
    sums = [(j.output, *j.terms) for j in diagram.junctions if _is_sum(j.terms)]
    changed = True
    while changed:
        before = len(by_signal)
        for junction in diagram.junctions:
            if any(by_signal.get(s) == "position" for s in junction.terms):
                by_signal.setdefault(junction.output, "position")
        for group in (*sums, *((c.input, c.output) for c in filters)):
            known = next((by_signal[s] for s in group if s in by_signal), None)
            if known is not None:
                by_signal |= {s: known for s in group if s not in by_signal}
        changed = len(by_signal) > before
    return by_signal


def _feeds_controllers_alone(diagram: Diagram, signal: str) -> bool:
    takers = [part for part in diagram.parts if signal in part.inputs]
    return bool(takers) and all(isinstance(part, Control) for part in takers)


def _axes(diagram: Diagram) -> dict[str, str]:
    """Axis of each signal: the axis of its body, passed on by blocks and sums."""
    axis_of = {k.output: k.axis for k in diagram.kinematics}
    for block in diagram.bodies:
        axis = getattr(block.body, "axis", None)
        if axis is None:
            continue
        if isinstance(block, Moving):
            axis_of |= dict.fromkeys((block.motion, *block.inputs, f"{block.name}_friction"), axis)
        else:
            axis_of |= dict.fromkeys((block.motion, block.force, f"{block.name}_friction"), axis)
    groups: list[tuple[str, ...]]
    groups = [(b.input, b.output) for b in diagram.controls]
    groups += [(b.motion, b.force) for b in diagram.blocks if isinstance(b, Attached)]
    for linked in (b for b in diagram.blocks if isinstance(b, Linked)):
        groups += zip(linked.motions, linked.forces, strict=True)
    # a lever joins two axes; a sum does not
    groups += [(j.output, *j.terms) for j in diagram.junctions if not j.arms and _is_sum(j.terms)]
    for _ in range(len(groups)):
        before = len(axis_of)
        for group in groups:
            axis = next((axis_of[s] for s in group if s in axis_of), None)
            if axis is not None:
                axis_of |= {s: axis for s in group if s not in axis_of}
        if len(axis_of) == before:
            break
    return axis_of


def _is_sum(terms: Mapping[str, Weight]) -> bool:
    return all(abs(w) == 1 for w in terms.values())
