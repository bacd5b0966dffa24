"""An upper bound of the force that the actuation of a body makes from a command."""

from __future__ import annotations

import math

from ..base.errors import ModelError
from ..blocks import Body
from ..effects import SIGNALS, delayed, sort_by_action
from .friction_interval import lowest_of, parameter_box, stays_within
from .reach import Reach, signal_ranges
from .simulated import without_absent


def largest_acting_force(
    body: Body, command: float, reach: Reach | None = None, *, errors: float
) -> float:
    """Upper bound of abs(acting force), N, under any command of at most this size (N), also late.

    errors: range of the parameters to either side, in standard errors
    returns: inf where no bound is known
    """
    body = without_absent(body, surely=True)
    box = signal_ranges(reach) | parameter_box(body, errors=errors)
    largest = command
    for effect in sort_by_action(body.effects, "actuation"):
        # delayed signals and states of a stage lie in the same range
        law = effect.expression().replace(delayed, lambda signal, _: signal)
        states = effect.state_symbols().values()
        within = dict.fromkeys((SIGNALS["command"], *states), (-largest, largest))
        try:
            if not all(stays_within(effect, s, box | within) for s in states):
                return math.inf
            ends = [
                lowest_of(body, way * law, reach, errors=errors, ranges=within)[0].low
                for way in (1, -1)
            ]
        except ModelError:
            return math.inf
        largest = max(abs(x) for x in ends)
    return largest
