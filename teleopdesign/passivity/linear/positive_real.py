"""Positive-real test of an impedance, exact.

Z = p/q (coprime, real) is positive real iff p + q has all its zeros in the open left half plane and
Re p(j w) conj q(j w) >= 0 for every w: then (Z - 1)/(Z + 1) is bounded real. This covers improper
impedances such as m s + b, and poles on the imaginary axis, without a separate condition.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp

from ..claims.certificate import positive_real_certificate
from ..claims.claim import Claim, Refutation, Unknown, prove_by_certificate
from ..search.growing_wave import GrowingWave, growing_wave
from .hidden_modes import UNSEEN, grows_unseen
from .impedance import Impedance, MotionKind, exact, gaussian, impedance
from .polynomials import (
    X,
    even_part,
    has_positive_root,
    is_hurwitz,
    is_non_negative,
    positive_roots,
    value,
)

#: relative; coefficients are known no better than some operations on floats leave them, 2^-53 each
NEARBY = 2.0**-50


#: why nothing is said of an impedance whose waves all leave double precision
NO_WAVE = "the positive-real test fails, but no wave that takes energy out was found"


def is_positive_real(z: Impedance) -> bool:
    """Whether Z is positive real, exactly; equality Re Z(j w) = 0 allowed."""
    total = z.p + z.q
    if total.is_zero or not is_hurwitz(total):
        return False
    return is_non_negative(even_part(z.p, z.q))


def positive_real(system: Any, *, motion: MotionKind = "velocity") -> Claim:
    """Is this impedance passive: does it never release more energy than it took in?

    system, motion: see `impedance`
    returns: proved, with the excess of damping as margin (N s/m: what could be taken away); exact
    evidence where the certificate asks for more work than its checker does (from degree 25 on); or
    refuted by a growing wave; unknown where a mode of a python-control system grows that its port
    does not show, where floats came in and the wave's sign rests on their last digits, or where so
    little comes out that a replay in double precision does not show it
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
    if grows_unseen(system):
        return Claim(statement, Unknown(UNSEEN))
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
    """Whether a system is stated in floats, which operations on them have rounded."""
    if isinstance(system, Impedance):
        return False
    return hasattr(system, "isdtime") or bool(sp.sympify(system).atoms(sp.Float))


def _rests_on_rounding(z: Impedance, wave: GrowingWave) -> bool:
    """Whether Re Z at the wave may turn its sign where each coefficient changes by NEARBY.

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
    """Where Re Z = 0, decided exactly."""
    real, size = real_part(z)
    if real.is_zero:
        return "at every frequency: it stores, and loses nothing"
    if real.eval(0) == 0 or has_positive_root(real.sqf_part()):
        return f"at {margin.frequency:.4g} rad/s"
    return "in the limit of high frequency" if real.degree() < size.degree() else ""


@dataclass(frozen=True)
class Excess:
    """Largest c for which Z - c is still passive, within exact bounds; negative: a shortage.

    frequency: rad/s, where the real part is smallest; inf where that is the limit. lower = upper =
    -inf where no damping at the port helps (a pole that grows, a double pole on the axis).
    """

    lower: Fraction | float
    upper: Fraction | float
    frequency: float

    def __float__(self) -> float:
        return float(self.lower)


def damping_excess(system: Any, *, motion: MotionKind = "velocity") -> Excess:
    """Excess of damping of a passive impedance, N s/m; < 0: damping that it lacks.

    This is the infimum of Re Z over frequency (the index of input passivity, velocity being the
    input), or -inf. Its bounds are verified by the exact test and differ by 1e-12 of its size.
    """
    z = impedance(system, motion=motion)
    at, lowest = _infimum(*real_part(z))
    lower, upper = _verify_bounds(z, lowest)
    return Excess(lower, upper, float(np.sqrt(at)))


def mobility_excess(system: Any, *, motion: MotionKind = "velocity") -> Excess:
    """Excess of the mobility 1/Z, m/(N s): index of output passivity; +inf where Z = 0.

    system: an impedance as `positive_real` takes it;  motion: what Z divides the force by
    returns: the largest c for which 1/Z - c is still passive; < 0: that much is missing
    """
    z = impedance(system, motion=motion)
    if z.p.is_zero:
        return Excess(float("inf"), float("inf"), 0.0)
    lead = z.p.LC()
    return damping_excess(Impedance(z.q.quo_ground(lead), z.p.quo_ground(lead)))


def _infimum(real: sp.Poly, size: sp.Poly) -> tuple[float, float]:
    """(x, value) where real/size is smallest over x >= 0, to rounding; inf for a limit."""
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
    """Bounds c- <= lowest <= c+ with Z - c- passive and Z - c+ not, by the exact test."""
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
