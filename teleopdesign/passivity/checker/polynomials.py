"""Polynomials of one variable as lists of Fractions, lowest power first, without any library.

The zero polynomial is []. Each product takes from `left`, the effort that is left.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from math import gcd, lcm

from .effort import spend

Polynomial = list[Fraction]
#: a prime: polynomials that are coprime modulo this prime are coprime
_PRIME = 2**61 - 1
_ONE = (Fraction(1),)


def polynomial(coefficients: Iterable[Fraction | int]) -> Polynomial:
    """A polynomial from its coefficients, lowest power first, without leading zeros."""
    p = [Fraction(c) for c in coefficients]
    while p and p[-1] == 0:
        p.pop()
    return p


def coefficient_list(powers: Mapping[tuple[int, ...], Fraction]) -> Polynomial:
    """A polynomial from a mapping (power,) -> coefficient."""
    highest = max(powers, default=(-1,))[0]
    return polynomial(powers.get((k,), Fraction(0)) for k in range(highest + 1))


def divide(p: Polynomial, q: Polynomial, left: list[int]) -> tuple[Polynomial, Polynomial]:
    """(quotient, remainder) of p over q; q: not zero."""
    rest, quotient = list(p), [Fraction(0)] * max(len(p) - len(q) + 1, 0)
    for k in range(len(p) - len(q), -1, -1):
        ratio = quotient[k] = rest[k + len(q) - 1] / q[-1]
        if ratio:
            spend(left, len(q), [ratio], q)
            for i, b in enumerate(q):
                rest[k + i] -= ratio * b
    return polynomial(quotient), polynomial(rest[: len(q) - 1])


def small(p: Polynomial, left: list[int]) -> Polynomial:
    """p times a positive number that makes all coefficients coprime integers; signs remain."""
    if not p:
        return p
    spend(left, len(p), p, p)
    below = lcm(*(c.denominator for c in p))
    whole = [(c * below).numerator for c in p]
    common = gcd(*whole) or 1
    return [Fraction(c // common) for c in whole]


def greatest_common_divisor(p: Polynomial, q: Polynomial, left: list[int]) -> Polynomial:
    """Greatest common divisor, monic, by Euclid's scheme; [] where both are zero."""
    if p and q and _are_surely_coprime(p, q, left):
        return [Fraction(1)]
    while q:
        p, q = q, small(divide(p, q, left)[1], left)
    return [c / p[-1] for c in p]


def derivative(p: Polynomial) -> Polynomial:
    """dp/ds."""
    return polynomial(k * c for k, c in enumerate(p) if k)


def is_hurwitz(p: Polynomial, left: list[int]) -> bool:
    """Whether every root has a negative real part (Routh); False for the zero polynomial."""
    if not p:
        return False
    falling = [c / p[-1] for c in reversed(p)]
    upper, lower = small(falling[::2], left), small(falling[1::2], left)
    for _ in falling[1:]:
        if not lower or lower[0] <= 0:
            return False
        spend(left, 2 * len(upper), upper, lower)
        below = lower + [Fraction(0)] * (len(upper) - len(lower))
        first, next_first = upper[0], lower[0]  # each row times a number > 0: the same signs
        rest = [next_first * u - first * v for u, v in zip(upper[1:], below[1:], strict=True)]
        upper, lower = lower, small(rest, left)
    return True


def square_free(p: Polynomial, left: list[int]) -> Polynomial:
    """The polynomial with the same roots, each once."""
    if len(p) < 2:
        return p
    return divide(p, greatest_common_divisor(p, derivative(p), left), left)[0]


def odd_part(p: Polynomial, left: list[int]) -> Polynomial:
    """The product of (x - root) over the roots of odd multiplicity; p: not zero.

    Those that p has an odd number of times are those of p that p and p' share an even number of
    times.
    """
    if len(p) < 2:
        return [Fraction(1)]
    common = greatest_common_divisor(p, derivative(p), left)
    plain = divide(p, common, left)[0]
    return divide([c / plain[-1] for c in plain], odd_part(common, left), left)[0]


def _are_surely_coprime(p: Sequence[Fraction], q: Sequence[Fraction], left: list[int]) -> bool:
    """Whether p and q are shown to have no common factor, by a computation modulo a prime.

    A common factor of polynomials with whole coefficients keeps its degree modulo a prime that does
    not divide the leading coefficients. The answer False shows nothing.
    """
    spend(left, len(p) * len(q), _ONE, _ONE)
    a, b = _modulo_prime(p), _modulo_prime(q)
    if not (a and b and a[-1] and b[-1]):
        return False
    while b:
        inverse = pow(b[-1], -1, _PRIME)
        while len(a) >= len(b):
            ratio, start = a[-1] * inverse % _PRIME, len(a) - len(b)
            for k, c in enumerate(b):
                a[start + k] = (a[start + k] - ratio * c) % _PRIME
            while a and not a[-1]:
                a.pop()
        a, b = b, a
    return len(a) == 1


def _modulo_prime(p: Sequence[Fraction]) -> list[int]:
    """Coefficients of a multiple of p that has whole coefficients, modulo the prime."""
    below = lcm(*(c.denominator for c in p))
    return [(c.numerator * (below // c.denominator)) % _PRIME for c in p]
