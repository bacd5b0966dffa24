"""Roots of a quasi-polynomial with dead times: a search for the rightmost one, and a proof of it.

    f(s) = sum_k p_k(s) e^(-s T_k)

It is stored as a mapping: dead time T_k (s) -> coefficients of p_k, highest power first.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction

import numpy as np
import sympy as sp

from ...frequency.late_loop import count_growing
from ...realise.enclosure import enclosure_of
from .late_terms import ExactTerms

Terms = Mapping[float, np.ndarray]

#: steps in which the dead times grow from 0 to their values, and Newton steps in each of them
_STEPS, _NEWTON = 20, 3
#: of the distance of a zero from the axis: no other zero is nearer than this
_SHARE = 0.999
#: most minima of abs(f) along the axis from which a search for zeros starts
_LOWEST = 12


def chain_rate(terms: Terms) -> float:
    """Largest real part, 1/s, to which chains of zeros far out tend; -inf: there is none.

    Late terms of the highest power of s have such chains (neutral systems): at the real part r at
    which the sum of their sizes, times e^(-r T), is that of the term without dead time. It is that
    limit at this dead times or at ones that differ as little as one likes.
    """
    from scipy.optimize import brentq

    degree = max(map(len, terms.values()))
    leads = {t: abs(p[0]) for t, p in terms.items() if len(p) == degree and t > 0}
    first = terms.get(0.0, np.zeros(0))
    if not leads or len(first) < degree:
        return np.inf if leads else -np.inf
    size = abs(first[0])

    def excess(rate: float) -> float:
        return float(sum(c * np.exp(-rate * t) for t, c in leads.items()) / size - 1)

    times = max(leads) if excess(0.0) > 0 else min(leads)
    reach = np.log(max(sum(leads.values()) / size, 1e-300)) / times
    ends = sorted((2 * reach, 0.0)) if reach else (-1.0, 1.0)
    return float(brentq(excess, *ends)) if excess(ends[0]) * excess(ends[1]) < 0 else reach


def slowest_decay(terms: Terms) -> float:
    """Distance of the rightmost zero from the axis, 1/s; < 0: it grows, -inf: by an unknown rate.

    The zeros that a search reaches and the limits of chains far out are a candidate. A count of all
    zeros to the right of it then confirms it, or finds by halving how far zeros come.
    """
    rate = -max(rightmost_root(terms).real, chain_rate(terms))
    if rate <= 0 or np.isinf(rate):
        return rate if rate <= 0 or not count_growing(terms) else -np.inf
    if not count_growing(_moved(terms, _SHARE * rate)):
        return rate
    low, high = 0.0, rate
    if count_growing(terms):
        return -np.inf
    while high - low > (1 - _SHARE) * rate:
        middle = (low + high) / 2
        low, high = (low, middle) if count_growing(_moved(terms, middle)) else (middle, high)
    return low


def _moved(terms: Terms, right: float) -> Terms:
    """The sum with all its zeros moved to the right, 1/s."""
    step = np.poly1d([1.0, -right])
    return {t: np.exp(right * t) * np.poly1d(p)(step).coeffs for t, p in terms.items()}


def rightmost_root(terms: Terms) -> complex:
    """The zero with the largest real part that a search reaches, 1/s; -inf: none.

    The search starts from the zeros without dead times, and from minima of abs(f) along the axis.
    """
    degree = max(map(len, terms.values())) - 1
    together = np.zeros(degree + 1)
    for p in terms.values():
        together[degree + 1 - len(p) :] += p
    s = np.roots(together).astype(complex)
    for share in np.arange(1, _STEPS + 1) / _STEPS:
        s = _improve({share * t: p for t, p in terms.items()} if share < 1 else terms, s, _NEWTON)
    size = max(float(np.abs(np.roots(together)).max(initial=0.0)), 1e-6)
    w = np.concatenate([np.geomspace(1e-3, 10, 500), np.linspace(0, 10, 1500)]) * size
    w.sort()
    height = np.abs(_values(terms, 1j * w)[0])
    low = np.flatnonzero((height[1:-1] < height[:-2]) & (height[1:-1] <= height[2:])) + 1
    low = low[np.argsort(height[low])][:_LOWEST]
    s = np.concatenate([s, 1j * w[low]])
    s = _improve(terms, s, 12)
    value, _, scale = _values(terms, s)
    with np.errstate(all="ignore"):
        near = np.abs(value) < 1e-9 * scale
    s = s[near & np.isfinite(s)]
    return complex(max(s, key=lambda x: x.real)) if len(s) else complex(-np.inf)


def holds_root(terms: ExactTerms, at: complex) -> float | None:
    """Radius of a disc about `at` in which f has a zero, by Rouche's theorem; None: not shown.

    On the edge of the disc f - f'(at) (s - at) is smaller than f'(at) (s - at). The rest of the
    series is bounded by the same series with all terms positive. The bounds are intervals that are
    rounded outward.
    """
    x, y = Fraction(at.real), Fraction(at.imag)
    # not below the size of `at`
    base = Fraction(abs(at)) * Fraction(1 + 2**-50)
    value, slope = _enclose_at(terms, x, y)
    least_slope, most_value = math.sqrt(slope[0]) * (1 - 1e-15), math.sqrt(value[1]) * (1 + 1e-15)
    for power in range(-10, -1):
        radius = base * Fraction(10) ** power
        rest = sp.Add(*(_further(p, t, x, base, radius) for t, p in terms.items()))
        _, most = enclosure_of(rest, ())(())
        edge = float(radius) * (1 - 1e-15)
        if (most_value + most) * (1 + 1e-15) < least_slope * edge * (1 - 1e-15):
            return float(radius) * (1 + 1e-15)
    return None


def _further(
    coefficients: Sequence[Fraction], time: Fraction, x: Fraction, base: Fraction, radius: Fraction
) -> sp.Expr:
    """Bound of the deviation of p e^(-s T) from its tangent within a disc about a point.

    x: real part of the point;  base: bound of its absolute value;  radius: of the disc
    """
    sizes = [abs(c) for c in coefficients]
    first = _value(sizes, (base, Fraction(0)))[0]
    bent = _value(_slopes(sizes), (base, Fraction(0)))[0] + time * first
    whole = _value(sizes, (base + radius, Fraction(0)))[0]
    turned = _number(whole) * sp.exp(_number(time * radius)) - _number(first + bent * radius)
    return sp.exp(_number(-time * x)) * turned


def _enclose_at(
    terms: ExactTerms, x: Fraction, y: Fraction
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Lower and upper bounds of abs(f)^2 and of abs(f')^2 at x + j y."""
    value, slope = [sp.S(0), sp.S(0)], [sp.S(0), sp.S(0)]
    for t, p in terms.items():
        a, b = _value(p, (x, y))
        c, d = _value(_slopes(p), (x, y))
        size, turn = sp.exp(_number(-t * x)), _number(t * y)
        for total, (real, imaginary) in ((value, (a, b)), (slope, (c - t * a, d - t * b))):
            real, imaginary = _number(real), _number(imaginary)
            total[0] += size * (real * sp.cos(turn) + imaginary * sp.sin(turn))
            total[1] += size * (imaginary * sp.cos(turn) - real * sp.sin(turn))
    first, second = (enclosure_of(r**2 + i**2, ())(()) for r, i in (value, slope))
    return first, second


