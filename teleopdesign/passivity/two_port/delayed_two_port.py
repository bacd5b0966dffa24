"""Two-ports with dead times: checks of poles, residues and both ends of the axis.

A sweep over frequency does not show these. An entry is a sum of r_k(s) e^(-s T_k), r_k rational, so
its poles are those of the r_k. The checks at s = 0 and at both ends of the axis are in rational
arithmetic, those at other poles are numerical. The functions return obstacles: reasons why a margin
over frequency is no evidence. The absence of obstacles is no proof.
"""

from __future__ import annotations

import cmath
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import factorial
from typing import Literal

import numpy as np
import sympy as sp

from ...realise.lti import S
from ..checker.absolute_stability import Ratio, coprime
from ..checker.polynomials import (
    Polynomial,
    add,
    derivative,
    divide,
    greatest_common_divisor,
    halves,
    is_free_of_growth,
    multiply,
    polynomial,
    real_part,
    signs_at_roots,
    without_zero,
)
from .growing_mode import sort_by_power
from .two_port import TwoPort

Criterion = Literal["absolutely stable", "passive"]
#: terms of a series at s = 0 after the leading one
_TERMS = 24
#: relative tolerance of a residue, for rounding: the frequency of its pole may be irrational
_ROUNDING = 1e-9
_NAMES = ("z11", "z12", "z21", "z22")


@dataclass(frozen=True)
class Late:
    """A late rational function: ratio * e^(-s delay), delay in s."""

    ratio: Ratio
    delay: Fraction


def late_terms(entry: sp.Expr) -> tuple[Late, ...] | None:
    """An entry as a sum of late rational functions; None if a dead time is in a denominator."""
    powers = sorted(entry.atoms(sp.exp), key=str)
    marks = [sp.Dummy(f"e{k}") for k in range(len(powers))]
    rates = [e.args[0].coeff(S) for e in powers]
    if not all(rate.is_Rational for rate in rates):
        return None
    delays = [Fraction(-int(rate.p), int(rate.q)) for rate in rates]
    plain = entry.xreplace(dict(zip(powers, marks, strict=True)))
    above, below = sp.fraction(sp.together(plain))
    if below.free_symbols & set(marks) or not above.is_polynomial(S, *marks):
        return None
    q = sort_by_power(sp.Poly(below, S, domain="QQ"))
    by_delay: dict[Fraction, Polynomial] = {}
    for exponents, c in sp.Poly(above, *marks, S).terms():
        *times, power = exponents
        delay = sum((n * t for n, t in zip(times, delays, strict=True)), Fraction(0))
        one = polynomial([*[0] * power, Fraction(int(c.p), int(c.q))])
        by_delay[delay] = add(by_delay.get(delay, []), one)
    terms_by_delay = ((coprime(p, q), delay) for delay, p in sorted(by_delay.items()) if p)
    return tuple(Late(ratio, delay) for ratio, delay in terms_by_delay)


def obstacles(system: TwoPort, criterion: Criterion) -> tuple[str, ...]:
    """Reasons why margins on the axis are no evidence for this two-port; empty: no reason."""
    entries = [late_terms(e) for e in system.z]
    lost = [n for n, e in zip(_NAMES, entries, strict=True) if e is None]
    if lost:
        return (f"a dead time in the denominator of {lost[0]}: its poles are not counted",)
    z = [e for e in entries if e is not None]
    reasons = list(_growth(z))
    if not reasons:
        reasons += [
            *_check_at_zero(z, criterion),
            *_check_on_axis(z, criterion),
            *_far_out(z, criterion),
        ]
    return tuple(reasons)


def _growth(z: Sequence[tuple[Late, ...]]) -> Iterator[str]:
    for name, terms in zip(_NAMES, z, strict=True):
        if not all(is_free_of_growth(t.ratio[1]) for t in terms):
            yield f"{name} has a pole in the open right half plane"


def _check_at_zero(z: Sequence[tuple[Late, ...]], criterion: Criterion) -> Iterator[str]:
    """Obstacles at s = 0, exact: order of the pole, residues, and the limit of the inequality."""
    series = [_series(terms) for terms in z]
    for name, coefficients in zip(_NAMES, series, strict=True):
        if any(c and n < -1 for n, c in coefficients.items()):
            yield f"{name} has a multiple pole at s = 0"
            return
    k = [c.get(-1, Fraction(0)) for c in series]
    if not _is_allowed([complex(x) for x in k], criterion, 0.0) or not _holds_exactly(k, criterion):
        yield "the residues at s = 0 do not meet the criterion"
    for margin in _low_frequency(series, criterion):
        first = next((c for c in margin if c), Fraction(0))
        if first < 0:
            yield "the inequality fails in the limit of low frequency"
            return


