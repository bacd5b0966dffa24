"""Polynomials as lists of Fractions, lowest power first: exact answers without any library.

The zero polynomial is []. On the imaginary axis s = j w, real and imaginary parts of a polynomial
in s are polynomials in x = w^2 (the imaginary part times w). Inside `effort.bound_effort` each
product takes from a bounded effort.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from math import gcd, lcm

from .effort import spend
from .positive_roots import are_surely_coprime, has_positive_root, variations

Polynomial = list[Fraction]
#: relative error of a root in a text for people; no decision depends on it
_SHOWN = Fraction(1, 10**4)


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


def add(p: Polynomial, q: Polynomial, factor: Fraction | int = 1) -> Polynomial:
    """p + factor q."""
    n = max(len(p), len(q))
    padded = (r + [Fraction(0)] * (n - len(r)) for r in (p, q))
    return polynomial(a + factor * b for a, b in zip(*padded, strict=True))


def multiply(*factors: Polynomial) -> Polynomial:
    """The product of all factors."""
    product = [Fraction(1)]
    for q in factors:
        spend(len(product) * len(q), product, q)
        sums = [Fraction(0)] * max(len(product) + len(q) - 1, 0)
        for i, a in enumerate(product):
            for j, b in enumerate(q):
                sums[i + j] += a * b
        product = polynomial(sums)
    return product


def divide(p: Polynomial, q: Polynomial) -> tuple[Polynomial, Polynomial]:
    """(quotient, remainder) of p over q; q: not zero."""
    rest, quotient = list(p), [Fraction(0)] * max(len(p) - len(q) + 1, 0)
    for k in range(len(p) - len(q), -1, -1):
        ratio = quotient[k] = rest[k + len(q) - 1] / q[-1]
        if ratio:
            spend(len(q), [ratio], q)
            for i, b in enumerate(q):
                rest[k + i] -= ratio * b
    return polynomial(quotient), polynomial(rest[: len(q) - 1])


def small(p: Polynomial) -> Polynomial:
    """p times a positive number that makes all coefficients coprime integers; signs remain."""
    if not p:
        return p
    spend(len(p), p, p)
    below = lcm(*(c.denominator for c in p))
    whole = [(c * below).numerator for c in p]
    common = gcd(*whole) or 1
    return [Fraction(c // common) for c in whole]


def greatest_common_divisor(p: Polynomial, q: Polynomial) -> Polynomial:
    """Greatest common divisor, monic, by Euclid's scheme; [] where both are zero."""
    if p and q and are_surely_coprime(p, q):
        return [Fraction(1)]
    while q:
        p, q = q, small(divide(p, q)[1])
    return [c / p[-1] for c in p]


def derivative(p: Polynomial) -> Polynomial:
    """dp/ds."""
    return polynomial(k * c for k, c in enumerate(p) if k)


def value(p: Polynomial, at: Fraction | int) -> Fraction:
    """p at a rational point."""
    total = Fraction(0)
    spend(len(p) * len(p), p, [Fraction(at)])
    for c in reversed(p):
        total = total * at + c
    return total


def halves(p: Polynomial) -> tuple[Polynomial, Polynomial]:
    """(a, b) with p(j w) = a(w^2) + j w b(w^2)."""
    even, odd = (polynomial((-1) ** k * c for k, c in enumerate(p[start::2])) for start in (0, 1))
    return even, odd


def real_part(p: Polynomial, q: Polynomial) -> Polynomial:
    """Re p(j w) conj q(j w), in x = w^2."""
    (a, b), (c, d) = halves(p), halves(q)
    return add(multiply(a, c), [Fraction(0), *multiply(b, d)] if b and d else [])


def is_hurwitz(p: Polynomial) -> bool:
    """Whether every root has a negative real part (Routh); False for the zero polynomial."""
    if not p:
        return False
    falling = [c / p[-1] for c in reversed(p)]
    upper, lower = small(falling[::2]), small(falling[1::2])
    for _ in falling[1:]:
        if not lower or lower[0] <= 0:
            return False
        spend(2 * len(upper), upper, lower)
        below = lower + [Fraction(0)] * (len(upper) - len(lower))
        first, next_first = upper[0], lower[0]  # each row times a number > 0: the same signs
        rest = [next_first * u - first * v for u, v in zip(upper[1:], below[1:], strict=True)]
        upper, lower = lower, small(rest)
    return True


def is_positive_real(p: Polynomial, q: Polynomial) -> bool:
    """Whether p/q, coprime, is positive real: p + q is Hurwitz, and Re p conj q >= 0 on the axis.

    Then (p - q)/(p + q) is bounded by 1 in the right half plane. Improper p/q are allowed.
    """
    return is_hurwitz(add(p, q)) and is_non_negative(real_part(p, q))


