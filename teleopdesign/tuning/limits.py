"""Limits of a search: on the margin of a claim, on the margin of a loop, or on a measure.

limit("passive")                                     at all ports, margin >= 0
limit("passive", over={"Z_M.inertia": (0.1, 0.3)})   for all values in the intervals
limit("delay margin", least=2e-3, controller="H")    s
limit("tracking_error", most=1e-3)                   any measure, or a function of the result
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from ..base.arguments import check_types
from ..base.errors import ModelError, UnstableLoop, did_you_mean
from ..base.frozen import ByValue
from ..base.shown import Shown
from ..controllers import Controller
from ..controllers import controller as make_controller
from ..diagrams import Diagram
from ..frequency import delay_margin, gain_margin, loop_gain, phase_margin
from ..passivity.intervals.box import ValueBox
from ..passivity.intervals.linear import CLAIMS, margin_over
from ..passivity.intervals.over_box import claim_over_intervals
from ..passivity.ports import drop_absent_effects, nonlinear_parts, without_holders
from ..simulate import Sampling
from ..studies.chosen_measures import Measure, measures_of
from ..studies.measures import MEASURES

#: margins of the loop of a controller, and their units
LOOP_MARGINS = {"delay margin": "s", "gain margin": "1", "phase margin": "deg"}


@dataclass(frozen=True, eq=False)
class TuningLimit(Shown, ByValue):
    """A bound, from below or above, on the margin of a claim, the margin of a loop or a measure.

    over: intervals of values, for all of which the limit must hold;  controller: of the loop
    measure: the bounded measure; None: `name` is a claim or a margin of a loop
    """

    name: str
    bound: float
    from_above: bool
    over: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    controller: str = "H"
    measure: Measure | None = None

    @property
    def unit(self) -> str:
        """Unit of the margin; "" for a measure, whose unit is known only after an evaluation."""
        return {**CLAIMS, **LOOP_MARGINS}.get(self.name, "")

    def excess(self, value: float) -> float:
        """Distance of a value from the bound, in the unit of both; < 0: the limit is violated.

        -inf for NaN: a value that could not be computed violates every limit.
        """
        excess = self.bound - value if self.from_above else value - self.bound
        return float(excess) if not np.isnan(excess) else -np.inf


@check_types
def limit(
    what: Any,
    *,
    least: float | None = None,
    most: float | None = None,
    over: Mapping[str, tuple[float, float]] | None = None,
    controller: str = "H",
) -> TuningLimit:
    """A limit for `tune`.

    what: "passive", "absolutely stable" or "stable" (margins in N s/m, 1 and 1/s, at least 0);
        "delay margin" (s), "gain margin" (factor up or down), "phase margin" (degrees); a measure
    least, most: lower or upper bound, one of them, in the unit of the margin or measure
    over: intervals of values, for all of which the limit must hold
    controller: name of the controller whose loop has the margin; where a computer samples it, each
        hold counts as a dead time of half a period
    raises ModelError: no measure of that name, no bound or two
    """
    names = (*CLAIMS, *LOOP_MARGINS)
    known = isinstance(what, str) and what in names
    if isinstance(what, str) and not known and what not in MEASURES:
        near = did_you_mean(what, (*names, *MEASURES))
        raise ModelError(f'limit: no limit "{what}", has {", ".join(names)} or a measure{near}')
    measure = None if known else measures_of([what])[0]
    name = what if measure is None else measure.name
    if known and what in CLAIMS and least is None:
        least = 0.0
    if (least is None) == (most is None):
        raise ModelError(f"limit {name}: expected least or most, found {least} and {most}")
    if known and most is not None:
        raise ModelError(f"limit {name}: a margin is to be large: expected least, found most")
    bound = float(most if most is not None else least)  # type: ignore[arg-type]
    return TuningLimit(name, bound, most is not None, dict(over or {}), controller, measure)


def limit_of(content: Any) -> TuningLimit:
    """A limit; the name of a claim becomes a limit."""
    return content if isinstance(content, TuningLimit) else limit(content)


def loop_margin(
    diagram: Diagram, name: str, at: str, computer: Sampling | Literal["continuous"]
) -> float:
    """Margin of a controller's loop; -inf: the loop is unstable, inf: nothing limits the margin.

    at: name of the controller;  computer: that samples it. It holds its command, and where the law
        has states its reading too: each counts as a dead time of half a period
    """
    part = next((c for c in diagram.controls if c.name == at), None)
    law = None if part is None or part.analog else part.controller
    if isinstance(computer, Sampling) and isinstance(law, Controller):
        if not any(stage.law.in_z for stage in law.stages):
            holds = 1 + any(stage.law.states for stage in law.stages)
            late = computer.delay + 0.5 * holds * computer.period
            diagram = diagram.with_block(at, law.then(make_controller("delay", {"time": late})))
    margin = {
        "delay margin": delay_margin,
        "phase margin": phase_margin,
        "gain margin": gain_margin,
    }[name]
    try:
        return margin(loop_gain(diagram, controller=at))
    except UnstableLoop:
        return -np.inf


def margin_function(
    limited: TuningLimit,
    diagram: Diagram,
    box: ValueBox,
    computer: Sampling | Literal["continuous"],
) -> Callable[[dict[str, float]], float]:
    """The margin of a claim or a loop as a function of the diagram's values, made once per search.

    box: of all values that vary; for a linear diagram the margin is compiled over this box
    computer: of the controllers, as in `loop_margin`
    """
    if limited.name in LOOP_MARGINS:
        name, at = limited.name, limited.controller
        return lambda v: loop_margin(diagram.with_values(v), name, at, computer)
    whole = diagram if limited.name == "stable" else without_holders(diagram)
    kept = tuple(n for n in box.names if n in whole.values)
    if not nonlinear_parts(drop_absent_effects(whole)):
        within = box.select(kept)
        middle = whole.with_values(within.named(within.centre))
        margin = margin_over(middle, within, limited.name)
        if margin is not None:
            return lambda v: margin(np.array([v[n] for n in kept]))

    def settle(values: dict[str, float]) -> float:
        claim = claim_over_intervals(diagram.with_values(values), {}, claim=limited.name, points=0)
        if not np.isnan(claim.margin):
            return claim.margin
        return 0.0 if claim.holds else -1.0

    return settle
