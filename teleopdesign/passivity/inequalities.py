"""Inequalities on laws, proved over ranges of their symbols: exactly, or by intervals."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import product

import sympy as sp

from ..base.errors import ModelError
from ..derive.polynomials import has_positive_root, is_non_negative
from ..realise.enclosure import enclosure_of
from ..realise.extremes import least_value

Ranges = Mapping[sp.Symbol, tuple[float, float]]
#: range of a symbol that may be any number, and of one that may be any number above 0
ANY, POSITIVE = (-math.inf, math.inf), (0.0, math.inf)
#: most parts of a law whose corners are tried: 2^10 corners take 0.1 s
_MOST_PARTS = 10


def is_never_negative(law: sp.Expr, ranges: Ranges) -> bool:
    """Whether it is proved that law >= 0 for all values of its symbols within their ranges.

    False also where the law is undefined at some point, or where nothing is known.
    """
    law = sp.sympify(law)
    if law.is_Rational:
        return bool(law >= 0)
    if law.has(sp.nan, sp.zoo, sp.oo, -sp.oo):
        return False
    free = sorted(law.free_symbols, key=str)
    for symbol in free:
        if ranges.get(symbol) == ANY:
            size = sp.Symbol(f"size_of_{symbol.name}", positive=True)
            cases = (law.subs(symbol, way * size) for way in (1, -1, 0))
            return all(is_never_negative(case, {**ranges, size: POSITIVE}) for case in cases)
    if len(free) == 1 and ranges.get(free[0]) == POSITIVE and law.is_rational_function(*free):
        return _is_above_zero(law, free[0])
    return _is_above_zero_at_corners(law, ranges) or least_bound(law, ranges) >= 0


def least_bound(law: sp.Expr, ranges: Ranges) -> float:
    """A number that the law is never below; -inf where none is known."""
    try:
        return least_value(*_on_ranges_that_end(law, ranges)).bound
    except ModelError:  # a function without a known bound
        return -math.inf


def _on_ranges_that_end(law: sp.Expr, ranges: Ranges) -> tuple[sp.Expr, Ranges]:
    """The law with each positive number as share/(1 - share), cancelled where it can be."""
    shares: dict[sp.Symbol, sp.Expr] = {}
    ends = dict(ranges)
    for symbol in law.free_symbols:
        if ranges.get(symbol) == POSITIVE:
            share = sp.Symbol(f"share_{symbol.name}", positive=True)
            shares[symbol], ends[share] = share / (1 - share), (0.0, 1.0)
    law = law.subs(shares)
    try:
        return sp.cancel(law), ends
    except (sp.PolynomialError, NotImplementedError):
        return law, ends


def _is_above_zero(law: sp.Expr, symbol: sp.Symbol) -> bool:
    """Whether a rational function is >= 0 for all positive values, without a pole; exactly."""
    above, below = (sp.Poly(part, symbol) for part in sp.fraction(sp.cancel(law)))
    if not all(c.is_Rational for part in (above, below) for c in part.all_coeffs()):
        return least_bound(law, {symbol: POSITIVE}) >= 0
    return not has_positive_root(below.sqf_part()) and is_non_negative(above * below)


def _is_above_zero_at_corners(law: sp.Expr, ranges: Ranges) -> bool:
    """Whether a law that is affine in each of its parts is >= 0 for all their values; exactly.

    A part is a function with a finite range, such as tanh(v); a positive number that several parts
    share stays as it is. The law is then >= 0 where all coefficients of the powers of such numbers
    are, and each coefficient is least at a corner. False where the law is of another form.
    """
    parts: dict[sp.Expr, sp.Symbol] = {}
    _mark_parts(law, parts, frozenset())
    used = [x for part in parts for x in part.free_symbols if ranges.get(x) == POSITIVE]
    shared = frozenset(x for x in used if used.count(x) > 1)
    parts = {}
    above, below = sp.fraction(sp.together(_mark_parts(law, parts, shared)))
    if len(parts) > _MOST_PARTS:
        return False
    ends = {mark: range_of(part, ranges) for part, mark in parts.items()}
    if not all(math.isfinite(x) for pair in ends.values() for x in pair):
        return False
    least = [_least_coefficient(part, ends, shared) for part in (above, below)]
    return bool(least[0] >= 0 and least[1] > 0)


def _least_coefficient(
    law: sp.Expr, ends: Mapping[sp.Symbol, tuple[sp.Expr, sp.Expr]], shared: frozenset[sp.Symbol]
) -> sp.Expr:
    """The least value of the constant term of a polynomial in positive numbers.

    ends: ranges of the marks in its coefficients;  shared: the positive numbers
    returns: -1 where another coefficient may be below 0, or one is not affine in the marks
    """
    marks, positive = sorted(ends, key=str), sorted(shared, key=str)
    whole = sp.Poly(law, *positive, *marks)
    if any(whole.degree(x) > 1 for x in marks):
        return sp.S(-1)
    coefficients = {(0,) * len(positive): sp.S(0)}
    for powers, c in whole.terms():
        power, rest = powers[: len(positive)], powers[len(positive) :]
        term = c * sp.prod(x**k for x, k in zip(marks, rest, strict=True))
        coefficients[power] = coefficients.get(power, sp.S(0)) + term
    corners = [dict(zip(marks, c, strict=True)) for c in product(*(ends[x] for x in marks))]
    least = {power: min(c.subs(at) for at in corners) for power, c in coefficients.items()}
    return least[(0,) * len(positive)] if min(least.values()) >= 0 else sp.S(-1)


def _mark_parts(
    law: sp.Expr, parts: dict[sp.Expr, sp.Symbol], shared: frozenset[sp.Symbol]
) -> sp.Expr:
    """The law with a mark for each part that is no sum, product or whole power of others.

    Factors of a product that hold one symbol alone are one part.

    parts: part -> its mark; changed in place;  shared: symbols of no part, but in fractions
    """
    if law.is_Rational or law in shared:
        return law
    if law.is_Add:
        return sp.Add(*(_mark_parts(part, parts, shared) for part in law.args))
    if law.is_Pow and law.exp.is_Integer and (law.exp > 0 or law.free_symbols & shared):
        return _mark_parts(law.base, parts, shared) ** law.exp
    if law.is_Mul:
        groups: dict[frozenset[sp.Symbol], list[sp.Expr]] = {}
        for factor in law.args:
            groups.setdefault(frozenset(factor.free_symbols), []).append(factor)
        if len(groups) > 1 or groups.keys() <= {frozenset({x}) for x in shared}:
            each = law.args if len(groups) == 1 else [sp.Mul(*g) for g in groups.values()]
            return sp.Mul(*(_mark_parts(part, parts, shared) for part in each))
    return parts.setdefault(law, sp.Dummy())


def range_of(part: sp.Expr, ranges: Ranges) -> tuple[sp.Expr, sp.Expr]:
    """Numbers between which all values of an expression lie; infinite where none are known."""
    if part.is_Rational:
        return part, part
    free = sorted(part.free_symbols, key=str)
    if len(free) == 1 and ranges.get(free[0]) == POSITIVE:
        if (ends := _ends_of_fraction(part, free[0])) is not None:
            return ends
        square = _ends_of_fraction(sp.cancel(part**2), free[0])  # of a root
        if square is not None and square[0] >= 0:
            most = sp.sqrt(square[1])
            most = most if most.is_Rational else sp.Rational(math.nextafter(float(most), math.inf))
            return (sp.S(0) if part.is_nonnegative else -most), most
    one, known = _on_ranges_that_end(part, ranges)
    symbols = sorted(one.free_symbols, key=str)
    try:
        low, high = enclosure_of(one, symbols)([known[s] for s in symbols])
    except (ModelError, KeyError):
        return -sp.oo, sp.oo
    return sp.Rational(low) if math.isfinite(low) else -sp.oo, (
        sp.Rational(high) if math.isfinite(high) else sp.oo
    )


def _ends_of_fraction(law: sp.Expr, symbol: sp.Symbol) -> tuple[sp.Expr, sp.Expr] | None:
    """Ends of a rational function of a positive number that is between its two limits, or None."""
    if not law.is_rational_function(symbol):
        return None
    ends = sorted((sp.limit(law, symbol, at) for at in (0, sp.oo)), key=float)
    if not all(x.is_Rational for x in ends):
        return None
    within = (law - ends[0], ends[1] - law)
    return (ends[0], ends[1]) if all(_is_above_zero(e, symbol) for e in within) else None
