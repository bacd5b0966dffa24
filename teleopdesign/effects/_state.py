"""A hidden state of an effect: its rate, its start, its correction and its stop."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import sympy as sp

from ..base.arguments import check_types

#: factor on the position of a stop where it holds a state at rest. Between the two the rate falls
#: steadily: a state whose stop moves outwards would else chatter between two rates
HELD = 1.001


@check_types
@dataclass(frozen=True)
class State:
    """A hidden state: its quantity and rate law(now, p), where `now` also has the states.

    start: the signal that it equals at the start of a record; "": it starts in steady state, or at
        rest
    correction: correction(now, p), the rate by which the unexplained force, also in `now`, leads
        the state back along a measured motion; None: no correction
    dry: dry(now, p), the largest rate by which dry friction slows the state down; it holds a state
        at zero where this rate is enough. None: no such friction
    stop: stop(now, p), the largest size of the state, as of a spring that slips; None: no stop
    """

    quantity: str
    rate: Callable[[Any, Any], sp.Expr]
    start: str = ""
    correction: Callable[[Any, Any], sp.Expr] | None = None
    dry: Callable[[Any, Any], sp.Expr] | None = None
    stop: Callable[[Any, Any], sp.Expr] | None = None

    def rate_with_stop(self, now: Any, p: Any, name: str) -> sp.Expr:
        """The rate; none at the stop, and back to the stop where this has become smaller."""
        rate = sp.sympify(self.rate(now, p), strict=True)
        if self.stop is None or rate == 0:
            return rate
        z, stop = sp.Abs(getattr(now, name)), self.stop(now, p)
        free = sp.Or(z < stop, getattr(now, name) * rate <= 0)
        gap = HELD * stop - z
        slower, back = gap / ((HELD - 1) * stop), gap / (stop + z)
        return sp.Piecewise((rate, free), (rate * slower, gap > 0), (rate * back, True))