def is_free_of_growth(q: Polynomial) -> bool:
    """Whether no root of q lies in the open right half plane.

    With each root counted once, this is so if and only if q'/q is positive real. q'/q is the sum of
    1/(s - root), and on the axis the real part of such a term has the sign of -Re root.
    """
    plain = square_free(q)
    return len(plain) < 2 or is_positive_real(derivative(plain), plain)


def square_free(p: Polynomial) -> Polynomial:
    """The polynomial with the same roots, each once."""
    if len(p) < 2:
        return p
    return divide(p, greatest_common_divisor(p, derivative(p)))[0]


def odd_part(p: Polynomial) -> Polynomial:
    """The product of (x - root) over the roots of odd multiplicity (Yun's scheme); p: not zero."""
    product = [Fraction(1)]
    common = greatest_common_divisor(p, derivative(p)) if len(p) > 1 else [Fraction(1)]
    rest, slope = divide(p, common)[0], divide(derivative(p), common)[0]
    slope, multiplicity = add(slope, derivative(rest), -1), 1
    while len(rest) > 1:
        factor = greatest_common_divisor(rest, slope)
        if multiplicity % 2:
            product = multiply(product, factor)
        rest, slope = divide(rest, factor)[0], divide(slope, factor)[0]
        slope, multiplicity = add(slope, derivative(rest), -1), multiplicity + 1
    return product


def is_non_negative(p: Polynomial) -> bool:
    """Whether p(x) >= 0 for x >= 0: no root of odd multiplicity at x > 0, and p > 0 for large x."""
    if not p:
        return True
    g = without_zero(odd_part(p))
    return p[-1] > 0 and (len(g) < 2 or not has_positive_root(g))


def without_zero(p: Polynomial) -> Polynomial:
    """p without its roots at 0."""
    start = next((k for k, c in enumerate(p) if c), len(p))
    return p[start:]


def signs_at_roots(f: Polynomial, g: Polynomial) -> tuple[int, int, int]:
    """How many roots x > 0 of g (each counted once) have f < 0, f = 0 and f > 0.

    By the theorem of Sturm and Tarski: the sign changes of the signed remainders of (g, g' f) at
    the two ends differ by the number of roots with f > 0 less the number with f < 0.
    """
    surplus, nonzero, total = (_surplus(chain, None) for chain in _chains(f, g))
    return (nonzero - surplus) // 2, total - nonzero, (nonzero + surplus) // 2


def _chains(f: Polynomial, g: Polynomial) -> list[list[Polynomial]]:
    """Chains of remainders that sum the signs of f, f^2 and 1 over the positive roots of g."""
    g = square_free(without_zero(g))
    if len(g) < 2:
        return [[], [], []]
    f = divide(f, g)[1]
    return [_chain(h, g) for h in (f, divide(multiply(f, f), g)[1], [Fraction(1)])]


def _chain(f: Polynomial, g: Polynomial) -> list[Polynomial]:
    """Signed remainders of (g, g' f); g: g(0) != 0, simple roots, not constant."""
    chain = [small(g), small(divide(multiply(derivative(g), f), g)[1])]
    while chain[-1]:
        chain.append(small([-c for c in divide(chain[-2], chain[-1])[1]]))
    return chain[:-1]


def _surplus(chain: list[Polynomial], below: Fraction | None) -> int:
    """Sum of the signs of f over the roots of g with 0 < x < below; below None: all x > 0."""
    at_end = [p[-1] if below is None else value(p, below) for p in chain]
    return variations([p[0] for p in chain]) - variations(at_end)


def first_root(f: Polynomial, g: Polynomial) -> float:
    """The least root x > 0 of g at which f < 0, approximate, for texts; NaN where there is none."""
    chains = _chains(f, g)[:2]

    def lies_below(x: Fraction | None) -> bool:
        while x is not None and value(g, x) == 0:  # the chains count between roots, not at one
            x *= 1 + _SHOWN / 16
        surplus, nonzero = (_surplus(chain, x) for chain in chains)
        return nonzero > surplus

    if not lies_below(None):
        return float("nan")
    low = Fraction(1)
    while not lies_below(2 * low):
        low *= 2
    while lies_below(low):
        low /= 2
    high = 2 * low
    while high - low > _SHOWN * high:
        middle = (low + high) / 2
        low, high = (low, middle) if lies_below(middle) else (middle, high)
    return float(high)
