"""Claims over a box about linear diagrams: exact for rational diagrams, else at points."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp
from sympy.polys.polyerrors import PolynomialError

from ...base.errors import ModelError
from ...derive.all_states import AllStates, all_states, is_well_posed
from ...derive.effort import TooMuchEffort, try_within_effort
from ...derive.polynomials import is_hurwitz
from ...derive.responses import Responses
from ...diagrams import Diagram
from ..claims.certificate import Certificate
from ..claims.claim import Claim
from ..linear.conditions import impedance_certificate, is_shown, stability_certificate, take_damping
from ..linear.family import Family, family_of_states
from ..linear.matrices import rational
from ..linear.signs import Signs
from ..linear_diagrams import linear_claims
from ..ports import drop_absent_effects, ports
from .box import (
    STABLE,
    IntervalClaim,
    MarginFunction,
    Status,
    ValueBox,
    Worst,
    interval_claim,
    judge_at_points,
    nonlinear_within,
    search_worst,
)
from .late import judge_late
from .margins import pole_margin, port_margin

#: names of claims -> units of their margins
CLAIMS = {"passive": "N s/m", "absolutely stable": "1", "stable": "1/s"}
#: shares of the worst margin that are tested as proved bounds of the margin, the best first
_SHARES = (0.999, 0.9, 0.5)
#: why a claim about a diagram with such a loop is unknown
_ILL_POSED = "a loop has the gain -1 at high frequency: the least change makes a mode grow at once"


def states_over(diagram: Diagram, box: ValueBox, speed: float = 0.0) -> AllStates | None:
    """The equations of a diagram with the values of the box as symbols.

    speed: see `all_states`
    returns: None where there is no such form: a value is in no coefficient as such (in a body's
        structure, in a system of numbers), or the form changes within the box
    raises ModelError: a block without values, or too much exact arithmetic
    """
    symbols = {n: sp.Dummy(f"v{k}", real=True) for k, n in enumerate(box.names)}
    try:
        states = all_states(drop_absent_effects(diagram), values=symbols, speed=speed)
    except TooMuchEffort:
        raise
    except (ModelError, PolynomialError):
        if not box.names:
            raise
        return None
    return states if not box.names or agrees(states, diagram, box, speed) else None


def judge_stability(middle: Diagram, box: ValueBox, points: int, seed: int) -> IntervalClaim:
    """Judge whether every pole of the whole diagram has a negative real part, over a box.

    middle: the diagram with values in the middle of the box;  points, seed: of `search_worst`
    returns: the claim
    raises ModelError: a part is not linear, or a value is not in the linear form of its block
    """
    if bent := nonlinear_within(middle, box):
        raise ModelError(f"{middle.name}: stable: {', '.join(bent)} has no linear form")
    states = states_over(middle, box)
    if states is None:
        raise ModelError(
            f"{middle.name}: stable: expected blocks whose values are in their linear form"
        )
    if not is_well_posed(middle, all_states(middle)):
        worst = Worst(box.centre, float("nan"), 1)
        return interval_claim(STABLE, "unknown", worst, box, "1/s", _ILL_POSED)
    p = normalise(states.determinant())
    if states.times:
        return judge_late(p, states.times, box, points, seed)
    return _judge_polynomial(p, middle.name, box, points, seed)


def normalise(p: Any) -> Any:
    """The polynomial divided by its largest number: floats of it then exist."""
    return p.mul_ground(1 / max(map(abs, p.values()))) if p else p


def _judge_polynomial(p: Any, name: str, box: ValueBox, points: int, seed: int) -> IntervalClaim:
    signs = Signs(box.exact)
    worst = search_worst(pole_margin(p), box, points=points, seed=seed)
    for point in (worst.point, *worst.suspects) if worst.margin <= 0 else ():
        there = tuple(map(float, point))
        if not is_hurwitz(Signs(ValueBox(box.names, there, there).exact).middle(p)):
            pole = -pole_margin(p)(point)
            how = f"a pole with real part {pole:.4g} 1/s; not Hurwitz by Routh's scheme, exactly"
            worst = replace(worst, point=point, margin=-pole)
            return interval_claim(STABLE, "refuted", worst, box, "1/s", how)

    def certificates(bound: Fraction) -> tuple[Certificate, ...]:
        title = f"{name}: every pole has a real part below -{bound} 1/s, s counted from there"
        moved = _move_axis(p, bound)
        return (stability_certificate(title, moved, names=box.names, ends=box.exact, signs=signs),)

    return _prove(
        interval_claim(STABLE, "evidence", worst, box, "1/s", ""),
        signs,
        lambda bound: signs.is_hurwitz(_move_axis(p, bound)),
        certificates,
        "its characteristic polynomial is nowhere zero on the axis",
    )


def _move_axis(p: Any, left: Fraction) -> Any:
    """The polynomial with all roots moved to the right by `left` (1/s)."""
    s = p.ring.gens[0]
    return p.compose(s, s - rational(left))


def judge_linear(
    alone: Diagram, box: ValueBox, claim: str, points: int, seed: int
) -> IntervalClaim:
    """Judge the passivity or absolute stability of a linear diagram at its ports, over a box.

    alone: the diagram without hand and environment;  claim: "passive" or "absolutely stable"
    points, seed: of `search_worst`;  returns: the claim
    """
    statement = f"its ports are {'together ' * (claim == 'passive')}{claim}"
    states = states_over(alone, box)
    if states is None:
        return _point_by_point(alone, box, claim, points, seed, statement)
    family = family_of_states(states, ports(alone), box.names, box.exact)
    worst = search_worst(port_margin(family, claim), box, points=points, seed=seed)
    signs, title = Signs(box.exact), f"{alone.name}: {statement}"

    def decide(point: np.ndarray) -> IntervalClaim:
        exact = _settle(alone.with_values(box.named(point)), claim)
        status: Status = "refuted" if exact.status == "refuted" else "unknown"
        how = f"at the worst point of the search: {exact.verdict}"
        there = replace(worst, point=point)
        if exact.holds:
            status, how, there = "evidence", "", replace(there, margin=max(worst.margin, 0.0))
        elif status == "refuted":
            how = str(exact.verdict)
            there = there if worst.margin < 0 else replace(there, margin=-np.inf)
        return interval_claim(statement, status, there, box, CLAIMS[claim], how, at_worst=exact)

    made = decide(worst.point)
    if made.status == "evidence" and family.times:
        each = _point_by_point(alone, box, claim, points, seed, statement)
        how = "with a dead time nothing is proved over a box: every point is decided by itself"
        return replace(made, points=each.points, how=how) if each.status == "evidence" else each
    if made.status == "evidence":
        made = _prove(
            made,
            signs,
            lambda bound: is_shown(signs, family, claim, bound),
            lambda bound: _certificates(signs, family, claim, bound, title),
            "its conditions are polynomials of one sign",
            shares=_SHARES if claim == "passive" else (),
        )
    if made.status == "evidence":  # nor does the margin show it at the suspects
        others = (decide(point) for point in worst.suspects)
        made = next((one for one in others if one.status != "evidence"), made)
    return made


def _prove(
    made: IntervalClaim,
    signs: Signs,
    is_shown: Callable[[Fraction], bool],
    certificates: Callable[[Fraction], tuple[Certificate, ...]],
    what: str,
    shares: Sequence[float] = _SHARES,
) -> IntervalClaim:
    """The claim, proved where it is shown for the whole box and the checker accepts that.

    made: the claim as evidence;  what: is shown, in words
    is_shown, certificates: with a margin that is taken away, in the unit of the claim
    shares: of the worst margin that are tested as a proved bound
    """

    def shown(margin: Fraction) -> bool:
        return try_within_effort(lambda: is_shown(margin), False)

    if not shown(Fraction(0)):
        why = f"not shown on {signs.cells} parts of it, or modes that no port shows"
        return replace(made, how=f"no proof over the whole box: {why}")
    how = (
        f"{what}: {signs.polynomials} shown by Bernstein coefficients on "
        f"{signs.cells} parts of the box, in exact arithmetic"
    )
    shares = shares if np.isfinite(made.margin) else ()
    margins = (Fraction(made.margin * share).limit_denominator(10**6) for share in shares)
    bound = next((c for c in margins if 0 < c <= made.margin and shown(c)), Fraction(0))
    try:
        accepted = certificates(bound)
    except ModelError:
        how = f"{how}; a certificate would ask for more work than its checker does"
        return replace(made, how=how)
    how = f"{how}; {len(accepted)} certificate{'s' * (len(accepted) > 1)}"
    margin = float(bound)
    return replace(made, status="proved", proved_margin=margin, how=how, certificates=accepted)


def _certificates(
    signs: Signs, family: Family, claim: str, bound: Fraction, title: str
) -> tuple[Certificate, ...]:
    """One for the ports, and one for all modes, where the ports do not show all of them."""
    kept = take_damping(family, bound)
    first = impedance_certificate(title, family, kept, claim, signs)
    if not family.hides:
        return (first,)
    more = "every mode decays with dampers at the ports"
    modes = stability_certificate(
        more, family.held, names=family.names, ends=family.ends, signs=signs
    )
    return first, modes


def margin_over(diagram: Diagram, box: ValueBox, claim: str) -> MarginFunction | None:
    """The margin of a claim as a function of a point of the box; numerical, compiled once.

    returns: None where the values of the box are not in the linear forms of the diagram
    """
    states = states_over(diagram, box)
    if states is None or (claim == "stable" and states.times):
        return None
    if claim == "stable":
        return pole_margin(normalise(states.determinant()))
    return port_margin(family_of_states(states, ports(diagram), box.names, box.exact), claim)


def _settle(alone: Diagram, claim: str) -> Claim:
    """The claim at a single point of the box, by the exact tests."""
    there = drop_absent_effects(alone)
    return linear_claims(there, ports(there))[-1 if claim == "absolutely stable" else 0].claim


def _point_by_point(
    alone: Diagram, box: ValueBox, claim: str, points: int, seed: int, statement: str
) -> IntervalClaim:
    """Judge a claim at single points, for values that are not symbols in the linear forms."""
    made = judge_at_points(alone, box, lambda diagram: _settle(diagram, claim), points, seed)
    there = _settle(alone.with_values(made.worst), claim)
    how = "its values are not in the linear forms as such: every point is decided by itself"
    how = {"refuted": str(there.verdict), "unknown": made.how}.get(made.status, how)
    return replace(made, statement=statement, unit=CLAIMS[claim], how=how, at_worst=there)


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
