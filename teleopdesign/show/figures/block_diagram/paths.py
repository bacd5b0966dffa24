"""The paths along which a diagram is laid out: one from its first input to a motion, then the rest.

Every node is on one path. The first path, the spine, is the longest way from an input to a moving
body. Every further path starts at placed nodes or inputs and ends at a placed node that it meets.

A cell (column, row) and a heading for every node.

The spine runs from left to right in row 0. A path that leads back lies in a row below and runs from
right to left; a path beside the spine lies in a row above. Inputs from outside stand before or
beside their target.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from .shapes import Network

LONGEST = 12  # most nodes of a path: a longer one would make a drawing of one row
MOST_STEPS = 4000  # most steps of a search for a longest path; more would not change the drawing


@dataclass(frozen=True)
class Path:
    """Nodes in the order of the signal flow;  start, end: placed nodes around them, or None."""

    nodes: tuple[str, ...]
    start: str | None
    end: str | None


def paths(network: Network) -> list[Path]:
    """The spine first, then all other paths, each after the paths at which it starts and ends."""
    spine = _spine(network)
    listed = [Path(spine, None, None)]
    placed = set(spine)
    while len(placed) < len(network.nodes):
        path = _longest_path(network, placed)
        listed.append(path)
        placed |= set(path.nodes)
    return listed


def _spine(network: Network) -> tuple[str, ...]:
    sources = [n for n in network.nodes.values() if n.kind == "source"]
    moving = {n.name for n in network.nodes.values() if n.moving}
    # commands before what acts on bodies from outside; of those the first one named
    commands = [n for n in sources if not n.driver]
    for among in (commands, *([n] for n in sources)):
        longest: list[str] = []
        for source in among:
            way = _longest(network, source.name, set(), lambda n: not moving or n in moving)
            longest = way if len(way) > len(longest) else longest
        if longest:
            return tuple(longest)
    first = next(iter(network.nodes))
    return tuple(_longest(network, first, set(), lambda _: True))


def _longest_path(network: Network, placed: set[str]) -> Path:
    """The longest path through unplaced nodes; paths between two placed nodes come first."""
    best: tuple[tuple[bool, bool, int], Path] | None = None
    starts: list[tuple[str | None, str]] = []
    for node in network.nodes:
        if node in placed:
            starts += [(node, n) for n in network.following(node) if n not in placed]
        elif network.nodes[node].kind == "source":
            starts.append((None, node))
    left = next(n for n in network.nodes if n not in placed)
    for start, first in starts or [(None, left)]:
        meets = _longest(
            network, first, placed, lambda n: any(f in placed for f in network.following(n))
        )
        way = meets or _longest(network, first, placed, lambda _: True)
        rank = (start is not None, bool(meets), len(way))
        if best is None or rank > best[0]:
            end = next((n for n in network.following(way[-1]) if n in placed), None)
            best = rank, Path(tuple(way), start, end)
    assert best is not None
    return best[1]


def _longest(
    network: Network, first: str, closed: set[str], ends: Callable[[str], bool]
) -> list[str]:
    """The longest simple path from `first` to a node that `ends` accepts, by a bounded search."""
    best: list[str] = []
    steps = 0
    way = [first]
    choices = [iter(network.following(first))]
    if ends(first):
        best = [first]
    while choices and steps < MOST_STEPS:
        steps += 1
        node = next(choices[-1], None) if len(way) < LONGEST else None
        if node is None:
            choices.pop()
            way.pop()
        elif node not in closed and node not in way:
            way.append(node)
            choices.append(iter(network.following(node)))
            if len(way) > len(best) and ends(node):
                best = list(way)
    return best


RIGHT, LEFT = 1, -1
Cell = tuple[int, int]


@dataclass
class Cells:
    """node -> cell, and node -> heading (RIGHT or LEFT) of boxes and circles."""

    at: dict[str, Cell] = field(default_factory=dict)
    heading: dict[str, int] = field(default_factory=dict)

    def put(self, node: str, cell: Cell, heading: int) -> None:
        self.at[node] = cell
        self.heading[node] = heading

    def free(self, columns: range, row: int) -> bool:
        """Whether no node stands in these columns of a row."""
        return not any(c in columns and r == row for c, r in self.at.values())


def place(network: Network, branches: Sequence[Path], sides: Mapping[int, int]) -> Cells:
    """Cells and headings of all nodes.

    sides: number of a path -> 1 (below) or -1 (above), for paths that are not on their usual side
    """
    cells = Cells()
    waiting = dict(enumerate(branches))
    spine = waiting.pop(0)
    for column, node in enumerate(spine.nodes):
        cells.put(node, (column, 0), RIGHT)
    while waiting:
        able = [i for i, p in waiting.items() if {p.start, p.end} - {None} <= cells.at.keys()]
        i = min(able, key=lambda i: (_small(waiting[i], network), _span(waiting[i], cells), i))
        _put(network, cells, waiting.pop(i), sides.get(i), spine.nodes)
    return cells


def _small(path: Path, network: Network) -> bool:
    """Whether a path is only a name at a wire's end, placed after blocks and circles."""
    return len(path.nodes) == 1 and network.nodes[path.nodes[0]].kind in ("source", "sink")


