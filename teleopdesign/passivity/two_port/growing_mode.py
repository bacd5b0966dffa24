"""A growing motion of a two-port between passive terminations: it refutes absolute stability.

    Z(s) V + diag(Z1, Z2) V = 0,   v(t) = Re(V e^(s t)),   s = a + j w,   a > 0

At one s, the passive terminations have exactly the values that `termination` can realise. So the
search runs over s and over the value of one termination (`search/points.py`). The other termination
is then -z_in(s), in exact arithmetic. If Z is finite at s and Z + diag(Z1, Z2) is singular there,
its inverse has a pole at s, unless the sum is singular everywhere.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
import sympy as sp

from ...derive.polynomials import as_poly, is_free_of_growth, roots_of
from ...realise.lti import S
from ..linear.conditions import where_it_fails
from ..linear.family import Family, family_of_matrix
from ..linear.matrices import (
    Gaussian,
    close,
    exact_complex,
    inverse_denominator,
    parts_of,
    round_point,
    value_at,
)
from ..rate_independent import AbstractRecord
from ..search.growing_wave import last_part
from ..search.points import candidates, near_axis, near_poles
from .termination import (
    Termination,
    exact_value,
    far_termination,
    termination_of,
    velocities_in_phase,
    with_resonance,
)


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
            times_s = {(power,): sp.QQ(x.numerator, x.denominator) for power, x in parts if x}
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
        c = sp.QQ(*Fraction(size).as_integer_ratio())
        q = close(family.n, family.d, [c, c])
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
        below = z22 + exact_complex(exact_value(far, at))
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
