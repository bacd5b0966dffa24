"""Any diagram drawn by itself: laid out along its signals, wires at right angles, no hand at work.

draw_diagram(diagram).to_svg("loop.svg")
save_figure(draw_diagram(diagram).plot(), "loop")     # PDF and PNG in house style
"""

from __future__ import annotations

import math

from ....base.errors import ModelError
from ....diagrams import Diagram
from .drawing import Drawing
from .from_diagram import network
from .paths import Path, paths, place
from .routes import route
from .shapes import Network, Node
from .sheet import sheet

__all__ = ["Drawing", "draw_diagram"]

#: placements drawn up, each a few hundredths of a second, and fewer of large diagrams
MOST_TRIALS, MOST_NODES = 12, 150


def draw_diagram(diagram: Diagram) -> Drawing:
    """The block diagram of a diagram's wiring; the same diagram gives the same drawing.

    Blocks are boxes with their name and the laws in them, junctions are circles with a sign at
    every term. Z_M^-1 stands for a body that forces move, -Z_H for a body that resists the motion
    that it follows. A matrix of impedances is a box for each of its rows. Weights that depend on
    positions are a box with their formula, on the wires of the weighted signals. A control law that
    also reads a velocity is drawn with its wired input only.
    """
    parts = network(diagram)
    if not parts.nodes:
        return Drawing((), 0.0, 0.0, diagram.name)
    ways = paths(parts)
    ways += _arrow_out(parts, ways[0])
    cells = place(parts, ways, _best_sides(parts, ways))
    grid, routes, _ = route(parts, cells)
    return sheet(parts, cells, grid, routes, diagram.name)


def _arrow_out(parts: Network, spine: Path) -> list[Path]:
    """A path that ends in an arrow for the output of the spine; [] if there is such an end."""
    last = spine.nodes[-1]
    net = parts.net_of(last)
    if net is None or any(parts.nodes[t].kind == "sink" for t, _ in net.targets):
        return []
    name = f"to {net.name}"
    parts.nodes[name] = Node(name, "sink")
    net.targets.append((name, 1.0))
    return [Path((name,), last, None)]


def _best_sides(parts: Network, ways: list[Path]) -> dict[int, int]:
    """Side of each path, above or below, for the least length, bends and crossings."""
    able = [
        i
        for i, p in enumerate(ways)
        if i and any(parts.nodes[n].kind in ("box", "bar", "sum") for n in p.nodes)
    ]
    best: dict[int, int] = {}
    least = _cost(parts, ways, best)
    trials, better = 1, True
    most = min(MOST_TRIALS, MOST_NODES // len(parts.nodes))
    while better and trials < most:
        better = False
        for i in able:
            for side in (1, -1):
                if best.get(i) == side or trials >= most:
                    continue
                trial = {**best, i: side}
                cost = _cost(parts, ways, trial)
                trials += 1
                if cost < least - 1e-9:
                    best, least, better = trial, cost, True
    return best


def _cost(parts: Network, ways: list[Path], sides: dict[int, int]) -> float:
    try:
        return route(parts, place(parts, ways, sides))[2]
    except ModelError:  # no way for some wire: any other placement is better
        return math.inf
