"""Growing modes of a diagram, hidden modes included.

An impedance describes the ports from rest. A pole of a controller that a zero of the next
controller cancels is not in the impedance. From rest this mode never moves, but the smallest
disturbance of it grows without end, and may appear at a port. So a device with a passive impedance
is passive only where no mode of all its equations grows: none with Re s > 0, and none on the axis
that another mode of the same s drives.

Ranks decide the second condition. P(s) w = 0 are all equations (`in_full`), r(s) is a factor of det
P with roots on the axis, m is the multiplicity of r in det P, and n is the nullity of P at the
roots of r. The elementary divisors of P there are n powers of r, and their exponents sum up to m.
The ports show k of these divisors, with exponents that sum up to m - h. If n = k + h, each mode
that no port shows is a separate divisor of exponent 1, so its size stays the same. Otherwise such a
mode may grow as a power of time. The impedance covers all modes that the ports show, a free mass
included.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import reduce
from typing import Any

import numpy as np
import sympy as sp
from sympy.polys.matrices import DomainMatrix

from ...controllers import Controller, Stage, controller
from ...derive import symbol_values
from ...derive.elimination import rows
from ...derive.polynomials import fraction, is_hurwitz
from ...diagrams import Block, Control, Diagram, Moving, with_shared_states
from ...realise.lti import LinearBlocks, S, linear_blocks
from ...realise.tips import with_tips
from ..checker.polynomials import is_free_of_growth, polynomial
from ..ports import Port, arrange_coefficients, ports
from .impedance import exact, impedance
from .in_full import (
    Equation,
    denominators,
    effect_modes,
    equations_in_full,
    equations_of,
    polynomial_in_s,
    ratio,
    stage_denominator,
    stages_of,
    unshown_by_effects,
)

#: the reason of an unknown claim about a system for which `has_hidden_growth` holds
HIDDEN_GROWTH = (
    "from rest its impedance is that of a passive port, but a mode that no port shows grows"
)
_ONE = sp.Poly(1, S, domain="QQ")


def growth_within(diagram: Diagram) -> float | None:
    """Rate (1/s) of the fastest mode that grows by itself with free ports; None: no mode grows.

    diagram: with values, linear
    returns: 0 where a mode grows as a power of time; NaN where the answer is not known: with dead
        times, where the equations do not determine all signals, or where a force does not show a
        state of its effect that does not decay
    raises ModelError: no force from outside drives a body
    """
    at, diagram = ports(diagram), with_shared_states(with_tips(_drop_zero_delays(diagram)))
    linear = linear_blocks(diagram)
    values = symbol_values(linear)
    forms = [{n: e.xreplace(values) for n, e in row.items()} for row in rows(diagram)]
    if linear.dead_times or any(e.has(sp.exp) for row in forms for e in row.values()):
        return math.nan
    if not is_hurwitz(unshown_by_effects(diagram)):
        return math.nan
    whole, shown = _whole_determinant(diagram, forms, at)
    if whole.is_zero:
        return math.nan
    if not _is_free_of_growth(whole):
        return float(np.roots([float(c) for c in whole.sqf_part().monic().all_coeffs()]).real.max())
    return 0.0 if _drives_itself(whole, shown, equations_in_full(diagram)) else None


def hides_growth(part: Control, linear: LinearBlocks) -> bool:
    """Whether a controller has a growing mode that its linear form does not show."""
    forms = [linear.blocks[part.name], linear.along.get(part.name, sp.S(0))]
    whole = reduce(sp.Poly.mul, map(stage_denominator, stages_of(part)), _ONE)
    if not _is_free_of_growth(cancelled_poles(part, linear)):
        return True
    known = {part.input, part.motion}
    equations = [{n: p for n, p in row.items() if n not in known} for row in equations_of(part)]
    return _drives_itself(whole, sp.Matrix([forms]), equations)


def body_hides_growth(part: Moving, linear: LinearBlocks) -> bool:
    """Whether an effect of a body cancels a pole of another effect that does not decay."""
    product = polynomial_in_s(effect_modes(part.body)[0])
    hidden = product.quo(ratio(linear.blocks[part.name])[1])
    return hidden.degree() > 0 and not is_hurwitz(hidden)


def has_hidden_growth(system: Any) -> bool:
    """Whether a system of python-control has a growing mode that its port does not show.

    From rest such a mode stays at rest, so the impedance does not contain it. The smallest
    disturbance of it grows. False for any other kind of system.
    """
    if hasattr(system, "num"):
        states = [[sp.Add(*(exact(c) * S**k for k, c in enumerate(system.den[0][0][::-1])))]]
    elif hasattr(system, "A"):
        a = [[exact(x) for x in row] for row in system.A]
        states = [[S * int(i == j) - x for j, x in enumerate(row)] for i, row in enumerate(a)]
    else:
        return False
    equations = [{str(j): polynomial_in_s(x) for j, x in enumerate(row)} for row in states]
    whole = polynomial_in_s(sp.Matrix(states).det(method="berkowitz")) if states else _ONE
    shown = impedance(system).expression
    hidden = whole.quo(ratio(shown)[1])
    return not _is_free_of_growth(hidden) or _drives_itself(whole, sp.Matrix([shown]), equations)


def cancelled_poles(part: Control, linear: LinearBlocks) -> sp.Poly:
    """Poles of the states of a controller's laws that its linear forms lack: a polynomial in S."""
    forms = (linear.blocks[part.name], linear.along.get(part.name, sp.S(0)))
    whole = reduce(sp.Poly.mul, map(stage_denominator, stages_of(part)), _ONE)
    return whole.quo(reduce(sp.lcm, (ratio(form)[1] for form in forms), _ONE))


