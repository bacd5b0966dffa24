"""A cell (column, row) and a heading for every node.

The spine runs from left to right in row 0. A path that leads back lies in a row below and runs from
right to left; a path beside the spine lies in a row above. Inputs from outside stand before or
beside their target.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from .network import Network
from .paths import Path

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
        able = [i for i, p in waiting.items() if _is_known(p, cells)]
        i = min(able, key=lambda i: (_small(waiting[i], network), _span(waiting[i], cells), i))
        _put(network, cells, waiting.pop(i), sides.get(i), spine.nodes)
    return cells


def _is_known(path: Path, cells: Cells) -> bool:
    return all(n is None or n in cells.at for n in (path.start, path.end))


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
