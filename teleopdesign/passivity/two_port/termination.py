"""Passive terminations of a port: a damper with a mass and a spring, or a clamp.

The impedance is R + m s + k/s with R, m, k >= 0. At one s of the open right half plane, such a
termination can have every value with abs(arg) <= abs(arg s), and a positive-real function has no
other value there.
"""

from __future__ import annotations

import cmath
from dataclasses import dataclass
from fractions import Fraction

import sympy as sp

from ...realise.lti import S
from ..linear.matrices import Gaussian, round_point, short


@dataclass(frozen=True)
class Termination:
    """A passive termination: damper, mass and spring at a port, or a clamp (no motion).

    damping: N s/m;  inertia: kg;  stiffness: N/m; each >= 0
    raises ValueError: one of them is negative
    """

    damping: Fraction = Fraction(0)
    inertia: Fraction = Fraction(0)
    stiffness: Fraction = Fraction(0)
    clamped: bool = False

    def __post_init__(self) -> None:
        if min(self.damping, self.inertia, self.stiffness) < 0:
            raise ValueError(f"Termination: a negative part is not passive: {self}")

    @property
    def expression(self) -> sp.Expr:
        """Impedance R + m s + k/s (N s/m) as an expression in `realise.lti.S`."""
        r, m, k = (
            sp.Rational(x.numerator, x.denominator)
            for x in (self.damping, self.inertia, self.stiffness)
        )
        return r + m * S + k / S

    def at(self, s: complex) -> complex:
        """Impedance at s, N s/m, in floating point."""
        return float(self.damping) + float(self.inertia) * s + float(self.stiffness) / s

    @property
    def as_plain(self) -> object:
        """Plain data, to be written as JSON."""
        parts = [str(x) for x in (self.damping, self.inertia, self.stiffness)]
        return "clamped" if self.clamped else parts

    def __str__(self) -> str:
        if self.clamped:
            return "clamped"
        parts = (
            (self.damping, "a damper of {:.4g} N s/m"),
            (self.inertia, "a mass of {:.4g} kg"),
            (self.stiffness, "a spring of {:.4g} N/m"),
        )
        shown = [text.format(float(size)) for size, text in parts if size]
        return "held by " + " and ".join(shown) if shown else "free"


CLAMPED = Termination(clamped=True)


def far_termination(s: complex, value: complex) -> Termination:
    """The passive termination that has about that impedance at s; a clamp if it is infinite.

    Its parts are rounded to seven digits, and a negative damper is left out.
    """
    if cmath.isinf(value):
        return CLAMPED
    real, *rest = _parts((Fraction(value.real), Fraction(value.imag)), round_point(s))
    real, inertia, stiffness = (short(x, 7) for x in (max(real, Fraction(0)), *rest))
    return Termination(real, inertia, stiffness)


def with_resonance(held: Termination, at: Gaussian) -> Termination:
    """A termination with the same impedance at s, but half of the damper replaced.

    A mass and a spring replace this half. It serves two-ports of dampers alone: beside an equal and
    opposite damper a damper determines no motion.
    """
    rate, size = at[0], at[0] ** 2 + at[1] ** 2
    mass = held.damping / (4 * rate)
    return Termination(
        held.damping / 2, held.inertia + mass, held.stiffness + mass * size, held.clamped
    )


def velocities_in_phase(
    near: Termination, far: Termination, ratio: complex, s: complex
) -> tuple[complex, complex]:
    """Velocities of both ports at t = 0, m/s, complex; the larger one has the size 1 m/s.

    Their phase is the one in which the terminations take in most energy.

    ratio: velocity of the far port over that of the near port, at s
    """
    size = max(1.0, abs(ratio))
    v = [1 / size, ratio / size]
    if s.imag == 0:
        return complex(v[0]), complex(v[1].real)
    total = near.at(s) * v[0] ** 2 + (0 if far.clamped else far.at(s) * v[1] ** 2)
    turn = cmath.exp(-0.5j * cmath.phase(total / s)) if total else 1
    return v[0] * turn, v[1] * turn


def termination_of(wanted: Gaussian, at: Gaussian) -> Termination | None:
    """The damper with a mass or a spring whose impedance at s is `wanted`.

    returns: None where no passive one has this impedance
    """
    real, inertia, stiffness = _parts(wanted, at)
    if real < 0 or (wanted[1] != 0 and at[1] == 0):
        return None
    return Termination(real, inertia, stiffness)


def _parts(wanted: Gaussian, at: Gaussian) -> tuple[Fraction, Fraction, Fraction]:
    """Damper (may be negative), mass and spring whose impedance at s is `wanted`."""
    (real, imaginary), (rate, frequency) = wanted, at
    none = Fraction(0)
    if imaginary == 0 or frequency == 0:
        return real, none, none
    if imaginary > 0:
        inertia = imaginary / frequency
        return real - inertia * rate, inertia, none
    stiffness = -imaginary * (rate**2 + frequency**2) / frequency
    return real + imaginary * rate / frequency, none, stiffness


def exact_value(held: Termination, at: Gaussian) -> Gaussian:
    """Impedance R + m s + k/s of a termination at s, exactly."""
    size = at[0] ** 2 + at[1] ** 2
    m, k = held.inertia, held.stiffness
    return held.damping + m * at[0] + k * at[0] / size, m * at[1] - k * at[1] / size
