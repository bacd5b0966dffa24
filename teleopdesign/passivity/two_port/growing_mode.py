"""A growing motion of a two-port between passive terminations: it refutes absolute stability.

    Z(s) V + diag(Z1, Z2) V = 0,   v(t) = Re(V e^(s t)),   s = a + j w,   a > 0

At one s, the passive terminations have exactly the values that `termination` can realise. So the
search runs over s and over the value of one termination (`growth_points`). The other termination is
then -z_in(s), in exact arithmetic. If Z is finite at s and Z + diag(Z1, Z2) is singular there, its
inverse has a pole at s, unless the sum is singular everywhere.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
import sympy as sp

from ...derive.polynomials import X, positive_roots, where_negative
from ...realise.lti import S
from ..checker.absolute_stability import (
    Entries,
    Ratio,
    axis_poles,
    coprime,
    llewellyn,
)
from ..checker.polynomials import (
    Polynomial,
    greatest_common_divisor,
    is_free_of_growth,
    polynomial,
)
from ..checker.polynomials import real_part as real_part_of
from ..search.growing_wave import LONGEST, square_root
from .closed_loop import grows_between, hidden_poles
from .exact_complex import (
    ZERO,
    Gaussian,
    add,
    as_complex,
    divide,
    multiply,
    round_point,
    short,
    value_at,
)
from .growth_points import candidates, evaluate_at, points_of_growth
from .termination import (
    CLAMPED,
    Termination,
    exact_value,
    far_termination,
    termination_near,
    termination_of,
    velocities_in_phase,
    with_resonance,
)


@dataclass(frozen=True)
class GrowingMode:
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
        span = 12.0 / self.s.real  # twelve time constants: what came before is 1e-10 of it
        if self.frequency:
            span = min(span, LONGEST * 2 * math.pi / self.s.imag)
        periods = span * self.s.imag / (2 * math.pi)
        t = np.linspace(-span, 0.0, 2 * int(500 * (1 + periods)) + 1)
        weights = np.ones(len(t))  # Simpson's rule
        weights[1:-1:2], weights[2:-1:2] = 4, 2
        wave, total = np.exp(self.s * t), 0.0
        for held, v in zip(self.terminations, self.velocity, strict=True):
            if not held.clamped:
                power = (held.at(self.s) * v * wave).real * (v * wave).real
                total += float((t[1] - t[0]) / 3 * (weights @ power))
        return total

    def is_confirmed(self) -> bool:
        """Whether the closed loop has a pole in the open right half plane, exactly (Routh)."""
        z = entries_of(self.impedance)
        first, second = self.terminations
        if not (first.clamped or second.clamped):
            return grows_between(z, (first.ratio, second.ratio))
        kept, held = (z[0], first) if second.clamped else (z[3], second)
        alone: Entries = (kept, _NONE, _NONE, _UNIT)
        return not held.clamped and grows_between(alone, (held.ratio, _NONE))

    def as_dict(self) -> dict[str, object]:
        """Plain data, to be written as JSON."""
        return {
            "kind": "growing mode",
            "impedance": [[str(e) for e in row] for row in self.impedance.tolist()],
            "terminations": [
                "clamped" if h.clamped else [str(x) for x in (h.damping, h.inertia, h.stiffness)]
                for h in self.terminations
            ],
            "rate": str(self.rate),
            "frequency": str(self.frequency),
            "velocity": [[v.real, v.imag] for v in self.velocity],
            "energy": self.energy,
        }


_NONE: Ratio = ([], [Fraction(1)])

_UNIT: Ratio = ([Fraction(1)], [Fraction(1)])


def entries_of(z: sp.ImmutableMatrix) -> Entries:
    """z11, z12, z21, z22 as coprime lists of Fractions; z: rational in s."""
    ratios = []
    for entry in (z[0, 0], z[0, 1], z[1, 0], z[1, 1]):
        p, q = (sp.Poly(part, S, domain="QQ") for part in sp.fraction(sp.together(entry)))
        ratios.append(coprime(sort_by_power(p), sort_by_power(q)))
    return ratios[0], ratios[1], ratios[2], ratios[3]


def sort_by_power(p: sp.Poly) -> Polynomial:
    """Coefficients as Fractions, lowest power first."""
    return polynomial(Fraction(int(c.p), int(c.q)) for c in reversed(p.all_coeffs()))


def growing_mode(impedance: sp.ImmutableMatrix) -> GrowingMode | None:
    """Search for passive terminations between which a two-port grows.

    impedance: Z (N s/m), 2x2, rational in s
    returns: a motion that is confirmed exactly; None where the search has no result
    """
    z = entries_of(impedance)
    points = points_of_growth(z)
    values = [evaluate_at(one, points) for one in z]
    for s, second, turned in candidates(values, points)[:_MOST_CANDIDATES]:
        mode = _mode_at(impedance, z, round_point(s), far_termination(s, second), turned)
        if mode is not None:
            return mode
    return (
        _mode_in_one_direction(impedance, z) or _narrow(impedance, z) or _find_at_pole(impedance, z)
    )


#: most candidates that are tested exactly, a millisecond each
_MOST_CANDIDATES = 40


def _exchange_ports(z: Entries) -> Entries:
    return z[3], z[2], z[1], z[0]


def _negative_places(z: Entries) -> list[Fraction]:
    """Values of w^2 at which Re z11, Re z22 or Llewellyn's inequality is negative."""
    tested = [real_part_of(*z[0]), real_part_of(*z[3]), *llewellyn(z)]
    return [x for p in tested for x in where_negative(_poly(p))]


