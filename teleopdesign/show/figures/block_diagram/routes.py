"""Routes of wires along a grid: short ways with few bends and crossings, none over another.

Every column and every row of cells has a line through its middle, and a few lines run between them.
Where two nets meet they cross at right angles. No two nets share a piece of a line, and no wire
runs through a cell in which a node stands. The cheapest route is computed net by net (A*).
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from ....base.errors import ModelError
from .paths import LEFT, RIGHT, Cells
from .shapes import Net, Network

Vertex = tuple[int, int]
#: steps right, down, left, up
STEPS: tuple[Vertex, ...] = ((1, 0), (0, 1), (-1, 0), (0, -1))
BEND, CROSSING, TAKE_OFF, AGAIN = 5.0, 9.0, 2.0, 0.5  # AGAIN: a second branch at the same place
#: lengths on the grid: between lines side by side, and from a cell's middle to the next line
BESIDE, MIDDLE = 1.0, 4.0
#: lines between cells, more of them if no route exists; each number is tried with several orders in
#: which wires that failed come first
TRACKS, TRIALS = (3, 5, 8, 12), 4
#: a name from outside may leave its text to any side, best to the right
BESIDE_RIGHT = 3.0


@dataclass(frozen=True)
class Route:
    """The way of a net to one target: vertices from its start to the target's cell.

    taken_off: it starts at another wire of the net, not at the source
    """

    net: str
    target: str
    weight: float
    vertices: tuple[Vertex, ...]
    taken_off: bool


@dataclass
class RoutingGrid:
    """Lines of the grid around the cells, and the nodes and wires on the grid."""

    cells: Cells
    tracks: int
    blocked: dict[Vertex, str] = field(default_factory=dict)
    #: vertex beside a node -> the node and the step to it: nobody else may turn there
    doors: dict[Vertex, tuple[str, int]] = field(default_factory=dict)
    #: (vertex, step) of every piece of wire, from both of its ends
    edges: set[tuple[Vertex, int]] = field(default_factory=set)
    #: vertex -> net -> steps by which the net leaves it
    used: dict[Vertex, dict[str, set[int]]] = field(default_factory=dict)
    #: nets of which a wire lies on the grid: all others of it are taken off that one
    begun: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        columns, rows = zip(*self.cells.at.values(), strict=True)
        self.first = min(columns), min(rows)
        pitch = self.tracks + 1
        self.size = tuple(
            (max(all_) - min(all_) + 1) * pitch + self.tracks for all_ in (columns, rows)
        )
        self.along = tuple(self._lengths(n) for n in self.size)
        self.blocked = {self.vertex(node): node for node in self.cells.at}
        for (x, y), node in self.blocked.items():
            for d, (dx, dy) in enumerate(STEPS):
                self.doors[x + dx, y + dy] = node, (d + 2) % 4

    def vertex(self, node: str) -> Vertex:
        """The middle of a node's cell."""
        x, y = (
            (c - first) * (self.tracks + 1) + self.tracks
            for c, first in zip(self.cells.at[node], self.first, strict=True)
        )
        return x, y

    def _lengths(self, lines: int) -> list[float]:
        """Positions of all lines, as distances from the first line."""
        places = [0.0]
        for line in range(1, lines):
            middle = any(k % (self.tracks + 1) == self.tracks for k in (line, line - 1))
            places.append(places[-1] + (MIDDLE if middle else BESIDE))
        return places

    def between(self, a: Vertex, b: Vertex) -> float:
        """Length of the shortest way between two vertices if no obstacle lies on it."""
        x, y = self.along
        return abs(x[a[0]] - x[b[0]]) + abs(y[a[1]] - y[b[1]])

    def lay(self, net: str, vertices: tuple[Vertex, ...]) -> None:
        """Put a wire on the grid."""
        self.begun.add(net)
        for a, b in zip(vertices, vertices[1:], strict=False):
            d = STEPS.index((b[0] - a[0], b[1] - a[1]))
            self.edges |= {(a, d), (b, (d + 2) % 4)}
            self.used.setdefault(a, {}).setdefault(net, set()).add(d)
            self.used.setdefault(b, {}).setdefault(net, set()).add((d + 2) % 4)


def route(network: Network, cells: Cells) -> tuple[RoutingGrid, list[Route], float]:
    """The grid with all wires, the route of every wire, and the total cost.

    raises ModelError: no route exists for some wire
    """
    jobs = [(net, t, w) for net in network.nets.values() for t, w in net.targets]
    for tracks in TRACKS:
        grid = RoutingGrid(cells, tracks)
        jobs.sort(key=lambda job: _measure_distance(job[0], job[1], grid))
        for _ in range(TRIALS):
            grid = RoutingGrid(cells, tracks)
            routes, total, failed = _routes(network, grid, jobs)
            if failed is None:
                return grid, routes, total
            jobs.insert(0, jobs.pop(failed))
    raise ModelError("block diagram: no way was found for every wire")


