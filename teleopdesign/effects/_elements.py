"""Elements of a friction that slip in turn: which of them a number stands for.

The hysteresis of several springs is the same in any order of them. A fit ends in one order or
another, and what records must tell is asked of the first two.
"""

from __future__ import annotations

from collections.abc import Mapping

#: part of the friction level below which an element comes last, whatever its stiffness: records do
#: not tell how stiff it is. Higher: one that shows comes last; lower: one that does not, first
LITTLE = 0.02
#: elements beside the first, which carries what these leave of the level
MORE = (2, 3, 4)


def softest_first(p: Mapping[str, float], body: Mapping[str, float]) -> dict[str, float]:
    """The same elements by stiffness: 3 and 4 are the stiff ones, which may be rigid.

    Those that carry little come last.

    p: `stiffness_1`, `level_2`, ... of a body's elements;  body: its numbers, with `coulomb.level`
    """
    level = {i: p[f"level_{i}"] for i in MORE}
    level[1] = max(body["coulomb.level"] - sum(level.values()), 0.0)
    least = LITTLE * body["coulomb.level"]
    by_stiffness = sorted(level, key=lambda i: (level[i] <= least, p[f"stiffness_{i}"]))
    values = dict(p)
    for i, element in enumerate(by_stiffness, 1):
        values[f"stiffness_{i}"] = p[f"stiffness_{element}"]
        if i in MORE:
            values[f"level_{i}"] = level[element]
    return values
