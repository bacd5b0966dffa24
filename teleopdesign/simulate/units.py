"""Units of a diagram's signals and hidden states."""

from __future__ import annotations

from collections.abc import Callable

from ..diagrams import Diagram, Moving
from ..quantity import unit_of


def signal_units(diagram: Diagram) -> Callable[[str], str]:
    """Name of a signal or hidden state -> its SI unit on the diagram's axis."""
    bodies = [b.body for b in diagram.bodies]
    axis = next((b.axis for b in bodies if hasattr(b, "axis")), "prismatic")
    motions = {b.motion for b in diagram.blocks if isinstance(b, Moving)}
    quantities = {n: q for n, q in diagram.outside.items()}
    for motion in motions:
        quantities |= {motion: "position", f"{motion}_velocity": "velocity"}
        quantities |= {f"{motion}_acceleration": "acceleration"}
    for junction in diagram.junctions:
        if any(quantities.get(s) == "position" for s in junction.terms):
            quantities[junction.output] = "position"

    def unit(name: str) -> str:
        quantity = quantities.get(name, "force")
        for block in diagram.blocks:
            laws = getattr(getattr(block, "body", None), "effects", ())
            laws = [*laws, *(g.law for g in getattr(getattr(block, "controller", 0), "stages", ()))]
            for law in laws:
                for state, declared in law.states.items():
                    if name == f"{block.name}_{law.name}_{state}":
                        quantity = declared.quantity
        return unit_of(quantity, axis)

    return unit
