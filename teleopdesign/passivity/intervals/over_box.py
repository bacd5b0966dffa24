"""Judge a claim over intervals of a diagram's values: status, worst case and method.

For friction with its cancellation the vertices of the box decide.

A Dahl or bounded cancellation (f_D, sigma_D) of Coulomb or Dahl friction (f_C, sigma_p) is passive
if f_D <= f_C and sigma_D^2 f_C <= sigma_p^2 f_D (`theorems/dahl_compensation.py`). Written as
f_C - f_D >= 0 and sigma_p^2 f_D - sigma_D^2 f_C >= 0, each left side is monotone in each of the
four positive values alone, so its least value over a box is at a vertex. The linear part of the
diagram is judged over the whole box. Any other friction is judged only at the vertices and in the
middle.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from ...base.arguments import check_types
from ...base.errors import ModelError
from ...base.expectations import describe_value
from ...blocks import Body
from ...controllers import laws_that_declare
from ...derive.effort import TooMuchEffort, bounded_effort
from ...diagrams import Diagram
from ...diagrams.units import first_axis, unit_of_value
from ..claims.claim import use_rotary_units
from ..declarations import is_shipped
from ..diagram_claims import composed_claim
from ..friction_pairs import (
    FrictionPair,
    friction_pairs,
    pair_claims,
    proof_of,
    refuting,
    without_pair,
)
from ..linear.conditions import is_shown
from ..linear.family import family_of_states
from ..linear.impedance import decimal, exact
from ..linear.signs import Signs
from ..ports import drop_absent_effects, nonlinear_parts, ports, without_holders
from .box import (
    IntervalClaim,
    ValueBox,
    Worst,
    box_of,
    interval_claim,
    judge_at_points,
    nonlinear_within,
)
from .linear import CLAIMS, judge_linear, judge_stability, states_over


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
        (>= 0: the claim holds), whether the claim holds, or a `Claim`
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


#: effects that the two conditions cover completely, with their values
_FRICTION: dict[str, tuple[str, ...]] = {"coulomb": ("level",), "presliding": ("stiffness",)}


def judge_friction(middle: Diagram, box: ValueBox, claim: str) -> IntervalClaim:
    """Judge the passivity (or absolute stability) of a diagram with friction over a box.

    claim: "passive" or "absolutely stable"
    """
    points = [*box.vertices(), box.centre]
    answers, spends_damping = [], False
    for point in points:
        here = drop_absent_effects(middle.with_values(box.named(point)))
        pairs = friction_pairs(here)
        composed = composed_claim(here, ports(here), pairs)
        by_pair = [pair_claims(pair, simulated=False) for pair in pairs]
        spends_damping |= any(p.spends_damping for p in map(proof_of, by_pair) if p is not None)
        others = refuting(here, pairs)
        answers.append((point, composed.claim if composed else None, others))
    worst = Worst(box.centre, float("nan"), len(points))
    statement = f"its ports are {'together ' * (claim == 'passive')}{claim}"
    for point, whole, others in answers:
        # what takes energy out of friction at one port need not make any termination unstable
        against = others if claim == "passive" else []
        if whole is None and against:
            how = f"{against[0].statement}: {against[0].verdict}"
            there = replace(worst, point=point)
            return interval_claim(statement, "refuted", there, box, "", how, at_worst=against[0])
    if any(whole is None for _, whole, _ in answers):
        why = "at some vertex neither a theorem nor a motion settles friction with its cancellation"
        return interval_claim(statement, "unknown", worst, box, "", why)
    # over the box the linear rest is judged with all of its damping
    decided = not spends_damping and _vertices_decide(middle, box)
    if decided and _rest_is_passive(middle, box):
        how = (
            "each condition on friction and cancellation is monotone in each value, so that the "
            f"{len(points) - 1} vertices decide; the linear rest by Bernstein coefficients"
        )
        return interval_claim(statement, "proved", worst, box, "", how, at_worst=answers[-1][1])
    how = "proved at each of these points alone"
    return interval_claim(statement, "evidence", worst, box, "", how, at_worst=answers[-1][1])


def _vertices_decide(middle: Diagram, box: ValueBox) -> bool:
    """Whether the two conditions, and so the vertices, decide for all values of friction."""
    for pair in friction_pairs(drop_absent_effects(middle)):
        body, law = pair.body.body, pair.cancellation
        assert isinstance(body, Body)
        effects = [e for e in body.effects if e.role.startswith("friction")]
        if not all(e.name in _FRICTION and is_shipped(e) for e in effects):
            return False
        if body.parameters.get("presliding.bristle_damping"):
            return False
        if law is None:
            continue
        # a law of one's own keeps its bound at the values that were looked at, no more is known
        if pair.stage is None or pair.stage.law not in laws_that_declare("bound"):
            return False
        known = pair.stage.law.bound, pair.stage.law.bristle_stiffness
        for block, part, value in map(_split, box.names):
            if block == law.name and (part != pair.stage.name or value not in known):
                return False
    return bool(len(box.vertices()) == 2 ** len(box.names))


def _belongs_to_friction(name: str, pairs: list[FrictionPair]) -> bool:
    """Whether a value belongs to friction or its cancellation, and not to the linear rest."""
    block, part, value = _split(name)
    laws = [pair.cancellation.name for pair in pairs if pair.cancellation is not None]
    bodies = [pair.body.name for pair in pairs]
    return block in laws or (block in bodies and value in _FRICTION.get(part, ()))


def _split(name: str) -> tuple[str, str, str]:
    """Block, part of the block and value of a name of `diagram.values`."""
    block, _, rest = name.partition(".")
    part, _, value = rest.rpartition(".")
    return block, part, value


def _rest_is_passive(middle: Diagram, box: ValueBox) -> bool:
    """Whether the diagram without friction and cancellation is passive over the whole box."""
    rest = drop_absent_effects(middle)
    pairs = friction_pairs(rest)
    for pair in pairs:
        rest = without_pair(rest, pair)
    other_values = tuple(n for n in box.names if not _belongs_to_friction(n, pairs))
    if nonlinear_parts(rest):
        return False
    if not other_values:
        return True  # it is proved in the composed claim
    within = box.select(other_values)
    states = states_over(rest, within)
    if states is None or states.times:
        return False
    family = family_of_states(states, ports(rest), within.names, within.exact)
    return is_shown(Signs(within.exact), family, "passive")