def _is_free_of_growth(p: sp.Poly) -> bool:
    return is_free_of_growth(polynomial(fraction(c) for c in p.all_coeffs()[::-1]))


def _whole_determinant(
    diagram: Diagram, forms: list[dict[str, sp.Expr]], at: Sequence[Port]
) -> tuple[sp.Poly, sp.Matrix]:
    """Determinant of all equations, cancelled modes included; and port motions over port forces.

    The determinant is 0 where the equations do not determine all signals.
    """
    unknown = [n for n in diagram.signals if n not in diagram.outside]
    forces = [port.force for port in at]
    if len(forms) != len(unknown):
        return sp.Poly(0, S, domain="QQ"), sp.zeros(0)
    matrix = arrange_coefficients(forms, unknown)
    above, below = ratio(matrix.domain.to_sympy(matrix.det()))
    if above.is_zero:
        return above, sp.zeros(0)
    whole, rest = (above * denominators(diagram)).div(below)
    assert rest.is_zero
    answers = matrix.lu_solve(arrange_coefficients(forms, forces)).to_Matrix()
    weights = sp.Matrix([[exact(port.weights.get(n, 0)) for n in unknown] for port in at])
    return whole, weights * answers


def _drives_itself(whole: sp.Poly, shown: sp.Matrix, equations: list[Equation]) -> bool:
    """Whether a mode on the axis that the forms do not show may grow as a power of time."""
    mirror = whole.compose(sp.Poly(-S, S, domain="QQ"))
    for factor, _ in sp.gcd(whole, mirror).factor_list()[1]:
        order, divisors = _count_shown(shown, factor)
        hidden = _multiplicity(whole, factor) - order
        if hidden and _nullity(equations, factor) != divisors + hidden:
            return True
    return False


def _count_shown(forms: sp.Matrix, factor: sp.Poly) -> tuple[int, int]:
    """Elementary divisors that the forms show where `factor` is zero (Smith, McMillan).

    Elimination with the entry whose pole is of the highest order as pivot; no entry of the rest
    then has a pole of a higher order.

    returns: sum of their exponents, and their number
    """
    field = sp.QQ.frac_field(S)
    prime = field.field.ring.from_expr(factor.as_expr())
    left = [[field.from_sympy(sp.sympify(e)) for e in row] for row in forms.tolist()]
    orders = []
    while left and left[0]:
        order, i, j = max(
            (_order(e, prime), i, j) for i, row in enumerate(left) for j, e in enumerate(row)
        )
        if order <= 0:
            break
        orders.append(order)
        pivot = left.pop(i)
        left = [
            [e - row[j] * pivot[k] / pivot[j] for k, e in enumerate(row) if k != j] for row in left
        ]
    return sum(orders), len(orders)


