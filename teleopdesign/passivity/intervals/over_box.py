"""Judge a claim over intervals of a diagram's values: status, worst case and method."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from ...base.arguments import check_types
from ...base.errors import ModelError
from ...base.expectations import describe_value
from ...derive.effort import TooMuchEffort, bounded_effort
from ...diagrams import Diagram
from ...diagrams.units import first_axis, unit_of_value
from ..claims.claim import use_rotary_units
from ..linear.impedance import decimal, exact
from ..ports import drop_absent_effects, ports, without_holders
from .box import IntervalClaim, ValueBox, box_of, nonlinear_within
from .friction import judge_friction
from .linear import CLAIMS, judge_at_points, judge_linear, judge_stability
from .worst import Worst, interval_claim


@check_types
def claim_over_intervals(
    diagram: Diagram,
    intervals: Mapping[str, tuple[float, float]],
    *,
    claim: str | Callable[[Diagram], Any] = "passive",
    points: int = 64,
    seed: int = 0,
) -> IntervalClaim:
    """Does a claim hold for all values within intervals, and where is it worst?

    intervals: names of `diagram.values` -> (low, high), SI
    claim: "passive": at all ports together, hands and environments (`role`) left out;
        "absolutely stable": two ports between any passive terminations; "stable": every pole of the
        whole diagram, hand and environment included, has a negative real part; delay blocks and
        intervals of their dead times are allowed. Or a function of a diagram that returns a margin
        (>= 0: the claim holds) or a `Claim`
    points: number of points that are evaluated besides the vertices and the middle;  seed: of these
    returns: proved over the whole box, refuted at a point, or checked numerically. Proofs exist for
        linear diagrams, for friction with its cancellation (by theorems), and, with dead times, for
        "stable" alone: for all dead times from 0 on, in floats with all rounding bounded.
        Controllers act in continuous time
    raises ModelError: an unknown value or claim, no valid interval, no port
    """
    middle, box = box_of(diagram, intervals)
    if callable(claim):
        return _finish(diagram, intervals, judge_at_points(middle, box, claim, points, seed))
    if claim not in CLAIMS:
        raise ModelError(f"claim: found {describe_value(claim)}, expected {', '.join(CLAIMS)}")
    try:
        with bounded_effort():
            made = _judge(diagram, middle, box, claim, points, seed)
    except TooMuchEffort as problem:
        worst = Worst(box.centre, float("nan"), 0)
        what = f'it is "{claim}"'
        made = interval_claim(
            what, "unknown", worst, box, CLAIMS[claim], f"no linear form: {problem}"
        )
    return _finish(diagram, intervals, made)


def _judge(
    diagram: Diagram, middle: Diagram, box: ValueBox, claim: str, points: int, seed: int
) -> IntervalClaim:
    """Judge a claim by its name; middle: the diagram with values in the middle of the box."""
    if claim == "stable":
        return judge_stability(middle, box, points, seed)
    alone = without_holders(drop_absent_effects(middle))
    away = [n for n in box.names if not without_holders(middle).has(n.partition(".")[0])]
    if away:
        raise ModelError(f'{away[0]}: holds a port, and no part of what is "{claim}": see "stable"')
    at = ports(alone)
    if len(at) > 2 or (claim == "absolutely stable" and len(at) != 2):
        raise ModelError(f'{diagram.name}: "{claim}" is for two ports at most, found {len(at)}')
    if nonlinear_within(without_holders(middle), box):
        return judge_friction(without_holders(middle), box, claim)
    return judge_linear(without_holders(middle), box, claim, points, seed)


def _finish(
    diagram: Diagram, intervals: Mapping[str, tuple[float, float]], made: IntervalClaim
) -> IntervalClaim:
    """The result with all values of the call, in the units of the axis."""
    fixed = {n: float(a) for n, (a, _) in intervals.items()}
    texts = {n: [decimal(exact(float(x))) for x in ends] for n, ends in intervals.items()}
    within = ", ".join(f"{n} {low} to {high}" for n, (low, high) in texts.items())
    turned = use_rotary_units if first_axis(diagram) == "revolute" else str
    return replace(
        made,
        statement=f"{diagram.name}: {made.statement}, for all {within or 'its values'}",
        intervals={n: (float(a), float(b)) for n, (a, b) in intervals.items()},
        worst={n: made.worst.get(n, x) for n, x in fixed.items()},
        unit=turned(f"1 {made.unit}")[2:],
        how=turned(made.how),
        time="continuous" if any(not c.analog for c in diagram.controls) else "any",
        units={n: unit_of_value(diagram, n) for n in intervals},
    )
