"""A growing motion of a two-port between passive terminations: it refutes absolute stability.

    Z(s) V + diag(Z1, Z2) V = 0,   v(t) = Re(V e^(s t)),   s = a + j w,   a > 0

A passive termination of a port is a damper with a mass and a spring, R + m s + k/s with
R, m, k >= 0, or a clamp. At one s of the open right half plane, it can have every value with
abs(arg) <= abs(arg s), and a positive-real function has no other value there. So the search runs
over s and over the value of one termination (`search/points.py`). The other termination is then
-z_in(s), in exact arithmetic. If Z is finite at s and Z + diag(Z1, Z2) is singular there, its
inverse has a pole at s, unless the sum is singular everywhere.
"""

from __future__ import annotations

import cmath
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
import sympy as sp

from ..derive.polynomials import as_poly, is_free_of_growth, roots_of
from ..realise.lti import S
from .linear.conditions import where_it_fails
from .linear.family import Family, family_of_matrix
from .linear.matrices import (
    Gaussian,
    close,
    exact_complex,
    inverse_denominator,
    parts_of,
    rational,
    round_point,
    short,
    value_at,
)
from .rate_independent import AbstractRecord
from .search.growing_wave import last_part
from .search.points import candidates, near_axis, near_poles


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

    def at(self, s: Any, number: Callable[[Fraction], Any] = float) -> Any:
        """Impedance R + m s + k/s at s, N s/m; number: what computes with s, such as a rational."""
        r, m, k = map(number, (self.damping, self.inertia, self.stiffness))
        return r + m * s + k / s

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
    parts = _parts((Fraction(value.real), Fraction(value.imag)), round_point(s))
    damping, inertia, stiffness = (short(max(x, Fraction(0)), 7) for x in parts)
    return Termination(damping, inertia, stiffness)


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


@dataclass(frozen=True)
class GrowingMode(AbstractRecord):
    """A motion of a two-port between passive terminations that grows from near rest.

    impedance: Z (N s/m), rational in s;  terminations: at port 1 and port 2
    rate, frequency: real and imaginary part of s, 1/s and rad/s: a pole of the closed loop, exact
        or rounded
    velocity: V at t = 0 (m/s, complex), one for each port
    """

    impedance: sp.ImmutableMatrix
    terminations: tuple[Termination, Termination]
    rate: Fraction
    frequency: Fraction
    velocity: tuple[complex, complex]
    kind = "growing mode"

    @property
    def s(self) -> complex:
        """rate + j frequency, 1/s."""
        return complex(float(self.rate), float(self.frequency))

    @property
    def energy(self) -> float:
        """Energy that both terminations together have taken in up to t = 0, J, in closed form."""
        total = 0.0
        for held, v in zip(self.terminations, self.velocity, strict=True):
            z = 0.0 if held.clamped else held.at(self.s)
            total += (z * abs(v) ** 2).real / self.s.real + (z * v * v / self.s).real
        return total / 4

    def replay(self) -> float:
        """The same energy, J, from the integral of force times velocity of each termination.

        The integral covers the last twelve time constants, or the last LONGEST periods if they are
        shorter. In the second case the result is smaller than `energy`.
        """
        t, weights = last_part(self.s)
        wave, total = np.exp(self.s * t), 0.0
        for held, v in zip(self.terminations, self.velocity, strict=True):
            if not held.clamped:
                power = (held.at(self.s) * v * wave).real * (v * wave).real
                total += float(weights @ power)
        return total

    def is_confirmed(self) -> bool:
        """Whether the closed loop has a pole in the open right half plane, exactly (Routh)."""
        family = family_of_matrix(self.impedance)
        free = [k for k, held in enumerate(self.terminations) if not held.clamped]
        if not free:
            return False
        s, d = family.d.ring.gens[0], family.d
        rows = [[family.n[i][j] * s for j in free] for i in free]
        for row, k in zip(range(len(free)), free, strict=True):
            held = self.terminations[k]  # R + m s + k/s, times s
            parts = enumerate((held.stiffness, held.damping, held.inertia))
            times_s = {(power,): rational(x) for power, x in parts if x}
            rows[row][row] += d * d.ring(times_s)
        q = inverse_denominator(rows, d * s)
        return bool(q) and not is_free_of_growth(as_poly(q, S))


def growing_mode(family: Family) -> GrowingMode | None:
    """Search for passive terminations between which a two-port grows.

    family: 2 x 2, without dead times and values
    returns: a motion that is confirmed exactly; None where the search has no result
    """
    return _search_points(family) or _search_between_dampers(family)


def _search_points(family: Family) -> GrowingMode | None:
    """A mode at one of the points of the right half plane at which growth is most likely."""
    places = where_it_fails(family, "absolutely stable")
    negative = [float(x) ** 0.5 / (2 * np.pi) for x in places]
    steps = (*range(1, 34, 2), *range(35, 68, 4))
    points = np.concatenate([near_axis(negative, steps), near_poles(family)])
    for s, second, turned in candidates(family, points):
        mode = _mode_at(family, round_point(s), far_termination(s, second), turned)
        if mode is not None:
            return mode
    return None


def _search_between_dampers(family: Family) -> GrowingMode | None:
    """A mode that grows between dampers, also one that moves one port only."""
    for size in (1, 100, Fraction(1, 100)):
        held = Termination(Fraction(size))
        q = close(family.n, family.d, [rational(held.damping)] * 2)
        growing = [r for r in roots_of(q) if r.real > 0 and r.imag >= 0] if q else []
        if not growing or is_free_of_growth(as_poly(q, S)):
            continue
        pole = complex(max(growing, key=lambda r: r.real))
        beside = family.at(np.array([pole * (1 + 1e-7)]))[0] + float(size) * np.eye(2)
        v = np.linalg.svd(np.linalg.inv(beside))[0][:, 0]
        v = v * np.exp(-1j * np.angle(v[np.argmax(np.abs(v))])) / np.abs(v).max()
        v = np.where(np.abs(v) < 1e-5, 0, v if pole.imag else v.real)
        velocity = complex(v[0]), complex(v[1])
        at = Fraction(pole.real), Fraction(pole.imag)
        return GrowingMode(family.z, (held, held), *at, velocity)
    return None


def _mode_at(family: Family, at: Gaussian, far: Termination, turned: bool) -> GrowingMode | None:
    """The growing mode at exactly s = `at` with that far termination.

    turned: the far port is port 1
    returns: None where the near termination is not passive, or the mode is not confirmed
    """
    ports = (1, 0) if turned else (0, 1)
    values = [value_at(family.n[i][j], family.d, at) for i in ports for j in ports]
    if any(value is None for value in values):
        return None
    z11, z12, z21, z22 = values
    at_port, ratio = z11, 0j
    if not far.clamped:
        below = z22 + far.at(exact_complex(at), rational)
        if not below:
            return None
        at_port = z11 - z12 * z21 / below
        # velocity of the far port for 1 m/s of the near
        ratio = -complex(*map(float, parts_of(z21 / below)))
    plain = termination_of(parts_of(-at_port), at)
    if plain is None or not at_port:
        return None
    for near in (plain, with_resonance(plain, at)):
        velocity = velocities_in_phase(near, far, ratio, complex(*map(float, at)))
        mode = GrowingMode(family.z, (near, far), *at, velocity)
        if turned:
            mode = replace(mode, terminations=(far, near), velocity=velocity[::-1])
        if mode.energy > 0 and mode.is_confirmed():
            return mode
    return None
