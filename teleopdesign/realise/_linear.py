"""Linear equations with symbolic coefficients, solved by elimination.

Where unknowns are coupled by symbolic coefficients (accelerations through a mass matrix),
expressions of the solution would become too large: its steps get names instead.
"""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp

from ..base.errors import ModelError

#: symbol -> expression, in an order in which each can be computed from those before
Steps = dict[sp.Symbol, sp.Expr]


def solve_linear(
    rows: list[sp.Expr], unknown: Sequence[sp.Symbol], name: str
) -> tuple[dict[sp.Symbol, sp.Expr], Steps]:
    """Solve rows = 0, linear in the unknowns, one after the other; simplest pivots first.

    returns: the solution, and the named steps that it depends on
    raises ModelError: an unknown is not determined, or an equation is not linear in it
    """
    rows, left = list(rows), set(unknown)
    solution: dict[sp.Symbol, sp.Expr] = {}
    while left:
        choice = None
        for i, row in enumerate(rows):
            for x in sorted(left & row.free_symbols, key=str):
                factor = sp.diff(row, x)
                if left & factor.free_symbols:
                    continue  # its factor may become known with other unknowns
                cost = (not factor.is_Number, len(left & row.free_symbols), factor.count_ops())
                if factor != 0 and (choice is None or cost < choice[0]):
                    choice = (cost, i, x, factor)
        if choice is None:
            for row in rows:  # name an unknown that does not enter linearly, if there is one
                for x in sorted(left & row.free_symbols, key=str):
                    _factor(row, x, left, name)
            raise _undetermined_error(left, name)
        (no_number, others, _), i, x, factor = choice
        if no_number and others > 1:
            values, steps = _solve_rest(rows, left, name)
            return {s: e.xreplace(values) for s, e in solution.items()} | values, steps
        row = rows.pop(i)
        value = -row.xreplace({x: sp.S(0)}) / factor
        rows = [r.xreplace({x: value}) if r.has(x) else r for r in rows]
        # like terms are collected: else a pivot that is zero would not be recognised
        rows = [_gather(r, left - {x}) for r in rows]
        solution = {s: e.xreplace({x: value}) for s, e in solution.items()} | {x: value}
        left.remove(x)
    return solution, {}


def _factor(row: sp.Expr, x: sp.Symbol, unknown: set[sp.Symbol], name: str) -> sp.Expr:
    factor = sp.diff(row, x)
    if unknown & factor.free_symbols:
        raise ModelError(f"{name}: {x} enters an equation other than linearly")
    return factor


def _undetermined_error(left: set[sp.Symbol], name: str) -> ModelError:
    some = ", ".join(sorted(s.name for s in left))
    return ModelError(f"{name}: the wiring does not determine {some}")


def _gather(row: sp.Expr, unknown: set[sp.Symbol]) -> sp.Expr:
    here = sorted(unknown & row.free_symbols, key=str)
    factors = {x: sp.diff(row, x) for x in here}
    if any(unknown & f.free_symbols for f in factors.values()):
        return row  # not linear in its unknowns yet
    factors = {x: sp.expand(f, power_exp=False) for x, f in factors.items()}
    rest = row.xreplace(dict.fromkeys(here, sp.S(0)))
    return sp.Add(rest, *(f * x for x, f in factors.items()))


