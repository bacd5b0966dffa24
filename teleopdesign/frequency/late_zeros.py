"""Zeros with Re s > 0 of a sum of polynomials in s, each delayed: how many there are.

    f(s) = sum_k p_k(s) e^(-s T_k),   T_0 = 0

Where p_0 is of the highest degree alone (or its leading coefficient outweighs the others there),
f(j w)/(j w + a)^n has no other turns than those that zeros of f with Re s > 0 make: minus half a
turn each, from w = 0 up (Mikhailov). Further out than `_find_lead` p_0 leads the phase.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from math import factorial
from typing import Any

import numpy as np
import sympy as sp

from ..base.errors import ModelError
from ..derive.polynomials import element, fraction, is_free_of_growth, roots, roots_of
from ..realise.lti import S

#: dead time (s) -> coefficients in s, highest power first
Terms = Mapping[float, np.ndarray]

#: frequencies on the first grid, before steps of the phase are halved
_POINTS = 4001
#: rad: longest step of the phase; a longer one is halved. Far from a zero of f, a quarter turn
#: would be sufficient
_STEP = 0.5
#: real part of a root, over its size, that is rounding
_ROUNDING = 1e-13
#: most samples of the phase: with more, the dead times are too long for the bandwidth of the loop
_MOST = 2_000_000


def exact_terms(
    polynomial: Any,
    times: Mapping[sp.Symbol, sp.Expr],
    values: Mapping[sp.Symbol, Fraction] | None = None,
) -> dict[Fraction, list[Fraction]]:
    """A polynomial in s and symbols of dead times: dead time (s) -> coefficients, highest first.

    polynomial: an element of a ring whose first generator is s
    times: symbol of e^(-s T) -> T, a number or the symbol of a value;  values: of all other symbols
    """
    known = values or {}
    symbols = polynomial.ring.symbols[1:]
    at = {x: sp.Rational(v.numerator, v.denominator) for x, v in known.items()}
    delays = {x: fraction(sp.sympify(t).xreplace(at)) for x, t in times.items()}
    made: dict[Fraction, dict[int, Fraction]] = {}
    for (power, *others), c in polynomial.items():
        late, size = Fraction(0), Fraction(int(c.numerator), int(c.denominator))
        for x, k in zip(symbols, others, strict=True):
            if k and x in delays:
                late += k * delays[x]
            elif k:
                size *= known[x] ** k
        of_this = made.setdefault(late, {})
        of_this[power] = of_this.get(power, Fraction(0)) + size
    kept = {t: {k: c for k, c in p.items() if c} for t, p in sorted(made.items())}
    return {t: [p.get(k, Fraction(0)) for k in range(max(p), -1, -1)] for t, p in kept.items() if p}


def terms_of(
    polynomial: Any,
    times: Mapping[sp.Symbol, sp.Expr],
    *,
    unit: Fraction | None = None,
    values: Mapping[sp.Symbol, Fraction] | None = None,
) -> Terms:
    """As `exact_terms`, in floats;  unit: divides all numbers; default: the largest of them."""
    exact = exact_terms(polynomial, times, values)
    unit = unit or max((abs(c) for p in exact.values() for c in p), default=Fraction(1))
    return {float(t): np.array([float(c / unit) for c in p]) for t, p in exact.items()}


def describe_growth(polynomial: Any, times: Mapping[sp.Symbol, sp.Expr]) -> str:
    """Modes of a polynomial, in words, that grow, 1/s; "" where all decay or keep their size."""
    if any(any(powers[1:]) for powers in polynomial):
        resting = zeros_at_origin(polynomial, times)  # a mode at s = 0 keeps its size
        grows = count_growing(terms_of(polynomial, times), resting)
        return "with dead times" if grows else ""
    p = sp.Poly(polynomial.as_expr(), S, domain="QQ")
    if p.degree() < 1 or is_free_of_growth(p):
        return ""
    at = roots_of(element(p.sqf_part()))
    growing = at[(at.real > 0) & (at.imag >= 0)]
    return ", ".join(f"{r:.4g}" if r.imag else f"{r.real:.4g}" for r in growing) + " 1/s"


def zeros_at_origin(polynomial: Any, times: Mapping[sp.Symbol, sp.Expr]) -> int:
    """How often f is zero at s = 0, exactly, by its series; f: not zero everywhere."""
    terms, order = exact_terms(polynomial, times), 0
    while not sum(
        (
            c * (-t) ** (order - k) / factorial(order - k)
            for t, falling in terms.items()
            for k, c in enumerate(reversed(falling))
            if k <= order
        ),
        Fraction(0),
    ):
        order += 1
    return order


def count_growing(terms: Terms, at_origin: int = 0) -> int:
    """Number of zeros of f with a positive real part, or at least 1 if there are any.

    Zeros within rounding of the axis count, but for `at_origin` of them at s = 0. A delayed term
    that is as strong as the first one at high frequency counts too: at a very small change of dead
    times there are infinitely many zeros.

    raises ModelError: the dead times turn the phase more often than can be followed
    """
    if not terms:
        return 1
    start = min(terms)
    terms = {t - start: p for t, p in terms.items()}
    first, *others = terms.values()
    degree = len(first) - 1
    if not others:
        # a root on the axis comes out of rounding on either side
        near = roots(first[: len(first) - at_origin])
        return int((near.real >= -_ROUNDING * np.abs(near)).sum())
    weight = sum(abs(coefficient(p, degree)) for p in others)
    if degree_of(terms) > degree or weight >= abs(first[0]):
        return 1
    corners = corners_of(terms)
    corners = corners if len(corners) else np.ones(1)
    scale = float(np.exp(np.mean(np.log(corners))))
    last = _find_lead(first, others, corners.max())
    number = int(last * max(terms) / _STEP) + 2
    if number > _MOST:
        raise ModelError("dead times are too long against the fastest that the loop lets pass")
    slow = np.geomspace(corners.min() / 1e4, last, _POINTS)
    w = np.unique(np.concatenate([slow, corners, np.linspace(0.0, last, number)]))
    w = w[1:] if at_origin else w

    def value(points: np.ndarray) -> np.ndarray:
        s = 1j * points
        total = sum((np.polyval(p, s) * np.exp(-s * t) for t, p in terms.items()), 0 * s)
        return np.asarray(total / s**at_origin / (s + scale) ** (degree - at_origin))

    turned = _turn(value, w)
    if turned is None:
        return 1
    # at w = 0 it is real
    start = float(np.angle(value(w[:1])[0]))
    turned += start - np.pi * round(start / np.pi)
    # further out the phase stays within a quarter turn of that of p_0, whose roots are slower
    end, left = 1j * w[-1], degree - at_origin
    last_value = value(w[-1:])[0] * end**at_origin * (end + scale) ** left
    turned -= float(np.angle(last_value / np.polyval(first, end)))
    turned += float(left * np.angle(1 + scale / end) - np.angle(1 - roots(first) / end).sum())
    return max(round(-turned / np.pi), 0)


def _turn(value: Callable[[np.ndarray], np.ndarray], w: np.ndarray) -> float | None:
    """Change of phase along these frequencies, rad; None: a zero on the axis makes it jump."""
    values = value(w)
    while (values != 0).all():
        steps = np.angle(values[1:] / values[:-1])
        wide = np.flatnonzero(np.abs(steps) > _STEP)
        if not len(wide):
            return float(steps.sum())
        middle = (w[wide] + w[wide + 1]) / 2
        if len(w) > _MOST or (middle == w[wide]).any() or (middle == w[wide + 1]).any():
            return None
        w, values = np.insert(w, wide + 1, middle), np.insert(values, wide + 1, value(middle))
    return None


def _find_lead(first: np.ndarray, others: Sequence[np.ndarray], start: float) -> float:
    """A frequency of at least `start` above which the first term exceeds all others, rad/s."""
    degree, w = len(first) - 1, start
    far = sum(abs(coefficient(p, degree)) for p in others) / abs(first[0])
    for _ in range(200):
        beyond = w * np.geomspace(1.0, 1e6, 400)
        size = sum((np.abs(np.polyval(p, 1j * beyond)) for p in others), 0 * beyond)
        if (size < (0.7 + 0.3 * far) * np.abs(np.polyval(first, 1j * beyond))).all():
            return w
        w *= 2
    raise ModelError("a late term is about as strong as the others at high frequency")


def corners_of(*sums: Terms) -> np.ndarray:
    """Magnitudes of the roots of all polynomials, and points across resonances, rad/s."""
    at = np.concatenate([np.zeros(0), *(roots(p) for terms in sums for p in terms.values())])
    at = at[np.abs(at) > 0]
    size = np.abs(at)[:, None]
    # a root on the axis itself has no width: 1e-9 of its size is what rounding leaves
    width = np.maximum(np.abs(at.real)[:, None], 1e-9 * size)
    across = np.abs(at.imag)[:, None] + width * np.linspace(-3, 3, 25)
    points = np.concatenate([size.ravel(), across.ravel()])
    return np.asarray(np.unique(points[points > 0]))


def coefficient(p: np.ndarray, degree: int) -> float:
    """Coefficient of s^degree."""
    return float(p[-1 - degree]) if len(p) > degree else 0.0


def degree_of(terms: Terms) -> int:
    """The highest power of s in all terms; -1: there are none."""
    return max((len(p) for p in terms.values()), default=0) - 1
