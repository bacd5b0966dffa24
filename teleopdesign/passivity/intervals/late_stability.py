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
with intervals of floats that are rounded outward. f contains all modes, also those that no signal
shows (`Family`).
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import sympy as sp

from ...controllers import Controller, Stage, controller, exact_decimal
from ...derive.polynomials import is_hurwitz
from ...diagrams import Control, Diagram
from ...realise.lti import S
from .box import ValueBox
from .conditions import Conditions
from .family import family_of
from .interval_claim import Parts, Status, parts_of
from .late_cells import is_zero_free
from .late_roots import holds_root, rightmost_root, slowest_decay
from .late_terms import LateTerms
from .worst import search_worst

_STATEMENT = "every pole has a negative real part"


def judge_late_stability(middle: Diagram, box: ValueBox, points: int, seed: int) -> Parts | None:
    """Judge whether all poles of a diagram with delay blocks have a negative real part, over a box.

    middle: the diagram with values in the middle of the box;  points, seed: of `search_worst`
    returns: fields of an `IntervalClaim`; None where the diagram has no delay block, has another
        dead time, or has values that are not in its linear forms
    """
    made = _late_terms(middle, box)
    if made is None:
        return None
    terms, start = made

    def margin(point: np.ndarray) -> float:
        return slowest_decay(terms.at(point))

    worst = search_worst(margin, box, points=points, seed=seed)
    if worst.margin <= 0:
        root = rightmost_root(terms.at(worst.point))
        radius = holds_root(terms.exactly_at(worst.point), root) if root.real > 0 else None
        if radius is not None and root.real > radius:
            how = f"a pole at {root:.4g} 1/s, within {radius:.1g} 1/s: by Rouche's theorem"
            return parts_of(_STATEMENT, "refuted", worst, box, "1/s", how)
        how = (
            "at the worst point of the search a pole is beyond the axis, or too near to it, and "
            "not shown"
        )
        return parts_of(_STATEMENT, "unknown", worst, box, "1/s", how)
    cells = is_zero_free(terms) if is_hurwitz(start) else None
    status: Status = "evidence" if cells is None else "proved"
    how = "no proof over the whole box: not stable from no dead time on, or not shown part by part"
    if cells is not None:
        how = (
            f"no pole is on the axis for any dead time from 0 on, on {cells} parts of the box: by "
            "intervals of floats that are rounded outward, without a certificate"
        )
    bound = {"proved_margin": 0.0} if cells is not None else {}
    return parts_of(_STATEMENT, status, worst, box, "1/s", how, **bound)


def _late_terms(middle: Diagram, box: ValueBox) -> tuple[LateTerms, sp.Poly] | None:
    """f over the box, and f at the middle of the box without dead times; None: no such form."""
    plain, times = _with_marks(middle)
    if not times:
        return None
    values = box.select(tuple(n for n in box.names if n not in times.values()))
    # a mark stands for e^(-s T): its interval only gives it a name
    marks = tuple(times)
    named = ValueBox(
        (*values.names, *marks),
        (*values.low, *[0.5] * len(marks)),
        (*values.high, *[1.0] * len(marks)),
    )
    family = family_of(plain, named)
    if family is None or not family.is_rational:
        return None
    ask = Conditions.over(named, family.symbols)
    polynomial = ask.poly(family.characteristic())
    ends = dict(zip(box.names, box.exact, strict=True))
    late = [ends.get(n, (_exact(middle.values[n]),) * 2) for n in times.values()]
    centre = {
        family.symbols[n]: sp.Rational(str((a + b) / 2))
        for n, (a, b) in zip(values.names, values.exact, strict=True)
    }
    at_once = {family.symbols[mark]: sp.S(1) for mark in marks}
    start = sp.Poly(polynomial.as_expr().subs(centre | at_once), S, domain="QQ")
    monomials, coefficients = zip(*polynomial.terms(), strict=True)
    terms = LateTerms(
        tuple(Fraction(int(c.p), int(c.q)) for c in coefficients),
        np.array(monomials),
        values.exact,
        tuple(late),
        tuple(box.names.index(n) for n in values.names),
        tuple(box.names.index(n) if n in box.names else -1 for n in times.values()),
    )
    return terms, start


def _exact(value: float) -> Fraction:
    return Fraction(str(exact_decimal(value)))


def _with_marks(diagram: Diagram) -> tuple[Diagram, dict[str, str]]:
    """The diagram with each delay replaced by a gain, and: name of the gain -> its dead time."""
    gain = controller("gain", {"gain": 0.75}).stages[0]
    times: dict[str, str] = {}

    def marked(part: Control, stage: Stage) -> Stage:
        if not stage.law.dead_time:
            return stage
        name = f"{part.name}.{stage.name}"
        times[f"{name}.gain"] = f"{name}.{stage.law.dead_time}"
        return replace(gain, name=stage.name)

    blocks = []
    for part in diagram.blocks:
        if isinstance(part, Control) and isinstance(part.controller, Controller):
            stages = tuple(marked(part, stage) for stage in part.controller.stages)
            part = replace(part, controller=Controller(stages))
        blocks.append(part)
    return replace(diagram, blocks=tuple(blocks)), times
