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
in floats with all rounding bounded. f is the determinant of all states, so it has all modes.
At one point f is a mapping: dead time (s) -> coefficients of its polynomial, highest power first.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp
from mpmath import iv

from ...base.errors import ModelError
from ...controllers import exact_decimal
from ...derive.effort import try_within_effort
from ...derive.polynomials import is_hurwitz
from ...frequency.late_zeros import Terms, count_growing, exact_terms, terms_of
from ..linear.signs import Signs
from .box import STABLE, IntervalClaim, Status, ValueBox, interval_claim, search_worst
from .late_cells import is_zero_free


def judge_late(
    p: Any, times: Mapping[sp.Symbol, sp.Expr], box: ValueBox, points: int, seed: int
) -> IntervalClaim:
    """Judge whether all zeros of f have a negative real part, over a box.

    p: f, a polynomial in s, the values of the box and symbols of e^(-s T);  times: of these T
    points, seed: of `search_worst`;  returns: the claim
    """
    symbols = p.ring.symbols[1 : 1 + len(box.names)]

    def at(point: np.ndarray) -> dict[sp.Symbol, Fraction]:
        numbers = (exact_decimal(float(x)) for x in point)
        return {x: Fraction(int(v.p), int(v.q)) for x, v in zip(symbols, numbers, strict=True)}

    def margin(point: np.ndarray) -> float:
        try:
            return slowest_decay(terms_of(p, times, values=at(point)))
        except ModelError:  # dead times turn the phase more often than can be followed
            return -np.inf

    worst = search_worst(margin, box, points=points, seed=seed)
    if worst.margin <= 0:
        there = at(worst.point)
        root = rightmost_root(terms_of(p, times, values=there))
        radius = holds_root(exact_terms(p, times, there), root) if root.real > 0 else None
        if radius is not None and root.real > radius:
            how = f"a pole at {root:.4g} 1/s, within {radius:.1g} 1/s: by Rouche's theorem"
            return interval_claim(STABLE, "refuted", worst, box, "1/s", how)
        how = (
            "at the worst point of the search a pole is beyond the axis, or too near to it, and "
            "not shown"
        )
        return interval_claim(STABLE, "unknown", worst, box, "1/s", how)
    cells = None
    # without dead times, in the middle of the box
    together = p.evaluate([(x, 1) for x in p.ring.gens[1 + len(box.names) :]])
    if is_hurwitz(Signs(box.exact).middle(together)):
        cells = try_within_effort(lambda: is_zero_free(p, times, box), None)
    status: Status = "evidence" if cells is None else "proved"
    how = "no proof over the whole box: not stable from no dead time on, or not shown part by part"
    if cells is not None:
        how = (
            f"no pole is on the axis for any dead time from 0 on, on {cells} parts of the box: in "
            "floats with all rounding bounded, without a certificate"
        )
    bound = {"proved_margin": 0.0} if cells is not None else {}
    return interval_claim(STABLE, status, worst, box, "1/s", how, **bound)


#: steps in which the dead times grow from 0 to their values, and Newton steps in each of them
_STEPS, _NEWTON = 20, 3
#: of the distance of a zero from the axis: no other zero is nearer than this
_SHARE = 0.999
#: over the shortest dead time: no first zero is searched nearer to the axis, or further from it
_NEAREST, _REACH = 1e-6, 1e3
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
    if rate <= 0:
        return rate
    if not np.isinf(rate) and not count_growing(_move_axis(terms, _SHARE * rate)):
        return rate
    if count_growing(terms):
        return -np.inf
    late = [t for t in terms if t > 0]
    if np.isinf(rate):  # the search reached no zero: how far from the axis is the first?
        if not late:
            return rate
        rate = _NEAREST / min(late)
        while rate * min(late) < _REACH and not count_growing(_move_axis(terms, rate)):
            rate *= 2
    low, high = 0.0, rate
    # halves of a share: the first zero may be at 0.7 of the rate
    while high - low > (1 - _SHARE) / 2 * rate:
        middle = (low + high) / 2
        low, high = (low, middle) if count_growing(_move_axis(terms, middle)) else (middle, high)
    return low


def _move_axis(terms: Terms, right: float) -> Terms:
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


def holds_root(terms: Mapping[Fraction, Sequence[Fraction]], at: complex) -> float | None:
    """Radius of a disc about `at` in which f has a zero, by Rouche's theorem; None: not shown.

    On the edge of the disc f - f'(at) (s - at) is smaller than f'(at) (s - at). The rest of the
    series is bounded by the same series with all terms positive. The bounds are intervals that are
    rounded outward.

    terms: exact, dead time (s) -> coefficients, highest first
    """
    with _many_digits():
        s, x = iv.mpc(at.real, at.imag), iv.mpf(at.real)
        size = abs(s)
        value, slope = iv.mpc(0), iv.mpc(0)
        parts = []
        for time, falling in terms.items():
            t, p = _interval(time), [_interval(c) for c in falling]
            late, (f, df) = iv.exp(-s * t), _horner(p, s)
            value, slope = value + f * late, slope + (df - t * f) * late
            sizes = [_interval(abs(c)) for c in falling]
            parts.append((iv.exp(-x * t), t, sizes, _horner(sizes, size)))
        for power in range(-10, -1):
            radius = abs(at) * 10.0**power
            rest = iv.mpf(0)
            for early, t, sizes, (first, bent) in parts:
                whole, _ = _horner(sizes, size + radius)
                rest += early * (whole * iv.exp(t * radius) - first - (bent + t * first) * radius)
            if (abs(value) + rest).b < (abs(slope) * radius).a:
                return float(radius)
    return None


@contextmanager
def _many_digits() -> Iterator[None]:
    before, iv.dps = iv.dps, 40
    try:
        yield
    finally:
        iv.dps = before


def _interval(x: Fraction) -> Any:
    return iv.mpf(x.numerator) / x.denominator


def _horner(falling: Sequence[Any], s: Any) -> tuple[Any, Any]:
    """A polynomial and its slope at s."""
    value, slope = 0 * s, 0 * s
    for c in falling:
        value, slope = value * s + c, slope * s + value
    return value, slope


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
