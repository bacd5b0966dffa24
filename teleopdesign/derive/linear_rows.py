"""Laws and effects as rows of coefficients, and symbols for dead times.

`solve` gives determinant and solution of sparse equations with such rows, exactly.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache, reduce
from typing import Any

import sympy as sp

from ..base.errors import ModelError
from ..controllers import SIGNALS, ControlLaw, Controller, Stage, make_exact
from ..effects import Effect, delayed
from ..realise.lti import S
from .effort import spend

#: e^(-s T) of a dead time T, before the dead times are known as numbers
LATE = sp.Function("late")
DRIVE, MOVED, SPEED = sp.symbols("drive moved frozen_speed")

#: a dead time is a power of one symbol up to this exponent, else a symbol of its own
_MOST_POWERS = 100


def late_symbols(
    delays: Iterable[sp.Expr],
) -> tuple[dict[sp.Symbol, sp.Expr], dict[sp.Expr, sp.Expr]]:
    """Symbols of e^(-s T) with their dead times, and e^(-s T) of each delay in these symbols.

    Dead times that are small multiples of one time are powers of one symbol, because their phases
    go together.
    delays: numbers, or symbols of values
    """
    times: dict[sp.Symbol, sp.Expr] = {}
    powers: dict[sp.Expr, sp.Expr] = {}
    fixed = sorted({t for t in delays if t.is_Rational})
    base = reduce(sp.gcd, fixed) if fixed else sp.S(1)
    if fixed and fixed[-1] / base <= _MOST_POWERS:
        times[mark := sp.Dummy("late")] = base
        powers |= {t: mark ** (t / base) for t in fixed}
    for t in delays:
        if t not in powers:
            times[mark := sp.Dummy(f"late_{len(times)}")] = t
            powers[t] = mark
    return times, powers


def read_late_ratios(
    entries: Iterable[sp.Expr], where: str
) -> tuple[list[tuple[Any, Any]], dict[sp.Symbol, sp.Expr]]:
    """Expressions in `S` and e^(-S T) as coprime numerators and denominators, and the dead times.

    where: beginning of the message
    returns: elements of one ring, of s and symbols of e^(-s T);  these symbols -> T
    raises ModelError: one is no ratio of polynomials in s and dead times
    """
    entries = [make_exact(e) for e in entries]
    powers = set[sp.Expr]().union(*(e.atoms(sp.exp) for e in entries))
    delays = {power: -power.args[0].coeff(S) for power in powers}
    times, marks = late_symbols(delays.values())
    placed = {power: marks[time] for power, time in delays.items()}
    field = sp.QQ.frac_field(S, *times)
    pairs = []
    for e in entries:
        try:
            if not all(time.is_Rational for time in times.values()):
                raise ValueError(f"a dead time of {e} is no number")
            made = field.from_sympy(e.xreplace(placed))
        except ZeroDivisionError:
            raise ModelError(f"{where}: division by zero") from None
        except ValueError:
            allowed = "a rational function of s with rational numbers"
            raise ModelError(f"{where}: not {allowed} and dead times: {e}") from None
        pairs.append((made.numer, made.denom))
    return pairs, times


@dataclass(frozen=True)
class OfLaw:
    """A stage, equal to every stage of the same law: its values are symbols in the rows."""

    law: ControlLaw
    stage: Stage = field(compare=False)


_Rows = tuple[tuple[str, ...], tuple[tuple[sp.Expr, ...], ...], tuple[sp.Expr, ...]]


@lru_cache(maxsize=512)
def rows_of_law(of: OfLaw) -> _Rows:
    """States of a law; for the rate of each, and for the output, coefficients in continuous time.

    Coefficients are those of the states, of the input and of the motion.
    """
    velocity = S * MOVED
    signals = {"input": DRIVE, "velocity": velocity, "speed": SPEED, "travel_rate": velocity}
    alone = Controller((replace(of.stage, name="law"),))
    made = alone.equation("law", {**SIGNALS, **signals, "period": sp.S(0)})
    unknown = (*made.rates, DRIVE, MOVED)
    names = tuple(x.name.removeprefix("law_law_") for x in made.rates)
    return names, tuple(_row(e, unknown) for e in made.rates.values()), _row(made.output, unknown)


@lru_cache(maxsize=512)
def rows_of_effect(effect: Effect) -> _Rows:
    """As `rows_of_law`, for an effect: its input is the command, or the position of the body."""
    motion = {"position": MOVED, "velocity": S * MOVED, "acceleration": S**2 * MOVED}
    signals = {**motion, "command": DRIVE, "interaction_force": sp.S(0)}
    rates, output = effect.rates(signals, {}), effect.expression(signals, {})
    states = effect.state_symbols()
    unknown = (*(states[n] for n in rates), DRIVE, MOVED)
    return tuple(rates), tuple(_row(e, unknown) for e in rates.values()), _row(output, unknown)


def _row(expression: sp.Expr, unknown: Sequence[sp.Symbol]) -> tuple[sp.Expr, ...]:
    """Coefficients of the unknowns in an expression that is linear in them."""
    placed = expression.replace(delayed, lambda signal, time: signal * LATE(time))
    return tuple(sp.diff(placed, x) for x in unknown)


#: an equation: unknown -> coefficient; the sum of coefficient times unknown is zero
Row = dict[str, Any]


def solve(
    rows: list[Row], wanted: Sequence[str], given: Sequence[str], ring: Any
) -> tuple[Any, list[list[Any]]]:
    """Determinant d of the unknowns, and N with wanted = N given/d, by elimination (Cramer).

    Unknowns that have a number as a coefficient go first; then Bareiss' scheme without fractions.
    """
    names = [n for n in dict.fromkeys(n for row in rows for n in row) if n not in given]
    if len(names) != len(rows) or not {*wanted} <= {*names}:
        return ring.zero, []
    scale, rows = eliminate_numbers([dict(row) for row in rows], {*wanted, *given})
    left = [n for n in dict.fromkeys(n for row in rows for n in row) if n not in {*wanted, *given}]
    columns = [*left, *wanted]
    if len(columns) != len(rows):
        return ring.zero, []
    matrix = [[row.get(n, ring.zero) for n in (*columns, *given)] for row in rows]
    determinant = _bareiss(matrix, len(columns), len(wanted), ring)
    if not determinant:
        return ring.zero, []
    answers = [[e * -scale for e in row[len(columns) :]] for row in matrix[len(left) :]]
    return determinant * scale, answers


def eliminate_numbers(rows: list[Row], kept: set[str]) -> tuple[Any, list[Row]]:
    """The rows without unknowns that have a number as a coefficient, and the product of these."""
    scale = sp.QQ(1)
    while True:
        uses: dict[str, int] = {}
        for row in rows:
            for n in row:
                uses[n] = uses.get(n, 0) + 1
        choices = [
            ((len(row) - 1) * (uses[n] - 1), i, n)
            for i, row in enumerate(rows)
            for n, c in row.items()
            if n not in kept and c.is_ground
        ]
        if not choices:
            return scale, rows
        _, i, name = min(choices)
        pivot = rows.pop(i)
        number = pivot.pop(name).LC
        scale *= number
        for row in rows:
            if name in row:
                factor = row.pop(name) * (-1 / number)
                for n, c in pivot.items():
                    total = row[n] + factor * c if n in row else factor * c
                    if total:
                        row[n] = total
                    else:
                        row.pop(n, None)


def _bareiss(matrix: list[list[Any]], size: int, last: int, ring: Any) -> Any:
    """Eliminate in place: the last rows become diagonal; returns the determinant but for its sign.

    size: number of unknowns, in the first columns;  last: number of rows at the end to make
        diagonal; further columns are transformed alike
    """
    before = ring.one
    for k in range(size):
        usable = [(len(matrix[i][k]), i) for i in range(k, size) if matrix[i][k]]
        if not usable:
            return ring.zero
        i = min(usable)[1]
        matrix[i], matrix[k] = matrix[k], matrix[i]
        pivot, pivots = matrix[k][k], matrix[k]
        for i in range(min(k + 1, size - last), size):
            row = matrix[i]
            if i == k:
                continue
            factor, row[k] = row[k], ring.zero
            for j in range(k + 1, len(row)):
                if row[j] or (factor and pivots[j]):
                    spend(len(pivot) * len(row[j]) + len(factor) * len(pivots[j]))
                    product = pivot * row[j] - factor * pivots[j]
                    row[j] = product if before == 1 else product.exquo(before)
            if i < k:
                row[i] = pivot
        before = pivot
    return before
