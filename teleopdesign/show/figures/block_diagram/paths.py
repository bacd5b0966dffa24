"""The paths along which a diagram is laid out: one from its first input to a motion, then the rest.

Every node is on one path. The first path, the spine, is the longest way from an input to a moving
body. Every further path starts at placed nodes or inputs and ends at a placed node that it meets.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from .network import Network

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
