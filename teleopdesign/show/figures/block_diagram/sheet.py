"""From cells and routes to shapes in points: only used lines and names take space."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Literal

from .drawing import Drawing
from .paths import LEFT, RIGHT, Cells
from .routes import Route, RoutingGrid
from .shapes import (
    MINUS,
    RADIUS,
    SIZES,
    Box,
    Circle,
    Dot,
    Network,
    Node,
    Run,
    SheetPoint,
    SheetShape,
    Text,
    Wire,
    label,
    width,
)

MARGIN, PITCH = 8.0, 11.0
APPROACH = 15.0  # arrow head and sign before a node
#: half the height of a row at least, and the room between rows
HALF_ROW, BETWEEN_ROWS = 15.0, 8.0
LABEL_ABOVE = 7.5  # middle of a name above its wire
_BEFORE: Literal["end"] = "end"  # a text that ends at its place
_AFTER: Literal["start"] = "start"
LABEL_BEHIND = 5.0  # between a node and the name on its wire


def sheet(
    network: Network, cells: Cells, grid: RoutingGrid, routes: Sequence[Route], title: str
) -> Drawing:
    """The drawing of a diagram with a layout; shapes are in the order of painting."""
    x, y = (_places(network, cells, grid, routes, axis) for axis in (0, 1))
    middle = {n: (x[grid.vertex(n)[0]], y[grid.vertex(n)[1]]) for n in cells.at}
    shapes: list[SheetShape] = []
    texts: list[Text] = []
    for one in routes:
        wire = _wire(network, grid, one, x, y)
        shapes.append(wire)
        if one.taken_off:
            shapes.append(Dot(*wire.points[0]))
        if network.nodes[one.target].kind == "sum":
            texts.append(_sign(wire, one.weight, cells.heading[one.target]))
    for name, node in network.nodes.items():
        at = middle[name]
        shapes += _node(node, at)
        net = network.net_of(name)
        if net is not None and node.kind != "source" and label(net):
            side = cells.heading[name]
            start = at[0] + side * (node.size[0] / 2 + LABEL_BEHIND)
            anchor = _AFTER if side == RIGHT else _BEFORE
            texts.append(Text(start, at[1] - LABEL_ABOVE, label(net), "signal", anchor))
    return _crop((*shapes, *texts), title)


def _places(
    network: Network, cells: Cells, grid: RoutingGrid, routes: Sequence[Route], axis: int
) -> dict[int, float]:
    """Number of a used line -> its place (points);  axis: 0 vertical, 1 horizontal lines."""
    used = {a[axis] for r in routes for a, b in pairwise(r.vertices) if a[axis] == b[axis]}
    numbers = sorted({cell[axis] for cell in cells.at.values()})
    first, last = numbers[0], numbers[-1]
    at: dict[int, float] = {}
    end = 0.0  # of what is placed
    for i, number in enumerate(range(first, last + 2)):
        start = i * (grid.tracks + 1)
        lines = [k for k in range(start, start + grid.tracks) if k in used]
        if axis == 0:
            before, after = (
                _room(network, cells, routes, c, side)
                for c, side in ((number - 1, RIGHT), (number, LEFT))
            )
        else:
            room = BETWEEN_ROWS if lines or first < number <= last else 0.0
            before, after = room * (number > first), room * (number <= last)
        for k, line in enumerate(lines):
            at[line] = end + before + PITCH * k
        end += before + PITCH * max(len(lines) - 1, 0) + after
        if number <= last:
            half = max(HALF_ROW * axis, _half(network, cells, axis, number))
            at[start + grid.tracks] = end + half
            end += 2 * half
    return at


def _room(network: Network, cells: Cells, routes: Sequence[Route], column: int, side: int) -> float:
    """Space (points) that nodes of a column need on one side, for signal names and arrows."""
    half = _half(network, cells, 0, column)
    need = 4.0
    for name, (c, _) in cells.at.items():
        if c != column:
            continue
        node = network.nodes[name]
        spare = half - node.size[0] / 2
        net = network.net_of(name)
        signs = [_weight(r.weight) for r in routes if r.target == name and node.kind == "sum"]
        sign = max((width((Run(s, 0, False),), "sign") for s in signs), default=0.0)
        if cells.heading[name] == side:
            named = net is not None and node.kind != "source" and label(net)
            text = width(label(net), "signal") if named and net is not None else 0.0
            need = max(need, text + 2 * LABEL_BEHIND - spare, sign - spare)
        else:
            need = max(need, APPROACH + max(0.0, sign - 8.0) - spare)
    return need


def _half(network: Network, cells: Cells, axis: int, line: int) -> float:
    sizes = [network.nodes[n].size[axis] for n, cell in cells.at.items() if cell[axis] == line]
    return max(sizes, default=0.0) / 2


def _wire(
    network: Network, grid: RoutingGrid, one: Route, x: dict[int, float], y: dict[int, float]
) -> Wire:
    corners = [one.vertices[0]]
    for a, b, c in zip(one.vertices, one.vertices[1:], one.vertices[2:], strict=False):
        if (a[0] == b[0]) != (b[0] == c[0]):
            corners.append(b)
    points = [(x[i], y[j]) for i, j in (*corners, one.vertices[-1])]
    if not one.taken_off:
        points[0] = _edge(points[0], points[1], network.nodes[grid.blocked[one.vertices[0]]])
    points[-1] = _edge(points[-1], points[-2], network.nodes[one.target])
    return Wire(tuple(points), one.net)


def _edge(at: SheetPoint, towards: SheetPoint, node: Node) -> SheetPoint:
    """The point at which a line from the middle of a node leaves its outline."""
    half_width, half_height = node.size[0] / 2, node.size[1] / 2
    if towards[1] == at[1]:
        return at[0] + (half_width if towards[0] > at[0] else -half_width), at[1]
    return at[0], at[1] + (half_height if towards[1] > at[1] else -half_height)


def _node(node: Node, at: SheetPoint) -> list[SheetShape]:
    x, y = at
    if node.kind == "sum":
        return [Circle(x, y, RADIUS)]
    if node.kind == "source":
        return [Text(x, y, node.title, "signal")]
    if node.kind == "sink":
        return []
    wide, high = node.size
    if node.kind == "bar":
        return [Box(x, y, wide, high, "")]
    lines = len(node.notes)
    top = y - 4.25 * lines
    shapes: list[SheetShape] = [
        Box(x, y, wide, high, node.name.partition(" ")[2]),
        Text(x, top, node.title, "block"),
    ]
    for k, note in enumerate(node.notes):
        shapes.append(Text(x, top + 10.0 + 8.5 * k, (Run(note, 0, False),), "law"))
    return shapes


def _weight(weight: float) -> str:
    if weight in (1.0, -1.0):
        return "+" if weight > 0 else MINUS
    return f"{weight:g}".replace("-", MINUS)


def _sign(wire: Wire, weight: float, heading: int) -> Text:
    """Sign or weight of a term beside the arrow of the term; each direction has another corner.

    In the direction of the heading, a sign stands below an arrow from behind, behind an arrow from
    above, and ahead of an arrow from below. The corner above and ahead is for the name of the sum.
    """
    before, tip = wire.points[-2:]
    runs = (Run(_weight(weight), 0, False),)
    half = SIZES["sign"] / 2
    if before[1] == tip[1]:
        ahead = RIGHT if before[0] < tip[0] else LEFT
        anchor = _BEFORE if ahead == RIGHT else _AFTER
        return Text(tip[0] - 2.0 * ahead, tip[1] + half + 2.0, runs, "sign", anchor)
    down = before[1] < tip[1]
    side = -heading if down else heading
    away = -(half + 0.5) if down else half + 0.5
    anchor = _AFTER if side == RIGHT else _BEFORE
    return Text(tip[0] + 3.5 * side, tip[1] + away, runs, "sign", anchor)


def _crop(shapes: Sequence[SheetShape], title: str) -> Drawing:
    """The drawing with the shapes moved to the corner of a sheet that is as large as they need."""
    edges = [_bounds(s) for s in shapes] or [(0.0, 0.0, 0.0, 0.0)]
    left, top = min(e[0] for e in edges) - MARGIN, min(e[1] for e in edges) - MARGIN
    right, bottom = max(e[2] for e in edges) + MARGIN, max(e[3] for e in edges) + MARGIN
    moved = tuple(_move(s, -left, -top) for s in shapes)
    return Drawing(moved, round(right - left, 2), round(bottom - top, 2), title)


def _bounds(shape: SheetShape) -> tuple[float, float, float, float]:
    if isinstance(shape, Text):
        return shape.bounds
    if isinstance(shape, Wire):
        x, y = zip(*shape.points, strict=True)
        return min(x), min(y), max(x), max(y)
    wide, high = (shape.width, shape.height) if isinstance(shape, Box) else (2 * RADIUS, 2 * RADIUS)
    return shape.x - wide / 2, shape.y - high / 2, shape.x + wide / 2, shape.y + high / 2


def _move(shape: SheetShape, dx: float, dy: float) -> SheetShape:
    if isinstance(shape, Wire):
        points = tuple((round(x + dx, 2), round(y + dy, 2)) for x, y in shape.points)
        return replace(shape, points=points)
    return replace(shape, x=round(shape.x + dx, 2), y=round(shape.y + dy, 2))
