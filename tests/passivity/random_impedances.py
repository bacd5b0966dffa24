"""Random impedances of every kind that the tests of passivity must judge rightly."""

from fractions import Fraction

import numpy as np
import sympy as sp

from teleopdesign.realise.lti import S

KINDS = (
    "sum of passive parts",
    "less some damping",
    "any",
    "improper",
    "poles on the axis",
    "a pole that grows",
    "badly scaled",
)


def random_impedance(rng: np.random.Generator, kind: str) -> sp.Expr:
    """An impedance of that kind, rational with short coefficients."""
    if kind == "sum of passive parts":
        return _passive(rng)
    if kind == "less some damping":
        return _passive(rng) - _number(rng)
    if kind == "improper":
        return _passive(rng) + _number(rng) * S - (_number(rng) / 4 if rng.random() < 0.5 else 0)
    if kind == "poles on the axis":
        w2 = _number(rng) ** 2
        residue = _number(rng) * (1 if rng.random() < 0.7 else -1)
        return _passive(rng) + residue * S / (S**2 + w2) + _number(rng) / S
    if kind == "a pole that grows":
        return _passive(rng) + _number(rng) / (S - _number(rng) / 10)
    if kind == "badly scaled":
        time, size = (sp.Integer(10) ** int(k) for k in rng.integers(-6, 7, 2))
        return size * random_impedance(rng, KINDS[int(rng.integers(0, 4))]).subs(S, S * time)
    n = int(rng.integers(1, 5))
    q = sp.prod([S + _number(rng) for _ in range(n)])
    p = sum(int(rng.integers(-2, 9)) * S**k for k in range(n + 1))
    return p / q


def _passive(rng: np.random.Generator) -> sp.Expr:
    """Dampers, lossy masses and springs in parallel."""
    z = _number(rng) if rng.random() < 0.7 else sp.S(0)
    for _ in range(int(rng.integers(1, 3))):
        c, a, b = (_number(rng) for _ in range(3))
        z += [c / (S + a), c * S / (S + a), c * S / (S**2 + a * S + b)][int(rng.integers(0, 3))]
    return z


def _number(rng: np.random.Generator) -> sp.Rational:
    """Between 1/9 and 9."""
    return sp.Rational(Fraction(int(rng.integers(1, 10)), int(rng.integers(1, 10))))