def _holds_exactly(k: Sequence[Fraction], criterion: Criterion) -> bool:
    if min(k[0], k[3]) < 0:
        return False
    if criterion == "passive":
        return k[1] == k[2] and k[0] * k[3] >= k[1] * k[2]
    return 2 * k[0] * k[3] - k[1] * k[2] >= abs(k[1] * k[2])


def _series(terms: Sequence[Late]) -> dict[int, Fraction]:
    """Laurent coefficients of a sum of late terms at s = 0: power of s -> coefficient."""
    total: dict[int, Fraction] = {}
    for term in terms:
        p, q = term.ratio
        order = next(k for k, c in enumerate(q) if c)
        q, number = q[order:], _TERMS + order
        late = polynomial((-term.delay) ** n / factorial(n) for n in range(number))
        above = multiply(p, late) + [Fraction(0)] * number
        quotient: list[Fraction] = []
        for n in range(number):
            inner = (q[i] * quotient[n - i] for i in range(1, min(n, len(q) - 1) + 1))
            quotient.append((above[n] - sum(inner, Fraction(0))) / q[0])
        for n, c in enumerate(quotient):
            total[n - order] = total.get(n - order, Fraction(0)) + c
    return total


def _low_frequency(
    series: Sequence[dict[int, Fraction]], criterion: Criterion
) -> Iterator[list[Fraction]]:
    """Polynomials in w, lowest power first, that must not be negative as w -> 0.

    Poles at s = 0 are of first order. Each entry is multiplied by w.
    """
    (r1, _), (re12, im12), (re21, im21), (r2, _) = (_parts(c) for c in series)
    yield r1[1:]
    yield r2[1:]
    if criterion == "passive":  # twice the Hermitian part
        re, im = add(re12, re21), add(im12, im21, -1)
        size = add(multiply(re, re), multiply(im, im))
        yield _trusted_coefficients(add(multiply([Fraction(4)], r1, r2), size, -1))
        return
    re = add(multiply(re12, re21), multiply(im12, im21), -1)
    im = add(multiply(re12, im21), multiply(im12, re21))
    a = add(multiply([Fraction(2)], r1, r2), re, -1)
    yield _trusted_coefficients(a)
    yield _trusted_coefficients(add(multiply(a, a), add(multiply(re, re), multiply(im, im)), -1))


def _trusted_coefficients(p: Polynomial) -> Polynomial:
    """The coefficients that do not depend on the truncated rest of the series."""
    return p[: _TERMS - 2]


def _parts(series: dict[int, Fraction]) -> tuple[Polynomial, Polynomial]:
    """Real and imaginary part of a series at s = j w, each times w; lowest power of w first."""
    real, imaginary = [Fraction(0)] * (_TERMS - 1), [Fraction(0)] * (_TERMS - 1)
    for n, c in series.items():
        if -1 <= n < _TERMS - 2:
            part = (real, imaginary)[n % 2]
            part[n + 1] += c if n // 2 % 2 == 0 else -c
    return real, imaginary


def _check_on_axis(z: Sequence[tuple[Late, ...]], criterion: Criterion) -> Iterator[str]:
    """Obstacles at poles j w, w > 0: residues (floating point), and multiple poles of a term."""
    shared = [Fraction(1)]
    for name, terms in zip(_NAMES, z, strict=True):
        for term in terms:
            q = term.ratio[1]
            poles = without_zero(greatest_common_divisor(*halves(q)))
            twice = greatest_common_divisor(q, derivative(q))
            multiple = without_zero(greatest_common_divisor(*halves(twice)))
            if sum(signs_at_roots([Fraction(1)], multiple)):
                yield f"{name} has a multiple pole on the axis"
                return
            shared = multiply(shared, divide(poles, greatest_common_divisor(poles, shared))[0])
    for x in _positive_roots(shared):
        s = 1j * x**0.5
        k = [_residue(terms, s) for terms in z]
        if not _is_allowed(k, criterion, _ROUNDING):
            yield f"the residues at {x**0.5:.4g} rad/s do not meet the criterion"


def _positive_roots(p: Polynomial) -> list[float]:
    if len(p) < 2:
        return []
    roots = np.roots([float(c) for c in reversed(p)])
    return [float(r.real) for r in roots if r.real > 0 and abs(r.imag) < 1e-6 * abs(r)]


def _residue(terms: Sequence[Late], s: complex) -> complex:
    total = 0j
    for term in terms:
        p, q = ([float(c) for c in reversed(r)] for r in term.ratio)
        slope = np.polyval(np.polyder(q), s) if len(q) > 1 else 0
        sizes = [abs(c) * abs(s) ** k for k, c in enumerate(reversed(q))]
        if slope != 0 and abs(np.polyval(q, s)) < 1e-9 * sum(sizes):
            total += complex(np.polyval(p, s) / slope) * cmath.exp(-s * float(term.delay))
    return total