def _routes(
    network: Network, grid: RoutingGrid, jobs: Sequence[tuple[Net, str, float]]
) -> tuple[list[Route], float, int | None]:
    """Routes in the order of the jobs, their cost, and the number of a job without a route."""
    routes: list[Route] = []
    total = 0.0
    for i, (net, target, weight) in enumerate(jobs):
        cheapest = _cheapest(network, grid, net, target)
        if cheapest is None:
            return routes, total, i
        vertices, cost = cheapest
        taken_off = vertices[0] != grid.vertex(net.source)
        grid.lay(net.name, vertices)
        routes.append(Route(net.name, target, weight, vertices, taken_off))
        total += cost
    return routes, total, None


def _measure_distance(net: Net, target: str, grid: RoutingGrid) -> tuple[bool, int]:
    (x0, y0), (x, y) = grid.vertex(net.source), grid.vertex(target)
    ahead = (x - x0) * grid.cells.heading[net.source] > 0
    return not (y == y0 and ahead), abs(x - x0) + abs(y - y0)


def _steps_out(network: Network, grid: RoutingGrid, node: str) -> dict[int, float]:
    """Steps by which a wire may leave a node -> cost above the cost of the best step."""
    ahead = 0 if grid.cells.heading[node] == RIGHT else 2
    if network.nodes[node].kind != "source":
        return {ahead: 0.0}
    return {d: (0.0 if d == ahead else BESIDE_RIGHT) for d in range(4)}


def _allowed_ends(network: Network, grid: RoutingGrid, node: str) -> set[int]:
    """Steps by which a wire may arrive at a node."""
    kind = network.nodes[node].kind
    ahead = 2 if grid.cells.heading[node] == LEFT else 0
    if kind == "box" and network.count_incoming(node) <= 1:
        return {ahead}
    if kind in ("box", "bar", "sum"):
        return {0, 1, 2, 3} - {(ahead + 2) % 4}
    return {0, 1, 2, 3}


def _cheapest(
    network: Network, grid: RoutingGrid, net: Net, target: str
) -> tuple[tuple[Vertex, ...], float] | None:
    goal, entries = grid.vertex(target), _allowed_ends(network, grid, target)
    heap: list[tuple[float, float, Vertex, int]] = []
    costs: dict[tuple[Vertex, int], float] = {}
    before: dict[tuple[Vertex, int], tuple[Vertex, int] | None] = {}

    # an entry (vertex, d) means: leave this vertex by step d
    def offer(cost: float, vertex: Vertex, d: int, came: tuple[Vertex, int] | None) -> None:
        if (vertex, d) not in grid.edges and cost < costs.get((vertex, d), float("inf")):
            costs[vertex, d] = cost
            before[vertex, d] = came
            heapq.heappush(heap, (cost + grid.between(vertex, goal), cost, vertex, d))

    for vertex, d, cost in _starts(network, grid, net):
        offer(cost, vertex, d, None)
    while heap:
        _, cost, vertex, d = heapq.heappop(heap)
        if cost > costs[vertex, d]:
            continue
        after = vertex[0] + STEPS[d][0], vertex[1] + STEPS[d][1]
        if not (0 <= after[0] < grid.size[0] and 0 <= after[1] < grid.size[1]):
            continue
        cost += grid.between(vertex, after)
        if after == goal and d in entries:
            return _trace_back(before, (vertex, d), after), cost
        if after in grid.blocked:
            continue
        nets_here = grid.used.get(after, {})
        if not nets_here:
            door, inwards = grid.doors.get(after, ("", -1))
            turns = [e for e in ((d + 3) % 4, (d + 1) % 4) if not door or e == inwards]
            if vertex in grid.blocked:  # just out of its door
                turns = [(d + 3) % 4, (d + 1) % 4]
            for e in (d, *turns):
                offer(cost + (0.0 if e == d else BEND), after, e, (vertex, d))
        elif net.name not in nets_here and len(nets_here) == 1:
            (steps,) = nets_here.values()
            if steps == {(d + 1) % 4, (d + 3) % 4}:
                offer(cost + CROSSING, after, d, (vertex, d))
    return None


def _starts(network: Network, grid: RoutingGrid, net: Net) -> Iterator[tuple[Vertex, int, float]]:
    """Vertex, step and cost of each start of a net's wire: at its source or its other wires."""
    if net.name not in grid.begun:
        source = grid.vertex(net.source)
        for d, cost in _steps_out(network, grid, net.source).items():
            yield source, d, cost
    for vertex, nets in grid.used.items():
        _, inwards = grid.doors.get(vertex, ("", -1))
        may_end = inwards == -1 or inwards in nets.get(net.name, ())
        if set(nets) == {net.name} and vertex not in grid.blocked and may_end:
            for d in {0, 1, 2, 3} - nets[net.name]:
                yield vertex, d, TAKE_OFF if len(nets[net.name]) == 2 else AGAIN


def _trace_back(
    before: dict[tuple[Vertex, int], tuple[Vertex, int] | None],
    last: tuple[Vertex, int],
    goal: Vertex,
) -> tuple[Vertex, ...]:
    way = [goal]
    at: tuple[Vertex, int] | None = last
    while at is not None:
        way.append(at[0])
        at = before[at]
    return tuple(reversed(way))
