"""Exact positive-real test of an impedance, and its excess of damping.

Z = p/q (coprime, real) is positive real if and only if p + q has all its zeros in the open left
half plane and Re p(j w) conj q(j w) >= 0 for every w: then (Z - 1)/(Z + 1) is bounded real. The
test covers improper impedances such as m s + b, and poles on the imaginary axis, without separate
conditions.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp

from ...derive.polynomials import (
    X,
    even_part,
    has_positive_root,
    is_hurwitz,
    is_non_negative,
    positive_roots,
    value,
)
from ..claims.certificate import positive_real_certificate
from ..claims.claim import Claim, Refutation, Unknown, prove_by_certificate
from ..search.growing_wave import GrowingWave, growing_wave
from .family import explain_unseen, unseen_modes
from .impedance import Impedance, MotionKind, exact, gaussian, impedance

#: relative change of a coefficient that may be rounding: some operations on floats, 2^-53 each
NEARBY = 2.0**-50


#: the reason of an unknown claim, where the test fails and no wave is resolved in double precision
NO_WAVE = "the positive-real test fails, but no wave that takes energy out was found"


def is_positive_real(z: Impedance) -> bool:
    """Whether Z is positive real, decided exactly; Re Z(j w) = 0 is allowed."""
    total = z.p + z.q
    if total.is_zero or not is_hurwitz(total):
        return False
    return is_non_negative(even_part(z.p, z.q))


def positive_real(system: Any, *, motion: MotionKind = "velocity") -> Claim:
    """Is this impedance passive: does it never release more energy than it took in?

    system, motion: see `impedance`
    returns: proved, with the excess of damping as margin (N s/m: the damping that could be taken
        away); exact evidence where a certificate would ask for more work than its checker does
        (from degree 25 on); or refuted by a growing wave. Unknown where a mode of a python-control
        system that its port does not show does not decay, where the sign of the wave rests on the
        last digits of floats, or where the wave releases so little energy that a replay in double
        precision does not show it
    raises ModelError: not a rational function of s with known coefficients
    """
    z = impedance(system, motion=motion)
    statement = f"Z(s) = {z} is passive at its port (force, velocity)"
    if not is_positive_real(z):
        wave = growing_wave(z)
        if wave is None:
            return Claim(statement, Unknown(NO_WAVE))
        if is_rounded(system) and _rests_on_rounding(z, wave):
            why = (
                f"it fails, but a relative change of coefficients by {NEARBY:.1g} decides: rounding"
            )
            return Claim(statement, Unknown(why))
        w, a = float(wave.frequency), float(wave.rate)
        method = (
            f"Re Z = {wave.value[0, 0].real:.4g} N s/m at s = {a:.4g} + {w:.4g} j, a growing wave"
        )
        return Claim(statement, Refutation(method, wave))
    if modes := unseen_modes(system):
        return Claim(statement, Unknown(explain_unseen(modes)))
    margin = damping_excess(z)
    verdict = prove_by_certificate(
        "the positive-real test",
        lambda: positive_real_certificate(statement, [[z.expression]]),
        float(margin.lower),
        "N s/m",
        _equality(z, margin),
    )
    return Claim(statement, verdict)


def is_rounded(system: Any) -> bool:
    """Whether a system contains floats, which earlier operations may have rounded."""
    if isinstance(system, Impedance):
        return False
    return hasattr(system, "isdtime") or bool(sp.sympify(system).atoms(sp.Float))


def _rests_on_rounding(z: Impedance, wave: GrowingWave) -> bool:
    """Whether Re Z at the wave may change its sign if each coefficient changes by NEARBY.

    To first order abs(dZ) <= NEARBY (sum abs(p_k s^k) + abs(Z) sum abs(q_k s^k))/abs(q).
    """
    s = wave.s
    above, below = (
        sum(abs(float(c)) * abs(s) ** k for (k,), c in part.terms()) for part in (z.p, z.q)
    )
    value = complex(wave.value[0, 0])
    size = abs(complex(*map(float, gaussian(z.q, wave.rate, wave.frequency))))
    return bool(abs(value.real) * size <= NEARBY * (above + abs(value) * below))


def _equality(z: Impedance, margin: Excess) -> str:
    """Text that says where Re Z = 0 on the axis, decided exactly; "" where nowhere."""
    real, size = real_part(z)
    if real.is_zero:
        return "at every frequency: it stores, and loses nothing"
    if real.eval(0) == 0 or has_positive_root(real.sqf_part()):
        return f"at {margin.frequency:.4g} rad/s"
    return "in the limit of high frequency" if real.degree() < size.degree() else ""


@dataclass(frozen=True)
class Excess:
    """Excess of passivity: the largest c for which Z - c is still passive; negative: a shortage.

    lower, upper: exact bounds of c; both -inf where no damping at the port helps (a pole that
        grows, a double pole on the axis)
    frequency: rad/s, at which Re Z is smallest; inf where this is the limit of high frequency
    """

    lower: Fraction | float
    upper: Fraction | float
    frequency: float

    def __float__(self) -> float:
        return float(self.lower)


def damping_excess(system: Any, *, motion: MotionKind = "velocity") -> Excess:
    """Excess of damping of an impedance, N s/m; < 0: the damping that the impedance lacks.

    This is the infimum of Re Z over frequency (the index of input passivity, with the velocity as
    input), or -inf. The exact test verifies its bounds. They differ by 1e-12 of its size; where the
    test does not confirm bounds so narrow, by up to 2e-6.

    system, motion: see `impedance`;  raises ModelError: no impedance
    """
    z = impedance(system, motion=motion)
    at, lowest = _infimum(*real_part(z))
    lower, upper = _verify_bounds(z, lowest)
    return Excess(lower, upper, float(np.sqrt(at)))


def mobility_excess(system: Any, *, motion: MotionKind = "velocity") -> Excess:
    """Excess of the mobility 1/Z, m/(N s): the index of output passivity.

    system, motion: see `impedance`
    returns: the largest c for which 1/Z - c is still passive; < 0: a shortage; +inf where Z = 0
    raises ModelError: no impedance
    """
    z = impedance(system, motion=motion)
    if z.p.is_zero:
        return Excess(float("inf"), float("inf"), 0.0)
    lead = z.p.LC()
    return damping_excess(Impedance(z.q.quo_ground(lead), z.p.quo_ground(lead)))


def _infimum(real: sp.Poly, size: sp.Poly) -> tuple[float, float]:
    """(x, value) at the infimum of real/size over x >= 0, in floating point.

    x is inf where the infimum is the limit of high frequency.
    """
    slope = real.diff(X) * size - real * size.diff(X)
    extremes = []
    for x in (Fraction(0), *positive_roots(slope)):
        below = value(size, x)
        if below != 0:
            extremes.append((float(x), float(value(real, x) / below)))
    if real.degree() <= size.degree():
        limit = real.LC() / size.LC() if real.degree() == size.degree() else 0
        extremes.append((float("inf"), float(limit)))
    elif real.LC() < 0:
        extremes.append((float("inf"), float("-inf")))
    return min(extremes, key=lambda pair: pair[1]) if extremes else (0.0, float("-inf"))


def _verify_bounds(z: Impedance, lowest: float) -> tuple[Fraction | float, Fraction | float]:
    """Bounds c- and c+ near `lowest`, by the exact test: Z - c- is passive, Z - c+ is not.

    Both are -inf where no such bounds are close to `lowest`.
    """
    infinite = float("-inf"), float("-inf")
    if not np.isfinite(lowest):
        return infinite
    middle = Fraction(str(exact(lowest)))
    if _passive_without(z, middle) and not _passive_without(z, middle + _step(middle, 1e-12)):
        return middle, middle + _step(middle, 1e-12)
    for relative in (1e-12, 1e-9, 1e-6):
        step = _step(middle, relative)
        if _passive_without(z, middle - step):
            upper = middle if not _passive_without(z, middle) else middle + step
            return middle - step, upper
    return infinite


def _step(middle: Fraction, relative: float) -> Fraction:
    return abs(middle) * Fraction(relative) or Fraction(relative) ** 2


def _passive_without(z: Impedance, c: Fraction) -> bool:
    p = z.p - z.q.mul_ground(sp.Rational(c.numerator, c.denominator))
    return is_positive_real(Impedance(p, z.q))


def real_part(z: Impedance) -> tuple[sp.Poly, sp.Poly]:
    """Re Z(j w) as a ratio of coprime polynomials in x = w^2."""
    real, size = even_part(z.p, z.q), even_part(z.q, z.q)
    common = sp.gcd(real, size)
    return real.quo(common), size.quo(common)