def _order(entry: Any, prime: Any) -> int:
    """Order of the pole of a rational function where an irreducible polynomial is zero."""
    order, below = 0, entry.denom
    while not below.rem(prime):
        below, order = below.quo(prime), order + 1
    return order


def _multiplicity(p: sp.Poly, factor: sp.Poly) -> int:
    times = 0
    while p.degree() > 0:
        p, rest = p.div(factor)
        if not rest.is_zero:
            break
        times += 1
    return times


def _nullity(equations: list[Equation], factor: sp.Poly) -> int:
    """Nullity of the equations where an irreducible factor is zero, by exact elimination.

    The elimination computes with polynomials modulo the factor, which form a field.
    """
    names = list(dict.fromkeys(n for row in equations for n in row))
    left = [{n: p.rem(factor) for n, p in row.items()} for row in equations]
    left = [{n: p for n, p in row.items() if not p.is_zero} for row in left]
    rank = 0
    while left := [row for row in left if row]:
        pivot = min(left, key=len)
        name = next(iter(pivot))
        inverse = pivot[name].invert(factor)
        rank += 1
        for row in left:
            if row is pivot or name not in row:
                continue
            share = row[name] * inverse
            for n, p in pivot.items():
                changed = (row.get(n, _ONE * 0) - share * p).rem(factor)
                if changed.is_zero:
                    row.pop(n, None)
                else:
                    row[n] = changed
        left = [row for row in left if row is not pivot]
    return len(names) - rank


def controllers_grow(diagram: Diagram) -> bool:
    """Whether control laws of a diagram with dead times grow while all bodies stand still.

    Such a mode is a pole of the impedance in the right half plane, or no port shows it. The answer
    is False also where a dead time lies within a loop of laws: then nothing is known.
    """
    diagram = with_shared_states(with_tips(diagram))
    made = [_standing_still(diagram, factor) for factor in (1.0, 2.0, 0.0)]
    wholes = [whole for whole, _ in made]
    if any(whole.is_zero or whole != wholes[0] for whole in wholes):
        return False
    return any(
        not _is_free_of_growth(whole) or _drives_itself(whole, sp.zeros(0), equations)
        for whole, equations in made
    )


def _drop_zero_delays(diagram: Diagram) -> Diagram:
    """The diagram with each dead time of 0 replaced by a gain of 1."""
    return _with_gains(diagram, 1.0, lambda stage: stage.value_of("dead_time") == 0)


def _with_gains(
    diagram: Diagram, factor: float, chosen: Callable[[Stage], bool] = lambda stage: True
) -> Diagram:
    """The diagram with the chosen dead times replaced by gains of this factor."""
    law = controller("gain", {"gain": factor}).stages[0]

    def without_delay(part: Block) -> Block:
        if not isinstance(part, Control) or not isinstance(part.controller, Controller):
            return part
        stages = [law if g.law.dead_time and chosen(g) else g for g in stages_of(part)]
        return replace(part, controller=Controller(tuple(stages)))

    return replace(diagram, blocks=tuple(without_delay(part) for part in diagram.blocks))


def _standing_still(diagram: Diagram, factor: float) -> tuple[sp.Poly, list[Equation]]:
    """Determinant of the equations while all bodies stand still, and these equations.

    The equations of bodies are left out.
    factor: gain that replaces each dead time
    """
    still = {b.motion for b in diagram.blocks if isinstance(b, Moving)}
    equations = equations_in_full(_with_gains(diagram, factor), standing=True)
    equations = [{n: p for n, p in row.items() if n not in still} for row in equations]
    names = list(dict.fromkeys(n for row in equations for n in row))
    if len(names) != len(equations):
        return _ONE * 0, equations
    ring = sp.QQ[S]
    entries = [
        [ring.from_sympy(row[n].as_expr()) if n in row else ring.zero for n in names]
        for row in equations
    ]
    shape = (len(names), len(names))
    matrix = DomainMatrix(entries, shape, ring).to_field()
    above, below = ratio(matrix.domain.to_sympy(matrix.det()))
    assert below.degree() <= 0
    return above.monic() if not above.is_zero else above, equations
