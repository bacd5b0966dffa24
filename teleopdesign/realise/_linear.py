"""Linear equations with symbolic coefficients, solved by elimination."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp

from ..errors import ModelError


def solve_linear(
    rows: list[sp.Expr], unknown: Sequence[sp.Symbol], name: str
) -> dict[sp.Symbol, sp.Expr]:
    """Solve rows = 0, linear in the unknowns, one after the other; simplest pivots first."""
    rows, left = list(rows), set(unknown)
    found: dict[sp.Symbol, sp.Expr] = {}
    while left:
        choice = None
        for i, row in enumerate(rows):
            for x in sorted(left & row.free_symbols, key=str):
                factor = sp.diff(row, x)
                if left & factor.free_symbols:
                    raise ModelError(f"{name}: {x} enters an equation other than linearly")
                cost = (not factor.is_Number, len(left & row.free_symbols), factor.count_ops())
                if factor != 0 and (choice is None or cost < choice[0]):
                    choice = (cost, i, x, factor)
        if choice is None:
            some = ", ".join(sorted(s.name for s in left))
            raise ModelError(f"{name}: the wiring does not determine {some}")
        _, i, x, factor = choice
        row = rows.pop(i)
        value = -row.xreplace({x: sp.S(0)}) / factor
        rows = [r.xreplace({x: value}) if r.has(x) else r for r in rows]
        # like terms must meet, or a pivot that is zero would not be seen
        rows = [_gathered(r, left - {x}) for r in rows]
        found = {s: e.xreplace({x: value}) for s, e in found.items()} | {x: value}
        left.remove(x)
    return found


def _gathered(row: sp.Expr, unknown: set[sp.Symbol]) -> sp.Expr:
    here = sorted(unknown & row.free_symbols, key=str)
    factors = {x: sp.diff(row, x) for x in here}
    factors = {x: sp.expand(f, power_exp=False) for x, f in factors.items()}
    rest = row.xreplace(dict.fromkeys(here, sp.S(0)))
    return sp.Add(rest, *(f * x for x, f in factors.items()))
