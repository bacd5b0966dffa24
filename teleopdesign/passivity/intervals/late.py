"""Stability over intervals of dead times and other values: no pole crosses the axis.

    f(s) = sum_b p_b(s, v) e^(-s tau_b),   tau_b = sum_k b_k T_k,   tau_0 = 0

All zeros of f have Re s < 0, for all values v of a box and all dead times T_k from 0 to their
largest values, if

1. at one v, with all T_k = 0, f is Hurwitz;
2. abs(p_0(jw, v)) > sum over b > 0 of abs(p_b(jw, v)) for w >= W, its limit included;
3. f(jw) is not 0 for 0 <= w <= W, for all v and T_k.

The reason: for Re s >= 0 no abs(e^(-s tau)) is larger than 1, so by 2 in its limit the zeros there
are bounded. They move continuously with v and T, and by 2 and 3 no zero is ever on the axis. Zero
exclusion and continuity: Stepan, Retarded Dynamical Systems (1989); Gu, Kharitonov, Chen (2003),
section 1.3.

Condition 1 is decided exactly. Conditions 2 and 3 are shown for each part of the box (`late_cells`)
in floats with all rounding bounded. f is the determinant of all states, so it has all modes.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp

from ...controllers import exact_decimal
from ...derive.effort import try_within_effort
from ...derive.polynomials import is_hurwitz
from ...frequency.late_zeros import exact_terms, terms_of
from ...realise.lti import S
from .box import ValueBox
from .interval_claim import Parts, Status, parts_of
from .late_cells import LateSum, is_zero_free
from .late_roots import holds_root, rightmost_root, slowest_decay
from .worst import search_worst

_STATEMENT = "every pole has a negative real part"


def judge_late(
    p: Any, times: Mapping[sp.Symbol, sp.Expr], box: ValueBox, points: int, seed: int
) -> Parts:
    """Judge whether all zeros of f have a negative real part, over a box.

    p: f, a polynomial in s, the values of the box and symbols of e^(-s T);  times: of these T
    points, seed: of `search_worst`;  returns: fields of an `IntervalClaim`
    """
    symbols = p.ring.symbols[1 : 1 + len(box.names)]

    def at(point: np.ndarray) -> dict[sp.Symbol, Fraction]:
        numbers = (exact_decimal(float(x)) for x in point)
        return {x: Fraction(int(v.p), int(v.q)) for x, v in zip(symbols, numbers, strict=True)}

    def margin(point: np.ndarray) -> float:
        return slowest_decay(terms_of(p, times, values=at(point)))

    worst = search_worst(margin, box, points=points, seed=seed)
    if worst.margin <= 0:
        there = at(worst.point)
        root = rightmost_root(terms_of(p, times, values=there))
        radius = holds_root(exact_terms(p, times, there), root) if root.real > 0 else None
        if radius is not None and root.real > radius:
            how = f"a pole at {root:.4g} 1/s, within {radius:.1g} 1/s: by Rouche's theorem"
            return parts_of(_STATEMENT, "refuted", worst, box, "1/s", how)
        how = (
            "at the worst point of the search a pole is beyond the axis, or too near to it, and "
            "not shown"
        )
        return parts_of(_STATEMENT, "unknown", worst, box, "1/s", how)
    cells = None
    if _starts_stable(p, times, box):
        cells = try_within_effort(lambda: is_zero_free(LateSum.of(p, times, box)), None)
    status: Status = "evidence" if cells is None else "proved"
    how = "no proof over the whole box: not stable from no dead time on, or not shown part by part"
    if cells is not None:
        how = (
            f"no pole is on the axis for any dead time from 0 on, on {cells} parts of the box: in "
            "floats with all rounding bounded, without a certificate"
        )
    bound = {"proved_margin": 0.0} if cells is not None else {}
    return parts_of(_STATEMENT, status, worst, box, "1/s", how, **bound)


def _starts_stable(p: Any, times: Mapping[sp.Symbol, sp.Expr], box: ValueBox) -> bool:
    """Whether f without dead times is Hurwitz in the middle of the box."""
    middle = {x: sp.QQ(1) for x in times}
    ends = zip(p.ring.symbols[1:], box.exact, strict=False)
    middle |= {x: sp.QQ(*((a + b) / 2).as_integer_ratio()) for x, (a, b) in ends}
    pairs = [
        (g, middle.get(x, sp.QQ(0)))
        for g, x in zip(p.ring.gens[1:], p.ring.symbols[1:], strict=True)
    ]
    return is_hurwitz(sp.Poly(p.evaluate(pairs).as_expr(), S, domain="QQ"))
