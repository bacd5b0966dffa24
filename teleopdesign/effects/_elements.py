"""Elements of a Maxwell-slip friction: which element a parameter belongs to.

The hysteresis of several springs does not depend on their order. A fit may end in any order, so the
elements are sorted, and the records must determine the first two.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ._facts import RecordFacts, slip_is_observable

#: an element whose level is below this part of the friction level comes last, whatever its
#: stiffness, because records do not determine its stiffness. A higher limit puts visible elements
#: last, a lower one puts invisible elements first
LITTLE = 0.02
#: an element whose force reaches this part of the friction level within the travel is compared with
#: the travel; one with a smaller force does not matter, whatever values a fit gives it
CARRIES = 0.05
#: numbers of the further elements; the first element has the rest of the level
MORE = (2, 3, 4)


def softest_first(p: Mapping[str, float], body: Mapping[str, float]) -> dict[str, float]:
    """The same elements sorted by stiffness: 3 and 4 are the stiffest, which may be rigid.

    Elements with almost no friction come last.
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


def elements_slip(p: Any, facts: RecordFacts) -> str | None:
    """A sentence where no element slips visibly in both directions; else None.

    An element that never slips within the travel is a spring beside those that do.
    """
    slips = {i: getattr(p, f"level_{i}") for i in MORE}
    slips[1] = (level := facts.friction) - sum(slips.values())
    ways = {i: slips[i] / getattr(p, f"stiffness_{i}") for i in slips if slips[i] > 0.0}
    carry = [w for i, w in ways.items() if slips[i] * min(1.0, facts.sweep / w) > CARRIES * level]
    visible = [w for w in carry if w > 0.5 * facts.step]
    if visible and 2.0 * min(visible) > facts.sweep:
        return (
            f"no element slips both ways within the travel of {facts.text(facts.sweep, 'position')}"
            ": the record shows no loop, and the effect imitates a spring"
        )
    return slip_is_observable("the softest element", list(ways.values()), facts)
