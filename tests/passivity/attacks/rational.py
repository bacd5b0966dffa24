"""Random rational impedances, and attackers that look at the whole open right half plane.

Polynomials are lists of fractions, highest power first; nothing is cancelled by the attackers.
"""

from fractions import Fraction

import mpmath
import numpy as np
import sympy as sp

SYMBOL = sp.Symbol("s")

KINDS = (
    "passive parts",
    "passive parts less some damping",
    "lossless",
    "lossless and lossy poles on the axis",
    "a residue of the wrong sign",
    "multiple poles on the axis",
    "multiple poles that decay",
    "a pole that grows",
    "a pole that grows, nearly cancelled",
    "a pole that grows, cancelled",
    "improper",
    "any",
)


def times(*factors):
    """Product of polynomials."""
    total = [Fraction(1)]
    for p in factors:
        out = [Fraction(0)] * (len(total) + len(p) - 1)
        for i, a in enumerate(total):
            for j, b in enumerate(p):
                out[i + j] += a * b
        total = out
    return total


def plus(a, b, factor=1):
    """a + factor b."""
    n = max(len(a), len(b))
    a, b = ([Fraction(0)] * (n - len(p)) + list(p) for p in (a, b))
    return [x + factor * y for x, y in zip(a, b, strict=True)]


def added(z, other):
    """Sum of two ratios (p, q)."""
    return plus(times(z[0], other[1]), times(other[0], z[1])), times(z[1], other[1])


def number(rng, decades=1):
    """A short fraction, over some decades."""
    x = Fraction(int(rng.integers(1, 10)), int(rng.integers(1, 10)))
    return x * Fraction(10) ** int(rng.integers(-decades + 1, decades))


def part(rng, *, lossy):
    """A passive part: damper, mass, spring, held mass, lossy ones."""
    a, b, c = (number(rng) for _ in range(3))
    plain = [([a, 0], [1]), ([a], [1, 0]), ([a, 0], [1, 0, b])]
    if lossy:
        plain += [([a], [1]), ([a], [1, b]), ([a, 0], [1, b]), ([a, 0], [1, b, c])]
    p, q = plain[int(rng.integers(len(plain)))]
    return [Fraction(x) for x in p], [Fraction(x) for x in q]


def parts(rng, most=3, *, lossy=True):
    z = part(rng, lossy=lossy)
    for _ in range(int(rng.integers(0, most))):
        z = added(z, part(rng, lossy=lossy))
    return z


def random_ratio(rng, kind):
    """(p, q) of that kind; in one of four other units of time and size, over twelve decades."""
    p, q = _made(rng, kind)
    if rng.random() < 0.25:
        time, size = (Fraction(10) ** int(k) for k in rng.integers(-6, 7, 2))
        p = [size * c * time ** (len(p) - 1 - k) for k, c in enumerate(p)]
        q = [c * time ** (len(q) - 1 - k) for k, c in enumerate(q)]
    return p, q


def _made(rng, kind):
    one, a, b = [Fraction(1)], number(rng), number(rng)
    square = [Fraction(1), Fraction(0), a]
    if kind == "passive parts":
        return parts(rng)
    if kind == "passive parts less some damping":
        damping = number(rng) * Fraction(1, int(10 ** rng.integers(0, 9)))
        return added(parts(rng), ([-damping], one))
    if kind == "lossless":
        return parts(rng, 4, lossy=False)
    if kind == "lossless and lossy poles on the axis":
        tilt = Fraction(int(rng.integers(-1, 2)), int(10 ** rng.integers(0, 9)))
        return added(parts(rng), ([b, tilt], square))  # tilt != 0: a residue that is not real
    if kind == "a residue of the wrong sign":
        small = Fraction(1, int(10 ** rng.integers(0, 9)))
        q = [square, [Fraction(1), Fraction(0)], one][int(rng.integers(3))]
        p = [-b * small] if len(q) == 2 else [-b * small, Fraction(0)]
        return added(parts(rng), (p, q))
    if kind == "multiple poles on the axis":
        q = [square, [Fraction(1), Fraction(0)]][int(rng.integers(2))]
        return added(parts(rng), ([b, number(rng)], times(q, q)))
    if kind == "multiple poles that decay":
        q = times(*[[Fraction(1), a]] * int(rng.integers(2, 5)))
        return added(parts(rng), ([b * int(rng.choice([-1, 1])), number(rng)], q))
    if kind.startswith("a pole that grows"):
        slow = number(rng) * Fraction(1, int(10 ** rng.integers(0, 7)))
        grows = [Fraction(1), -slow]
        if rng.random() < 0.5:
            grows = [Fraction(1), -slow, a]
        near = {"a pole that grows": 2, "a pole that grows, nearly cancelled": 1}.get(kind, 0)
        if near == 2:
            return added(parts(rng), ([b], grows))
        beside = [*grows[:-1], grows[-1] * (1 + near * Fraction(1, int(10 ** rng.integers(3, 13))))]
        p, q = parts(rng)
        return times(p, beside), times(q, grows)
    if kind == "improper":
        z = parts(rng)
        return added(
            z, ([b * int(rng.choice([-1, 1])), *[Fraction(0)] * int(rng.integers(1, 4))], one)
        )
    n = int(rng.integers(1, 5))
    q = times(*[[Fraction(1), number(rng)] for _ in range(n)])
    return [Fraction(int(rng.integers(-2, 9))) for _ in range(n + 1)], q


def expression(p, q):
    """The ratio as sympy writes it."""
    above, below = (
        sum(sp.Rational(c) * SYMBOL ** (len(x) - 1 - k) for k, c in enumerate(x)) for x in (p, q)
    )
    return above / below


def at(ratio, s):
    """Value at s, to the digits of mpmath."""
    p, q = ([mpmath.mpf(c.numerator) / c.denominator for c in x] for x in ratio)
    return mpmath.polyval(p, s) / mpmath.polyval(q, s)


def roots(p):
    """In double precision, of either end first where it is badly scaled; those of 0 left out."""
    p = np.array([float(c) for c in p])
    p = np.trim_zeros(p)
    if len(p) < 2 or not np.all(np.isfinite(p)):
        return np.zeros(0)
    return np.roots(p)


def suspects(polynomials, rng, number=1500):
    """Points of the open right half plane beside roots, beside the axis, far out and anywhere."""
    places = np.concatenate([np.zeros(0, complex), *(roots(p) for p in polynomials)])
    places = places[np.abs(places) > 0]
    sizes = np.abs(places) if len(places) else np.ones(1)
    near = places[:, None] + np.abs(places)[:, None] * (
        10.0 ** rng.uniform(-14, 0, (1, 60)) * np.exp(2j * np.pi * rng.random((1, 60)))
    )
    w = np.exp(rng.uniform(np.log(sizes.min() * 1e-9), np.log(sizes.max() * 1e9), number))
    some = rng.choice(sizes, number) * (
        1 + 10.0 ** rng.uniform(-13, 0.5, number) * rng.choice([-1, 1], number)
    )
    beside = np.abs(np.concatenate([w, some])) * (10.0 ** rng.uniform(-13, 0, 2 * number) + 1j)
    real = w[: number // 4].astype(complex)
    points = np.concatenate([near.ravel(), beside, real])
    points = np.where(points.imag < 0, points.conj(), points)
    return points[(points.real > 0) & np.isfinite(points)]


def values(ratio, s):
    """In double precision, (n,)."""
    with np.errstate(all="ignore"):
        p, q = (np.polyval([float(c) for c in x], s) for x in ratio)
        return p / q