def _value(
    coefficients: Sequence[Fraction], at: tuple[Fraction, Fraction]
) -> tuple[Fraction, Fraction]:
    """Real and imaginary part of a polynomial at a complex number, exactly."""
    a, b = Fraction(0), Fraction(0)
    for c in coefficients:
        a, b = a * at[0] - b * at[1] + c, a * at[1] + b * at[0]
    return a, b


def _slopes(coefficients: Sequence[Fraction]) -> list[Fraction]:
    """Coefficients of the derivative of a polynomial, highest power first."""
    n = len(coefficients) - 1
    return [c * (n - i) for i, c in enumerate(coefficients[:-1])]


def _number(value: Fraction) -> sp.Rational:
    return sp.Rational(value.numerator, value.denominator)


def _improve(terms: Terms, s: np.ndarray, steps: int) -> np.ndarray:
    for _ in range(steps):
        value, slope, _ = _values(terms, s)
        with np.errstate(all="ignore"):
            step = value / slope
            s = np.where(np.isfinite(step), s - step, s)
    return s


def _values(terms: Terms, s: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """f, f' and the sum of the absolute values of all terms, at points s, (n,) each."""
    value, slope, scale = 0 * s, 0 * s, np.zeros(len(s))
    with np.errstate(all="ignore"):
        for t, p in terms.items():
            late, here = np.exp(-s * t), np.polyval(p, s)
            value = value + here * late
            slope = slope + (np.polyval(np.polyder(p), s) - t * here) * late
            scale = scale + np.polyval(np.abs(p), np.abs(s)) * np.abs(late)
    return value, slope, scale