class _Named:
    """Names of expressions: a call stores an expression and returns its symbol.

    bare: name -> value where all symbols of the expression are zero; a gain of zero shows so
    """

    def __init__(self) -> None:
        self.steps: Steps = {}
        self.bare: dict[sp.Symbol, sp.Expr] = {}

    def __call__(self, expression: sp.Expr) -> sp.Expr:
        if not expression.args or expression.is_number:
            return expression
        symbol = sp.Symbol(f"joined_{len(self.steps)}", real=True)
        self.steps[symbol] = expression
        self.bare[symbol] = self.at_zero(expression)
        return symbol

    def at_zero(self, expression: sp.Expr) -> sp.Expr:
        """Value of an expression where all its symbols are zero; divisors are 1."""
        powers = (p for p in expression.atoms(sp.Pow) if p.exp.is_negative)
        below = set[sp.Symbol]().union(*(p.base.free_symbols for p in powers))
        free = {s: sp.Integer(s in below) for s in expression.free_symbols}
        return expression.subs({s: self.bare.get(s, value) for s, value in free.items()})

    def is_there_at_zero(self, entry: sp.Expr) -> bool:
        """Whether a number or name is finite and not zero, where all symbols are zero."""
        value = entry if entry.is_Number else self.bare.get(entry, sp.S(0))
        return bool(value.is_finite and value != 0)


def _solve_rest(
    rows: list[sp.Expr], left: set[sp.Symbol], name: str
) -> tuple[dict[sp.Symbol, sp.Expr], Steps]:
    """Solution of the remaining equations by Gaussian elimination, with a name for every step."""
    named = _Named()
    values: dict[sp.Symbol, sp.Expr] = {}
    todo = sorted(left, key=str)
    while todo:
        group = _group(rows, todo[0], left)
        of_group = [r for r in rows if r.free_symbols & group]
        if len(of_group) < len(group):
            raise _undetermined_error(group, name)
        values |= _eliminate(of_group, sorted(group, key=str), named, name)
        todo = [x for x in todo if x not in group]
    return values, named.steps


def _group(rows: list[sp.Expr], first: sp.Symbol, left: set[sp.Symbol]) -> set[sp.Symbol]:
    """Unknowns that equations couple to the first one, directly or through others."""
    group, grown = {first}, True
    while grown:
        more = set().union(*(left & r.free_symbols for r in rows if r.free_symbols & group))
        grown = not more <= group
        group |= more
    return group


def _eliminate(
    rows: list[sp.Expr], unknown: list[sp.Symbol], named: _Named, name: str
) -> dict[sp.Symbol, sp.Expr]:
    zero, unknown = dict.fromkeys(unknown, sp.S(0)), list(unknown)
    a = [[named(_factor(r, x, set(unknown), name)) for x in unknown] for r in rows]
    b = [named(-r.xreplace(zero)) for r in rows]
    n = len(unknown)
    for i in range(n):
        at, column = _pivot(a, i, named)
        if at is None:
            raise _undetermined_error({unknown[i]}, name)
        a[i], a[at], b[i], b[at] = a[at], a[i], b[at], b[i]
        unknown[i], unknown[column] = unknown[column], unknown[i]
        for row in a:
            row[i], row[column] = row[column], row[i]
        inverse = named(1 / a[i][i])
        a[i] = [named(inverse * x) if j > i else x for j, x in enumerate(a[i])]
        b[i] = named(inverse * b[i])
        for r in range(i + 1, len(a)):
            if a[r][i] != 0:
                factor = a[r][i]
                a[r] = [named(x - factor * a[i][j]) if j > i else x for j, x in enumerate(a[r])]
                b[r] = named(b[r] - factor * b[i])
    solution: dict[sp.Symbol, sp.Expr] = {}
    for i in reversed(range(n)):
        rest = sp.Add(*(a[i][j] * solution[unknown[j]] for j in range(i + 1, n)))
        solution[unknown[i]] = named(b[i] - rest)
    return solution


def _pivot(a: list[list[sp.Expr]], i: int, named: _Named) -> tuple[int | None, int]:
    """Row and column of the next pivot; (None, i): column i has no pivot.

    Preferred is a pivot that is not zero where all parameters are zero: a gain of zero is no pivot.
    """
    left = range(i, len(a))
    places = ((row, column) for column in range(i, len(a[i])) for row in left)
    there = next(((r, c) for r, c in places if named.is_there_at_zero(a[r][c])), None)
    return there or (next((r for r in left if a[r][i] != 0), None), i)