def _span(path: Path, cells: Cells) -> int:
    if path.start is None or path.end is None:
        return 0
    return abs(cells.at[path.start][0] - cells.at[path.end][0])


def _put(
    network: Network, cells: Cells, path: Path, side: int | None, spine: tuple[str, ...]
) -> None:
    if _small(path, network):
        _put_small(network, cells, path, spine)
        return
    heading, first = _columns(network, cells, path)
    parents = [cells.at[n][1] for n in (path.start, path.end) if n is not None]
    below = 1 if heading == LEFT else -1
    if parents and all(row > 0 for row in parents):
        below = 1
    side = side or below
    row = (max if side > 0 else min)(parents, default=0) + side
    last = first + heading * (len(path.nodes) - 1)
    columns = range(min(first, last), max(first, last) + 1)
    while not cells.free(columns, row):
        row += side
    for k, node in enumerate(path.nodes):
        cells.put(node, (first + heading * k, row), heading)


def _columns(network: Network, cells: Cells, path: Path) -> tuple[int, int]:
    """Heading of a path, and the column of its first node."""
    n = len(path.nodes)
    ends = [cells.at[e] for e in network.following(path.nodes[-1]) if e in cells.at]
    if path.start is None and not ends:
        return RIGHT, 0
    if path.start is None:
        return RIGHT, min(c for c, _ in ends) - n
    a = cells.at[path.start][0]
    if not ends:
        return RIGHT, a + 1
    b = max(c for c, _ in ends)  # the nearest of those that it goes to
    if b > a:
        return RIGHT, a + 1 + max(0, b - a - 1 - n) // 2
    return LEFT, b + n + max(0, a - b - n) // 2


def _put_small(network: Network, cells: Cells, path: Path, spine: tuple[str, ...]) -> None:
    """Place a name before, below or above its target, or the end of an arrow behind its origin."""
    node, start = path.nodes[0], path.start
    other = path.end if start is None else start
    if start is not None and start == spine[-1]:  # the wire of the spine runs out to the right
        cells.put(node, (1 + max(c for c, _ in cells.at.values()), 0), RIGHT)
        return
    if other is None:
        cells.put(node, (0, 1 + max(r for _, r in cells.at.values())), RIGHT)
        return
    column, row = cells.at[other]
    heading = cells.heading[other]
    ahead = heading if start is not None else -heading
    behind = (column + ahead, row)
    beside = [(column, row + 1), (column, row - 1), (column + ahead, row + 1)]
    occupied = set(cells.at.values())
    below, above = (sum(1 for _, r in occupied if s * r > 0) for s in (1, -1))
    if start is None and row == 0 and above <= below:
        beside[:2] = beside[1::-1]
    straight = (
        start is not None
        or network.nodes[other].kind != "sum"
        or not _is_fed(network, cells, other)
    )
    wished = [behind, *beside] if straight else [*beside, behind]
    k = 2
    while all(c in occupied for c in wished):
        wished += [(column, row + k), (column, row - k)]
        k += 1
    cells.put(node, next(c for c in wished if c not in occupied), heading)


def _is_fed(network: Network, cells: Cells, node: str) -> bool:
    """Whether the node in the cell right behind a node already feeds that node."""
    column, row = cells.at[node]
    behind = (column - cells.heading[node], row)
    return any(
        n in cells.at and cells.at[n] == behind and node in network.following(n)
        for n in network.nodes
    )
