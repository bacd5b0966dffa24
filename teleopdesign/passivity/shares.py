"""Shares of one signal in other signals of a diagram, through junctions alone."""

from __future__ import annotations

from collections.abc import Mapping
from graphlib import CycleError, TopologicalSorter

import sympy as sp
from sympy.polys.matrices import DomainMatrix
from sympy.polys.matrices.exceptions import DMNonInvertibleMatrixError

from ..base.errors import ModelError
from ..diagrams import Diagram, Moving, Part
from .linear.impedance import exact

Shares = Mapping[str, sp.Expr]


def shares_of(diagram: Diagram, signal: str) -> Shares:
    """Shares of `signal` in the other signals, through junctions; loops of sums are solved.

    returns: name of a signal -> its share, not 0. A share is an expression of positions where a
        lever arm is on the way
    raises ModelError: a loop of sums without a solution
    """
    sums = {
        j.output: {n: _weight(w) for n, w in j.terms.items()}
        for j in diagram.junctions
        if j.output != signal
    }
    try:
        order = TopologicalSorter({n: terms.keys() for n, terms in sums.items()}).static_order()
        shares = {signal: sp.S(1)}
        for name in order:
            if name in sums:
                shares[name] = total_share(sums[name], shares)
    except CycleError:
        shares = _solve_sums(diagram, sums, signal)
    return {name: share for name, share in shares.items() if share != 0}


def total_share(terms: Mapping[str, sp.Expr | float], shares: Shares) -> sp.Expr:
    """Share of one signal in a sum of weight * signal.

    terms: signal -> weight;  shares: of the one signal, from `shares_of`
    """
    return sp.expand(sp.Add(*(_weight(w) * shares.get(n, sp.S(0)) for n, w in terms.items())))


def drives_alone(diagram: Diagram, signal: str, body: Moving) -> bool:
    """Whether a force acts unchanged on that body, and on nothing else.

    An actuator of the body is not considered; the caller has to exclude one.
    """
    shares = shares_of(diagram, signal)
    forces = {name: sp.S(0) for name in (body.command, *body.loads)}
    forces |= {name: _weight(w) for name, w in body.loads.items()}
    forces[body.command] += 1
    return total_share(forces, shares) == 1 and not any(
        part is not body and _takes(part, shares) for part in (*diagram.blocks, *diagram.kinematics)
    )


def _takes(part: Part, shares: Shares) -> bool:
    return any(name in shares for name in part.inputs)


def _weight(weight: sp.Expr | float) -> sp.Expr:
    expression = sp.sympify(weight, strict=True)
    return expression if expression.free_symbols else exact(weight)


def _solve_sums(
    diagram: Diagram, sums: Mapping[str, Mapping[str, sp.Expr]], signal: str
) -> dict[str, sp.Expr]:
    names = list(sums)
    system = sp.Matrix(
        [[int(row == n) - sums[row].get(n, sp.S(0)) for n in names] for row in names]
    )
    right = sp.Matrix([sums[row].get(signal, sp.S(0)) for row in names])
    whole = DomainMatrix.from_Matrix(system.row_join(right)).to_field()
    size = len(names)
    try:
        answers = whole[:, :size].lu_solve(whole[:, size:]).to_Matrix()
    except DMNonInvertibleMatrixError:
        raise ModelError(f"{diagram.name}: a loop of sums has no solution") from None
    return {signal: sp.S(1), **dict(zip(names, answers, strict=True))}
