"""Whether equations with values as symbols are those of the diagram everywhere in a box."""

from __future__ import annotations

import numpy as np

from ...derive.all_states import AllStates, all_states
from ...derive.responses import Responses
from ...diagrams import Diagram
from ..ports import drop_absent_effects
from .box import ValueBox

#: points inside the box at which the equations are compared, besides two opposite vertices
_COMPARED = 2
#: s at which responses are compared, 1/s, and the relative difference that is rounding
_AT, _ROUNDING = np.array([3.1 + 4.7j]), 1e-6


def agrees(states: AllStates, diagram: Diagram, box: ValueBox, speed: float) -> bool:
    """Whether all signals respond alike to all signals from outside, at some points of the box.

    Values may make an effect absent at an end of an interval, and then it has another form there.

    states: with the values of the box as the first symbols after s;  speed: see `all_states`
    """
    symbols = states.ring.symbols[1 : 1 + len(box.names)]
    first = Responses(states, states.unknown, states.outside)
    for point in (np.array(box.low), np.array(box.high), *box.inside(_COMPARED, 0)):
        diagram = diagram.with_values(box.named(point))
        there = all_states(drop_absent_effects(diagram), speed=speed)
        shared = tuple(n for n in states.unknown if n in there.unknown)
        one = first.at(_AT, dict(zip(symbols, map(float, point), strict=True)))[0]
        other = Responses(there, shared, there.outside).at(_AT)[0]
        largest = np.nan_to_num(np.abs(one)).max(initial=0.0)
        one = one[[states.unknown.index(n) for n in shared]]
        size = np.abs(one).max(axis=1, initial=0.0) + _ROUNDING * largest
        if (np.abs(one - other).max(axis=1, initial=0.0) > _ROUNDING * size).any():
            return False
    return True