def _is_allowed(k: Sequence[complex], criterion: Criterion, rounding: float) -> bool:
    k11, k12, k21, k22 = k
    tolerance = rounding * max(abs(x) for x in k)
    if min(k11.real, k22.real) < -tolerance or max(abs(k11.imag), abs(k22.imag)) > tolerance:
        return False
    near = rounding * (abs(k11 * k22) + abs(k12 * k21))
    if criterion == "passive":
        hermitian = abs(k12 - k21.conjugate()) <= tolerance
        return hermitian and (k11 * k22).real >= abs(k12) ** 2 - near
    crossed = k12 * k21
    return 2 * (k11 * k22).real - crossed.real >= abs(crossed) - near


def _far_out(z: Sequence[tuple[Late, ...]], criterion: Criterion) -> Iterator[str]:
    """Obstacles at high frequency: growth like s, and the inequality in the limit.

    A late product z12 z21 has every phase there, so its size counts: Re z11 Re z22 >= abs(z12 z21).
    For passivity the size of the off-diagonal counts, abs(z12) + abs(z21).
    """
    excess = [max((len(t.ratio[0]) - len(t.ratio[1]) for t in terms), default=0) for terms in z]
    for name, n in zip(_NAMES, excess, strict=True):
        if n > 1:
            yield f"{name} grows faster than s at high frequency"
            return
    if any(t.delay and len(t.ratio[0]) >= len(t.ratio[1]) for k in (0, 3) for t in z[k]):
        yield "z11 or z22 is late and does not fade at high frequency"
        return
    k = [sum((_slope(t) for t in terms if not t.delay), Fraction(0)) for terms in z]
    late = [sum((abs(_slope(t)) for t in terms if t.delay), Fraction(0)) for terms in z]
    crossed = bool(late[1] * (abs(k[2]) + late[2]) or late[2] * abs(k[1]))
    if (
        crossed
        or (criterion == "passive" and (late[1] or late[2]))
        or not _holds_exactly(k, criterion)
    ):
        yield "the growth like s at high frequency does not meet the criterion"
        return
    if not _fades(z, criterion):
        yield "no bound of the coupling at high frequency was found"


def _slope(term: Late) -> Fraction:
    p, q = term.ratio
    return p[-1] / q[-1] if len(p) == len(q) + 1 else Fraction(0)


def _fades(z: Sequence[tuple[Late, ...]], criterion: Criterion) -> bool:
    """Whether Re z11 Re z22 is surely large enough for the coupling as w -> infinity."""
    if not (z[1] and z[2]) and (criterion == "absolutely stable" or not (z[1] or z[2])):
        return True
    if not any(t.delay for k in (1, 2) for t in z[k]):
        return True  # rational couplings: the sweep's end and the residues speak
    diagonal = [_real_far_out(z[k]) for k in (0, 3)]
    if diagonal[0] is None or diagonal[1] is None:
        return False
    power, size = diagonal[0][0] + diagonal[1][0], diagonal[0][1] * diagonal[1][1]
    ends = [_far_size(z[k]) for k in (1, 2)]
    if criterion == "passive":  # abs(z12) + abs(z21) <= 2 (r1 r2)^(1/2)
        top = max(n for n, _ in ends)
        bound = sum(c for n, c in ends if n == top) ** 2 / 4
        return power > 2 * top or (power == 2 * top and size >= bound)
    top, bound = ends[0][0] + ends[1][0], ends[0][1] * ends[1][1]
    return power > top or (power == top and size >= bound)


def _real_far_out(terms: Sequence[Late]) -> tuple[int, Fraction] | None:
    """(n, c > 0) with Re z ~ c w^n as w -> infinity; None: not known, or not > 0."""
    total: Ratio = ([], [Fraction(1)])
    for t in terms:
        if t.delay:
            return None
        p, q = t.ratio
        total = coprime(add(multiply(total[0], q), multiply(p, total[1])), multiply(total[1], q))
    above, below = real_part(*total), real_part(total[1], total[1])
    if not above or above[-1] < 0:
        return None
    return 2 * (len(above) - len(below)), above[-1] / below[-1]


def _far_size(terms: Sequence[Late]) -> tuple[int, Fraction]:
    """(n, c): as w -> infinity, abs(z) is about c w^n at most."""
    powers = [(len(t.ratio[0]) - len(t.ratio[1]), t.ratio[0][-1] / t.ratio[1][-1]) for t in terms]
    top = max((n for n, _ in powers), default=-(10**6))
    return top, sum((abs(c) for n, c in powers if n == top), Fraction(0))
