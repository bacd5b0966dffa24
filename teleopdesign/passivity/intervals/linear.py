"""Claims over a box about linear diagrams: exact for rational diagrams, else at points."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import reduce

import numpy as np
import sympy as sp

from ...base.errors import ModelError
from ...controllers import exact_decimal
from ...derive.all_states import all_states, is_well_posed
from ...derive.polynomials import is_hurwitz
from ...diagrams import Diagram
from ...realise.lti import S
from ..claims.certificate import Certificate
from ..claims.claim import Claim, Unknown
from ..linear_diagrams import linear_claims
from ..ports import drop_absent_effects, ports
from .at_points import judge_at_points
from .box import ValueBox, nonlinear_within
from .box_certificates import impedance_certificate, stability_certificate
from .conditions import Conditions, one_port_is_passive, two_port_is_passive, two_port_is_stable
from .family import Family, family_of
from .interval_claim import Parts, Status, parts_of
from .late_stability import judge_late_stability
from .worst import MarginFunction, Worst, pole_margin, port_margin, search_worst

#: names of claims -> units of their margins
CLAIMS = {"passive": "N s/m", "absolutely stable": "1", "stable": "1/s"}
#: why a claim about a diagram with such a loop is unknown
ILL_POSED = "a loop has the gain -1 at high frequency: the least change makes a mode grow at once"
#: shares of the worst margin that are tested as proved bounds of the margin, the best first
_SHARES = (0.999, 0.9, 0.5)


def judge_stability(middle: Diagram, box: ValueBox, points: int, seed: int) -> Parts:
    """Judge whether every pole of the whole diagram has a negative real part, over a box.

    middle: the diagram with values in the middle of the box;  points, seed: of `search_worst`
    returns: fields of an `IntervalClaim`
    raises ModelError: a part is not linear, or a value is not in the linear form of its block
    """
    statement = "every pole has a negative real part"
    if bent := nonlinear_within(middle, box):
        raise ModelError(f"{middle.name}: stable: {', '.join(bent)} has no linear form")
    family = family_of(middle, box)
    if family is None or not family.is_rational:
        late = judge_late_stability(middle, box, points, seed)
        if late is not None:
            return late
        raise ModelError(
            f"{middle.name}: stable: expected rational blocks whose values are in their linear form"
        )
    ask = Conditions.over(box, family.symbols)
    polynomial = ask.poly(family.characteristic())
    if not is_well_posed(middle, all_states(middle)):
        worst = Worst(box.centre, float("nan"), 1)
        return parts_of(statement, "unknown", worst, box, "1/s", ILL_POSED)
    worst = search_worst(pole_margin(polynomial, ask.symbols), box, points=points, seed=seed)
    if worst.margin <= 0 and not is_hurwitz(_polynomial_at(polynomial, ask, worst.point)):
        how = (
            f"a pole with real part {-worst.margin:.4g} 1/s; not Hurwitz by Routh's scheme, exactly"
        )
        return parts_of(statement, "refuted", worst, box, "1/s", how)
    if not ask.is_hurwitz(polynomial):
        return parts_of(statement, "evidence", worst, box, "1/s", _explain_no_proof(ask))
    how = _describe_effort(ask, "its characteristic polynomial is nowhere zero on the axis")
    shares = (Fraction(str(round(share, 6))) for share in _SHARES)
    shifts = (Fraction(worst.margin).limit_denominator(10**6) * share for share in shares)
    bounds = (c for c in shifts if c > 0 and ask.is_hurwitz(_shift_roots(polynomial, c)))
    bound = next(bounds, Fraction(0))

    def certificates() -> tuple[Certificate, ...]:
        title = (
            f"{middle.name}: every pole has a real part below -{bound} 1/s, s counted from there"
        )
        return (stability_certificate(ask, box, _shift_roots(polynomial, bound), title),)

    proved_margin = float(bound)
    made = parts_of(statement, "proved", worst, box, "1/s", how, proved_margin=proved_margin)
    return _proof(made, certificates)


def _shift_roots(polynomial: sp.Poly, left: Fraction) -> sp.Poly:
    """The polynomial with all roots moved to the right by `left` (1/s)."""
    expression = polynomial.as_expr().subs(S, S - sp.Rational(str(left)))
    return sp.Poly(expression, *polynomial.gens, domain="QQ")


def _polynomial_at(polynomial: sp.Poly, ask: Conditions, point: np.ndarray) -> sp.Poly:
    values = {x: exact_decimal(float(v)) for x, v in zip(ask.symbols, point, strict=True)}
    return sp.Poly(polynomial.as_expr().subs(values), S, domain="QQ")


def judge_linear(alone: Diagram, box: ValueBox, claim: str, points: int, seed: int) -> Parts:
    """Judge the passivity or absolute stability of a linear diagram at its ports, over a box.

    alone: the diagram without hand and environment;  claim: "passive" or "absolutely stable"
    points, seed: of `search_worst`;  returns: fields of an `IntervalClaim`
    """
    statement = f"its ports are {'together ' * (claim == 'passive')}{claim}"
    family = family_of(alone, box)
    if family is None:
        return _point_by_point(alone, box, claim, points, seed, statement)
    z = family.impedance()
    stable = claim == "absolutely stable"
    ask = Conditions.over(box, family.symbols)
    hidden = modes_inside(ask, family, z) if family.is_rational else None
    margin = _margin(family, z, box, claim, [hidden] if hidden is not None else [])
    worst = search_worst(margin, box, points=points, seed=seed)
    exact = _settle(alone, box, worst.point, claim)
    unit = CLAIMS[claim]
    if exact.status == "refuted":
        how = str(exact.verdict)
        worst = worst if worst.margin < 0 else replace(worst, margin=-np.inf)
        return parts_of(statement, "refuted", worst, box, unit, how, at_worst=exact)
    if (
        exact.holds
        and family.is_rational
        and hidden is not None
        and ask.is_hurwitz(hidden)
        and _is_proved(ask, z, claim)
    ):
        bound = Fraction(0) if stable else _bound(ask, z, worst.margin)
        how = _describe_effort(ask, "its conditions are polynomials of one sign")
        worst = replace(worst, margin=max(worst.margin, float(bound)))
        kept = z - sp.Rational(str(bound)) * sp.eye(z.rows)

        def certificates() -> tuple[Certificate, ...]:
            first = impedance_certificate(ask, box, kept, claim, f"{alone.name}: {statement}")
            if hidden.degree() == 0:
                return (first,)
            title = f"{alone.name}: modes that no port shows die out"
            return first, stability_certificate(ask, box, hidden, title)

        more = {"proved_margin": float(bound), "at_worst": exact}
        return _proof(parts_of(statement, "proved", worst, box, unit, how, **more), certificates)
    status: Status = "evidence" if exact.holds else "unknown"
    worst = replace(worst, margin=max(worst.margin, 0.0)) if exact.holds else worst
    how = (
        _explain_no_proof(ask)
        if family.is_rational
        else "with a dead time nothing is proved over a box"
    )
    if status == "unknown":
        how = f"at the worst point of the search: {exact.verdict}"
    return parts_of(statement, status, worst, box, unit, how, at_worst=exact)


def margin_over(family: Family, box: ValueBox, claim: str) -> MarginFunction:
    """The margin of a claim as a function of a point of the box; numerical, compiled once."""
    if claim == "stable":
        ask = Conditions.over(box, family.symbols)
        return pole_margin(ask.poly(family.characteristic()), ask.symbols)
    return _margin(family, family.impedance(), box, claim)


def _margin(
    family: Family, z: sp.Matrix, box: ValueBox, claim: str, hidden: Sequence[sp.Poly] = ()
) -> MarginFunction:
    ask, poles = Conditions.over(box, family.symbols), [*hidden]
    if family.is_rational:
        poles += [ask.poly(sp.fraction(sp.cancel(e))[1]) for e in z]
    stable = claim == "absolutely stable"
    return port_margin(family, z, stable=stable, poles=poles, box=box)


def _is_proved(ask: Conditions, z: sp.Matrix, claim: str) -> bool:
    if z.shape == (1, 1):
        return one_port_is_passive(ask, z[0, 0])
    return (two_port_is_stable if claim == "absolutely stable" else two_port_is_passive)(ask, z)


def hides_no_growth(ask: Conditions, family: Family, z: sp.Matrix) -> bool:
    """Whether it is shown that all modes which the free ports do not show decay."""
    hidden = modes_inside(ask, family, z)
    return hidden is not None and ask.is_hurwitz(hidden)


def modes_inside(ask: Conditions, family: Family, z: sp.Matrix) -> sp.Poly | None:
    """Polynomial of all modes that the free ports do not show; None where Z is singular.

    An impedance describes the ports from rest. A mode that a zero cancels in it may grow by itself.
    The ports show the poles of their positions for their forces, a free mass included.
    """
    if sp.cancel(z.det()) == 0:
        return None
    moved = (z.inv() / S).applyfunc(sp.cancel)
    minors = [*moved, moved.det()]
    shown = reduce(sp.lcm, (ask.poly(sp.fraction(sp.cancel(one))[1]) for one in minors))
    whole = sp.fraction(sp.cancel(family.characteristic()))[0]
    return ask.poly(sp.fraction(sp.cancel(whole / shown.as_expr()))[0])


def _proof(made: Parts, certificates: Callable[[], tuple[Certificate, ...]]) -> Parts:
    """A proof, if the checker accepts its certificates; else the exact result as evidence."""
    try:
        accepted = certificates()
    except ModelError:
        how = f"{made['how']}; a certificate would ask for more work than its checker does"
        return {**made, "status": "evidence", "proved_margin": float("nan"), "how": how}
    how = f"{made['how']}; {len(accepted)} certificate{'s' * (len(accepted) > 1)}"
    return {**made, "how": how, "certificates": accepted}


def _bound(ask: Conditions, z: sp.Matrix, margin: float) -> Fraction:
    """Damping that Z may lose at every port while it is still proved to be passive, N s/m."""
    if not 0 < margin < np.inf:
        return Fraction(0)
    show = one_port_is_passive if z.shape == (1, 1) else two_port_is_passive
    entries = z[0, 0] if z.shape == (1, 1) else z
    for share in _SHARES:
        excess = Fraction(margin * share).limit_denominator(10**6)
        if 0 < excess <= margin and show(ask, entries, margin=excess):
            return excess
    return Fraction(0)


def _settle(alone: Diagram, box: ValueBox, point: np.ndarray, claim: str) -> Claim:
    """The claim at a single point of the box, by the exact tests."""
    there = drop_absent_effects(alone.with_values(box.named(point)))
    try:
        claims = linear_claims(there, ports(there))
    except ModelError as problem:  # dead times of a form that the tests at a point do not take
        return Claim(f"{alone.name}: {claim}", Unknown(str(problem)))
    return claims[-1 if claim == "absolutely stable" else 0].claim


def _point_by_point(
    alone: Diagram, box: ValueBox, claim: str, points: int, seed: int, statement: str
) -> Parts:
    """Judge a claim at single points, for values that are not symbols in the linear forms."""

    def one(diagram: Diagram) -> Claim:
        there = drop_absent_effects(diagram)
        return linear_claims(there, ports(there))[-1 if claim == "absolutely stable" else 0].claim

    made = judge_at_points(alone, box, one, points, seed)
    how = "its values are not in the linear forms as such: every point is decided by itself"
    refuted = made["status"] == "refuted"
    claim_there = one(alone.with_values(made["worst"]))
    return {
        **made,
        "statement": statement,
        "unit": CLAIMS[claim],
        "how": str(claim_there.verdict) if refuted else how,
        "at_worst": claim_there,
    }


def _describe_effort(ask: Conditions, what: str) -> str:
    return (
        f"{what}: {ask.effort.polynomials} shown by Bernstein coefficients on "
        f"{ask.effort.cells} parts of the box, in exact arithmetic"
    )


def _explain_no_proof(ask: Conditions) -> str:
    return (
        f"no proof over the whole box: not shown on {ask.effort.cells} parts of it, or poles on "
        "the axis that no condition covers, or modes inside that no port shows"
    )
