"""Whether a polynomial has a positive root, and whether two polynomials are coprime; exact, cheap.

Rule of Descartes: a polynomial has as many positive roots as its coefficients change sign, or fewer
by an even number. For the roots with 0 < x < 1 the same holds with the coefficients of
(1 + x)^n p(1/(1 + x)). The interval is halved until each part has no change of sign, so no root, or
some part has an odd number of changes, so a root. If all roots are simple, the halving ends
(Vincent; Collins, Akritas, SYMSAC 1976). Remainders, as in Sturm's chains, would have numbers whose
length grows with the square of the degree.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import lcm

from .effort import spend

#: a prime: polynomials that are coprime modulo this prime are coprime
_PRIME = 2**61 - 1
_ONE = (Fraction(1),)


def has_positive_root(p: Sequence[Fraction]) -> bool:
    """Whether p (lowest power first; not constant, simple roots, p(0) != 0) has a root x > 0.

    Cauchy's bound gives k with all roots below 2^k. With x = 2^k t the roots have t < 1.
    """
    changes = variations(p)
    if changes % 2 or not changes:
        return bool(changes)
    below = lcm(*(c.denominator for c in p))
    whole = [(c * below).numerator for c in p]
    lead = abs(whole[-1])
    reach = max(1 + max(abs(c) for c in whole) // lead, 1).bit_length()
    return _has_root_in_unit([c << (reach * k) for k, c in enumerate(whole)])


def _has_root_in_unit(first: list[int]) -> bool:
    """Whether a polynomial of simple roots (lowest power first) has a root with 0 < x < 1."""
    waiting = [first]
    while waiting:
        p = waiting.pop()
        changes = variations(_shift_by_one(p[::-1]))
        if changes % 2:
            return True
        if not changes:
            continue
        n = len(p) - 1
        left = [c << (n - k) for k, c in enumerate(p)]
        right = _shift_by_one(left)
        if right[0] == 0:  # the middle itself
            return True
        waiting += [right, left]
    return False


def _shift_by_one(p: Sequence[int]) -> list[int]:
    """Coefficients of p(x + 1), by additions alone."""
    spend(len(p) * len(p) // 2, (Fraction(max(map(abs, p))),), _ONE)
    p = list(p)
    for start in range(len(p) - 1):
        for k in range(len(p) - 2, start - 1, -1):
            p[k] += p[k + 1]
    return p


def variations(values: Sequence[Fraction] | Sequence[int]) -> int:
    """How often the sign changes along a sequence of numbers; zeros are skipped."""
    signs = [v > 0 for v in values if v]
    return sum(a != b for a, b in zip(signs, signs[1:], strict=False))


def are_surely_coprime(p: Sequence[Fraction], q: Sequence[Fraction]) -> bool:
    """Whether p and q are shown to have no common factor, by a computation modulo a prime.

    A common factor of polynomials with whole coefficients keeps its degree modulo a prime that does
    not divide the leading coefficients. The answer False shows nothing.
    """
    spend(len(p) * len(q), _ONE, _ONE)
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