def _poly(p: Polynomial) -> sp.Poly:
    return sp.Poly([sp.Rational(c.numerator, c.denominator) for c in reversed(p)] or [0], X)


def _mode_at(
    impedance: sp.ImmutableMatrix, z: Entries, at: Gaussian, far: Termination, turned: bool
) -> GrowingMode | None:
    """The growing mode at exactly s = `at` with that far termination.

    turned: the far port is port 1
    returns: None where the near termination is not passive, or the mode is not confirmed
    """
    z11, z12, z21, z22 = (value_at(one, at) for one in (_exchange_ports(z) if turned else z))
    if z11 is None or z12 is None or z21 is None or z22 is None:
        return None
    at_port, ratio = z11, 0j
    if not far.clamped:
        below = add(z22, exact_value(far, at))
        if below == ZERO:
            return None
        at_port = add(z11, divide(multiply(z12, z21), below), -1)
        ratio = -as_complex(divide(z21, below))  # velocity of the far port for 1 m/s of the near
    plain = termination_of((-at_port[0], -at_port[1]), at)
    if plain is None or at_port == ZERO:
        return None
    for near in (plain, with_resonance(plain, at)):
        velocity = velocities_in_phase(near, far, ratio, as_complex(at))
        mode = GrowingMode(impedance, (near, far), *at, velocity)
        if turned:
            mode = replace(mode, terminations=(far, near), velocity=velocity[::-1])
        if mode.energy > 0 and mode.is_confirmed():
            return mode
    return None


def _mode_in_one_direction(impedance: sp.ImmutableMatrix, z: Entries) -> GrowingMode | None:
    """A growing mode that is a pole of z12 or z21 alone: it moves one port only."""
    for k, velocity in ((1, (1 + 0j, 0j)), (2, (0j, 1 + 0j))):
        for size in (1, 100, Fraction(1, 100)):
            held = Termination(Fraction(size))
            q = hidden_poles(z, (held.ratio, held.ratio), k)
            roots = np.roots([float(c) for c in reversed(q)]) if len(q) > 1 else np.array([])
            growing = [r for r in roots if r.real > 0 and r.imag >= 0]
            if growing and not is_free_of_growth(q):
                pole = max(growing, key=lambda r: r.real)
                at = Fraction(float(pole.real)), Fraction(float(pole.imag))
                return GrowingMode(impedance, (held, held), *at, velocity)
    return None


def _narrow(impedance: sp.ImmutableMatrix, z: Entries) -> GrowingMode | None:
    """A growing mode beside the axis, with up to 40 digits; None: no result.

    For inequalities that fail by little, or only in a narrow band of frequencies.
    """
    for x in _negative_places(z):
        w = square_root(x, 30)
        for k in range(4, 132, 8):
            at = short(w / 2**k, 6), w
            for turned in (False, True):
                for far in _best_exact(_exchange_ports(z) if turned else z, at):
                    mode = _mode_at(impedance, z, at, far, turned)
                    if mode is not None:
                        return mode
    return None


def _find_at_pole(impedance: sp.ImmutableMatrix, z: Entries) -> GrowingMode | None:
    """A growing mode close to a pole on the axis, with the far port free; None: no result.

    For residues that violate their condition by little.
    """
    poles = greatest_common_divisor(axis_poles(z[1][1]), axis_poles(z[2][1]))
    places = [square_root(x, 60) for x in positive_roots(_poly(poles), bits=200)]
    free = Termination()
    for k in range(4, 132, 4):
        near = [(w / 2**k, w) for w in places]
        near += [(Fraction(1, 2**k), Fraction(0)), (Fraction(2**k), Fraction(0))]
        for rate, frequency in near:
            for turned in (False, True):
                mode = _mode_at(impedance, z, (short(rate, 6), frequency), free, turned)
                if mode is not None:
                    return mode
    return None


def _best_exact(z: Entries, at: Gaussian) -> Iterator[Termination]:
    """Far terminations: a clamp, and the one of `growth_points._best_far` to 40 digits."""
    yield CLAMPED
    z12, z21, z22 = (value_at(one, at) for one in z[1:])
    if z12 is None or z21 is None or z22 is None:
        return
    loop = multiply(z12, z21)
    size = square_root(loop[0] ** 2 + loop[1] ** 2, 40)
    if size + loop[0] == 0 or loop == ZERO:
        return
    slope, share = loop[1] / (size + loop[0]), at[0] / at[1]  # tan(arg(L)/2)
    r = z22[0]
    for _ in range(6):
        r = z22[0] + abs(r * slope - z22[1]) * share
    yield termination_near((r - z22[0], r * slope - z22[1]), at, 40)
