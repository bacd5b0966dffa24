"""Modes of a diagram that grow by themselves, those that its ports do not show included.

An impedance is what ports do from rest. A pole of a controller that a zero of the next one cancels
is not in it: from rest it never moves, but the least disturbance grows without end, and may come
out at a port. So what is passive by its impedance is so of the device only where the determinant of
all its equations, denominators multiplied out and nothing cancelled, has no root with Re s > 0.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce

import numpy as np
import sympy as sp
from sympy.polys.matrices import DomainMatrix

from ...controllers import (
    Controller,
    Stage,
    as_written,
    in_exact_numbers,
    parameter_symbol,
    resolvent,
)
from ...derive import symbol_values
from ...derive.elimination import rows
from ...diagrams import Control, Diagram
from ...realise.lti import LinearBlocks, S, linear_blocks
from ...realise.tips import with_tips
from ..checker.polynomials import is_free_of_growth, polynomial
from .impedance import exact
from .polynomials import fraction


def growth_within(diagram: Diagram) -> float | None:
    """Rate (1/s) of the fastest mode that grows by itself with free ports; None where none does.

    diagram: with values, linear and without dead times (of others nothing is known here: None)
    """
    whole = _characteristic(with_tips(diagram))
    if whole is None or _is_free_of_growth(whole):
        return None
    return float(np.roots([float(c) for c in whole.sqf_part().monic().all_coeffs()]).real.max())


def hides_growth(part: Control, linear: LinearBlocks) -> bool:
    """Whether a mode grows within a controller that its linear form does not show."""
    return not _is_free_of_growth(cancelled_poles(part, linear))


def _is_free_of_growth(p: sp.Poly) -> bool:
    return is_free_of_growth(polynomial(fraction(c) for c in p.all_coeffs()[::-1]))


def _characteristic(diagram: Diagram) -> sp.Poly | None:
    """det of all equations, with what stages cancel; None with dead times."""
    linear = linear_blocks(diagram)
    values = symbol_values(linear)
    equations = [{n: e.xreplace(values) for n, e in row.items()} for row in rows(diagram)]
    if linear.dead_times or any(e.has(sp.exp) for row in equations for e in row.values()):
        return None
    unknown = [n for n in diagram.signals if n not in diagram.outside]
    if len(equations) != len(unknown):
        return None
    ring, matrix = sp.QQ[S], []
    for row in equations:
        forms = [sp.fraction(sp.cancel(in_exact_numbers(row.get(n, sp.S(0))))) for n in unknown]
        below = reduce(sp.lcm, [sp.Poly(q, S, domain="QQ") for _, q in forms])
        matrix.append(
            [ring.from_sympy((sp.Poly(p, S, domain="QQ") * below.quo(sp.Poly(q, S, domain="QQ")))
                             .as_expr()) for p, q in forms]
        )  # fmt: skip
    size = len(unknown)
    determinant = DomainMatrix(matrix, (size, size), ring).to_field().det()
    whole = sp.Poly(ring.to_sympy(ring.convert_from(determinant, ring.get_field())), S, domain="QQ")
    for part in diagram.controls:
        whole *= cancelled_poles(part, linear)
    return whole if not whole.is_zero else None


def cancelled_poles(part: Control, linear: LinearBlocks) -> sp.Poly:
    """What the denominators of a controller's stages have more than its linear forms, in S."""
    assert isinstance(part.controller, Controller)
    forms = (linear.blocks[part.name], linear.along.get(part.name, sp.S(0)))
    whole = sp.Poly(1, S, domain="QQ")
    for stage in part.controller.stages:
        whole *= stage_denominator(stage, part.name)
    return whole.quo(_common_denominator(forms))


def stage_denominator(stage: Stage, prefix: str) -> sp.Poly:
    """Denominator of one stage: det(s I - A), or as it was given."""
    values = stage.values
    if "denominator_0" in values:
        order = max(int(n.rpartition("_")[2]) for n in values if n.startswith("denominator_"))
        return sp.Poly([exact(values[f"denominator_{k}"]) for k in range(order, -1, -1)], S)
    if "a_0_0" in values:
        order = int(np.sqrt(sum(n.startswith("a_") for n in values)))
        a = [[fraction(exact(values[f"a_{i}_{j}"])) for j in range(order)] for i in range(order)]
        below, _ = resolvent(a, a[0], a[0])
        return sp.Poly([sp.Rational(c) for c in below], S, domain="QQ")
    alone = Controller((stage,))
    numbers = {parameter_symbol(prefix, n): as_written(x) for n, x in alone.names().items()}
    # from the input, and from the motion that it acts along: in their sum a mode could cancel
    forms = alone.linear_parts(prefix, S, sp.S(0)) or ()
    return _common_denominator(in_exact_numbers(sp.sympify(x).subs(numbers)) for x in forms)


def _common_denominator(forms: Iterable[sp.Expr]) -> sp.Poly:
    below = [sp.Poly(sp.fraction(sp.cancel(form))[1], S, domain="QQ") for form in forms]
    return reduce(sp.lcm, below, sp.Poly(1, S, domain="QQ"))
