"""Any diagram drawn by itself: laid out along its signals, wires at right angles, no hand at work.

draw_diagram(diagram).to_svg("loop.svg")
save_figure(draw_diagram(diagram).plot(), "loop")     # PDF and PNG in house style
"""

from __future__ import annotations

from ...diagrams import Diagram
from .cells import place
from .network import Network, Node, network
from .paths import Path, paths
from .routes import route
from .shapes import Drawing
from .sheet import sheet

__all__ = ["Drawing", "draw_diagram"]

MOST_TRIALS = 12  # placements tried, each a few hundredths of a second


def draw_diagram(diagram: Diagram) -> Drawing:
    """The block diagram of a wiring; the same diagram gives the same drawing.

    Blocks are boxes with their name and the laws in them, junctions circles with a sign at
    every term. Z_M^-1 stands for a body that forces move, -Z_H for one that resists the motion it
    follows. Of control laws that also see a velocity, only the wired input is drawn.
    """
    parts = network(diagram)
    ways = paths(parts)
    ways += _arrow_out(parts, ways[0])
    cells = place(parts, ways, _best_sides(parts, ways))
    grid, routes, _ = route(parts, cells)
    return sheet(parts, cells, grid, routes, diagram.name)


def _arrow_out(parts: Network, spine: Path) -> list[Path]:
    """The end of an arrow that shows what the spine gives, unless it ends with one already."""
    last = spine.nodes[-1]
    net = parts.net_of(last)
    if net is None or any(parts.nodes[t].kind == "sink" for t, _ in net.targets):
        return []
    name = f"to {net.name}"
    parts.nodes[name] = Node(name, "sink")
    net.targets.append((name, 1.0))
    return [Path((name,), last, None)]


def _best_sides(parts: Network, ways: list[Path]) -> dict[int, int]:
    """Which paths lie above and which below, for the least length, bends and crossings."""
    able = [
        i
        for i, p in enumerate(ways)
        if i and any(parts.nodes[n].kind in ("box", "sum") for n in p.nodes)
    ]
    best: dict[int, int] = {}
    least = route(parts, place(parts, ways, best))[2]
    trials, better = 1, True
    while better and trials < MOST_TRIALS:
        better = False
        for i in able:
            for side in (1, -1):
                if best.get(i) == side or trials >= MOST_TRIALS:
                    continue
                trial = {**best, i: side}
                cost = route(parts, place(parts, ways, trial))[2]
                trials += 1
                if cost < least - 1e-9:
                    best, least, better = trial, cost, True
    return best
