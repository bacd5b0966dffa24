"""A two-port that grows by itself between passive terminations: what refutes absolute stability.

    Z(s) V + diag(Z1, Z2) V = 0,   v(t) = Re(V e^(s t)),   s = a + j w,   a > 0

Each termination is a damper with a mass and a spring, R + m s + k/s with R, m, k >= 0, or a clamp.
At one s such a termination takes every value with abs(arg) <= arg s, and a positive-real function
takes no other. So the search is one over s, and over the value of one termination; the other is
then -z_in(s), in exact arithmetic. A sum Z + diag(Z1, Z2) without inverse at s, where Z is finite,
is a pole at s of its inverse, unless it has none anywhere.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
import sympy as sp

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
from ..linear.polynomials import X, positive_roots, where_negative
from ..search.growing_wave import LONGEST, square_root
from .closed_loop import grows_between, hidden_poles
from .two_port import stable_margin

Gaussian = tuple[Fraction, Fraction]  # real and imaginary part
_ZERO: Gaussian = (Fraction(0), Fraction(0))


@dataclass(frozen=True)
class Termination:
    """Damper (N s/m), mass (kg) and spring (N/m) at a port, each >= 0; or a clamp: no motion."""

    damping: Fraction = Fraction(0)
    inertia: Fraction = Fraction(0)
    stiffness: Fraction = Fraction(0)
    clamped: bool = False

    def __post_init__(self) -> None:
        if min(self.damping, self.inertia, self.stiffness) < 0:
            raise ValueError(f"termination: a negative part is not passive: {self}")

    @property
    def ratio(self) -> Ratio:
        """R + m s + k/s, coprime."""
        p = polynomial([self.stiffness, self.damping, self.inertia])
        return coprime(p, polynomial([0, 1]))

    @property
    def expression(self) -> sp.Expr:
        """R + m s + k/s in `realise.lti.S`."""
        r, m, k = (
            sp.Rational(x.numerator, x.denominator)
            for x in (self.damping, self.inertia, self.stiffness)
        )
        return r + m * S + k / S

    def at(self, s: complex) -> complex:
        """Its impedance at s, N s/m."""
        return float(self.damping) + float(self.inertia) * s + float(self.stiffness) / s

    def __str__(self) -> str:
        if self.clamped:
            return "clamped"
        parts = (
            (self.damping, "a damper of {:.6g} N s/m"),
            (self.inertia, "a mass of {:.6g} kg"),
            (self.stiffness, "a spring of {:.6g} N/m"),
        )
        shown = [text.format(float(size)) for size, text in parts if size]
        return "held by " + " and ".join(shown) if shown else "free"


CLAMPED = Termination(clamped=True)


@dataclass(frozen=True)
class GrowingMode:
    """A motion of a two-port between passive terminations that grows from near rest.

    impedance: Z, rational in s;  terminations: of port 1 and port 2
    rate, frequency: of growth, 1/s and rad/s; a pole of the closed loop, exactly or rounded
    velocity: V at t = 0 (m/s, complex), one for each port
    """

    impedance: sp.ImmutableMatrix
    terminations: tuple[Termination, Termination]
    rate: Fraction
    frequency: Fraction
    velocity: tuple[complex, complex]

    @property
    def s(self) -> complex:
        """rate + j frequency."""
        return complex(float(self.rate), float(self.frequency))

    @property
    def energy(self) -> float:
        """Energy that both terminations together were given up to t = 0, J, in closed form."""
        total = 0.0
        for held, v in zip(self.terminations, self.velocity, strict=True):
            z = 0.0 if held.clamped else held.at(self.s)
            total += (z * abs(v) ** 2).real / self.s.real + (z * v * v / self.s).real
        return total / 4

    def replay(self) -> float:
        """That energy, J, by integrating force times velocity of each termination over time.

        Over twelve time constants, or the last LONGEST periods where those are shorter: then less.
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
        """Whether this closed loop has a pole in the open right half plane: exact, by Routh."""
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
        ratios.append(coprime(rising(p), rising(q)))
    return ratios[0], ratios[1], ratios[2], ratios[3]


def rising(p: sp.Poly) -> Polynomial:
    """Coefficients as Fractions, lowest power first."""
    return polynomial(Fraction(int(c.p), int(c.q)) for c in reversed(p.all_coeffs()))


def growing_mode(impedance: sp.ImmutableMatrix) -> GrowingMode | None:
    """Passive terminations between which the two-port grows, confirmed exactly; None: none found.

    impedance: rational in s
    """
    z = entries_of(impedance)
    points = points_of_growth(z)
    values = [over(one, points) for one in z]
    for s, second, turned in candidates(values, points)[:_TRIED]:
        mode = _mode_at(impedance, z, rounded(s), far_termination(s, second), turned)
        if mode is not None:
            return mode
    return _passed_on(impedance, z) or _narrow(impedance, z) or _at_a_pole(impedance, z)


#: candidates that are tried exactly, a millisecond each
_TRIED = 40
#: halvings of the distance from the axis, from a pole, or to infinity
_CLOSER = tuple(range(1, 34, 2))


def rounded(s: complex) -> Gaussian:
    """A point to seven digits of its distance from the axis: finer than candidates lie apart."""
    rate, frequency = Fraction(s.real), Fraction(s.imag)
    finer = len(str(int(abs(s) / s.real))) - 1
    return _short(rate, 7), _short(frequency, min(7 + finer, 17))


def far_termination(s: complex, value: complex) -> Termination:
    """The passive termination that has about that value at s; a clamp where it is infinite."""
    if cmath.isinf(value):
        return CLAMPED
    return _nearly((Fraction(value.real), Fraction(value.imag)), rounded(s), 7)


def _turned(z: Entries) -> Entries:
    return z[3], z[2], z[1], z[0]


def _negative_places(z: Entries) -> list[Fraction]:
    """w^2 at which a real part, or Llewellyn's inequality, is negative."""
    tested = [real_part_of(*z[0]), real_part_of(*z[3]), *llewellyn(z)]
    return [x for p in tested for x in where_negative(_poly(p))]


def _poly(p: Polynomial) -> sp.Poly:
    return sp.Poly([sp.Rational(c.numerator, c.denominator) for c in reversed(p)] or [0], X)


def points_of_growth(z: Entries) -> np.ndarray:
    """Points s of the right half plane, imaginary part >= 0, at which growth is looked for, (n,).

    Beside the axis where an inequality fails, beside poles, and on a grid over all of it.
    """
    return np.array([*_near_the_axis(z), *points_near_poles(z)])


def _near_the_axis(z: Entries) -> Iterator[complex]:
    """Beside some of the frequencies at which a sweep finds Llewellyn's margin negative."""
    sizes = np.abs([r for p, q in z for r in (*_roots(p), *_roots(q)) if r != 0] or [1.0])
    w = np.unique(np.r_[np.geomspace(sizes.min() / 1e3, sizes.max() * 1e3, 400), sizes])
    value = np.stack([over(one, 1j * w) for one in z], axis=1).reshape(-1, 2, 2)
    with np.errstate(all="ignore"):
        margin = stable_margin(value)
    negative = np.flatnonzero(margin < 0)
    if not len(negative):
        return
    chosen = {int(negative[np.argmin(margin[negative])]), *negative[:: len(negative) // 8 + 1]}
    for k in chosen:
        yield from (complex(w[k] * 2.0**-n, w[k]) for n in (*_CLOSER, *range(35, 68, 4)))


def _roots(p: Polynomial) -> np.ndarray:
    return np.roots([float(c / p[-1]) for c in reversed(p)]) if len(p) > 1 else np.array([])


def points_near_poles(z: Sequence[Ratio]) -> Iterator[complex]:
    """Beside poles, and everywhere on a grid from the slowest root to the fastest and beyond."""
    poles = [r for _, q in z for r in _roots(q)]
    roots = [*poles, *(r for p, _ in z for r in _roots(p))]
    sizes = [abs(r) for r in roots if r != 0] or [1.0]
    low, high = min(sizes), max(sizes)
    turns = np.exp(1j * np.pi / 4 * np.arange(8))
    candidates = [p + abs(p) * 2.0**-k * turn for p in poles for k in _CLOSER for turn in turns]
    for k in _CLOSER:
        for turn in np.exp(1j * np.pi / 2 * np.array([0, 0.5, 0.9])):
            candidates += [low * 2.0**-k * turn, high * 2.0**k * turn]
    for size in np.geomspace(low / 4, high * 4, 25):
        candidates += list(size * np.exp(1j * np.linspace(0, 0.46 * np.pi, 12)))
    for s in candidates:
        imaginary = s.imag if abs(s.imag) > 1e-9 * abs(s) else 0.0  # rounding: growth without swing
        if s.real > 1e-12 * abs(s) and imaginary >= 0:
            yield complex(s.real, imaginary)


def candidates(
    values: Sequence[np.ndarray], points: np.ndarray
) -> list[tuple[complex, complex, bool]]:
    """(s, value of the far termination, whether the far port is port 1), the best one first.

    There -z_in is the value of a passive termination; numerical.
    values: z11, z12, z21, z22 at each point s, (n,)
    """
    z11, z12, z21, z22 = values
    with np.errstate(all="ignore"):
        loop = z12 * z21
    scored = [*_scored(z11, loop, z22, points, False), *_scored(z22, loop, z11, points, True)]
    scored.sort(key=lambda one: -one[0])
    return [one[1:] for one in scored]


def _scored(
    z11: np.ndarray, loop: np.ndarray, z22: np.ndarray, points: np.ndarray, turned: bool
) -> list[tuple[float, complex, complex, bool]]:
    """Score: how far -z_in lies within the values of passive terminations, times growth."""
    with np.errstate(all="ignore"):
        half = np.angle(points)
        sizes = 10.0 ** np.array(sorted(np.arange(-9, 9.1, 0.5), key=abs))
        turns = np.array([-1, -0.5, 0, 0.5, 1])
        size = np.where(z22 == 0, 1, np.abs(z22))[:, None, None] * sizes[None, :, None]
        grid = size * np.exp(1j * half[:, None, None] * turns[None, None, :])
        # the plain ones stand first: of equals, the first is taken
        held = np.column_stack(
            [0 * points, _best_far(loop, z22, points), grid.reshape(len(points), -1)]
        )
        near = np.column_stack([-z11, loop[:, None] / (z22[:, None] + held) - z11[:, None]])
        second = np.column_stack([np.full(len(points), np.inf), held])
        inside = np.where(half[:, None] > 0, 1 - np.abs(np.angle(near)) / half[:, None], near.real)
        inside = np.where(np.isfinite(near) & (near != 0), inside, -1)
        inside = np.where(half[:, None] > 0, inside, np.sign(inside))
        score = np.minimum(inside, 0.2) * (points.real / np.abs(points))[:, None]
    scores = []
    for i in np.flatnonzero((score > 0).any(axis=1)):
        k = int(np.argmax(score[i]))
        scores.append((float(score[i, k]), complex(points[i]), complex(second[i, k]), turned))
    return scores


def _best_far(loop: np.ndarray, z22: np.ndarray, s: np.ndarray) -> np.ndarray:
    """A far termination for which Re(z12 z21/(z22 + Z2)) is about as large as it can be.

    z22 + Z2 = r (1 + j tan(arg(L)/2)), with r as small as a passive Z2 lets it be
    """
    slope = np.tan(np.angle(loop) / 2)
    share = s.real / np.maximum(s.imag, 1e-300)
    r = z22.real
    for _ in range(4):
        r = z22.real + np.abs(r * slope - z22.imag) * share
    second = r - z22.real + 1j * (r * slope - z22.imag)
    return np.where(np.isfinite(second) & (s.imag > 0), second, 0)


def over(one: Ratio, s: np.ndarray) -> np.ndarray:
    """Numerical values at points s, (n,)."""
    p, q = ([float(c) for c in reversed(r)] or [0.0] for r in one)
    with np.errstate(all="ignore"):  # a point may be a pole
        return np.asarray(np.polyval(p, s) / np.polyval(q, s))


def _mode_at(
    impedance: sp.ImmutableMatrix, z: Entries, at: Gaussian, far: Termination, turned: bool
) -> GrowingMode | None:
    """The growing mode at exactly that s with that far termination, if the near one is passive.

    turned: the far port is port 1
    """
    z11, z12, z21, z22 = (value_at(one, at) for one in (_turned(z) if turned else z))
    if z11 is None or z12 is None or z21 is None or z22 is None:
        return None
    at_port, ratio = z11, 0j
    if not far.clamped:
        below = _plus(z22, exact_value(far, at))
        if below == _ZERO:
            return None
        at_port = _plus(z11, _over_exact(_times(z12, z21), below), -1)
        ratio = -_number(_over_exact(z21, below))  # velocity of the far port for 1 m/s of the near
    plain = termination_of((-at_port[0], -at_port[1]), at)
    if plain is None or at_port == _ZERO:
        return None
    for near in (plain, _spread(plain, at)):
        velocity = _phased(near, far, ratio, _number(at))
        mode = GrowingMode(impedance, (near, far), *at, velocity)
        if turned:
            mode = replace(mode, terminations=(far, near), velocity=velocity[::-1])
        if mode.energy > 0 and mode.is_confirmed():
            return mode
    return None


def _spread(held: Termination, at: Gaussian) -> Termination:
    """The same impedance at s, half of its damper replaced by a mass and a spring that resonate.

    For a two-port of dampers alone: with a damper equal and opposite no motion is determined.
    """
    rate, size = at[0], at[0] ** 2 + at[1] ** 2
    mass = held.damping / (4 * rate)
    return Termination(
        held.damping / 2, held.inertia + mass, held.stiffness + mass * size, held.clamped
    )


def _phased(
    near: Termination, far: Termination, ratio: complex, s: complex
) -> tuple[complex, complex]:
    """Velocities, the larger one 1 m/s, in the phase that gives the terminations most."""
    size = max(1.0, abs(ratio))
    v = [1 / size, ratio / size]
    if s.imag == 0:
        return complex(v[0]), complex(v[1].real)
    total = near.at(s) * v[0] ** 2 + (0 if far.clamped else far.at(s) * v[1] ** 2)
    turn = cmath.exp(-0.5j * cmath.phase(total / s)) if total else 1
    return v[0] * turn, v[1] * turn


def termination_of(wanted: Gaussian, at: Gaussian) -> Termination | None:
    """The damper with a mass or a spring whose impedance at s is `wanted`; None: not passive."""
    real, inertia, stiffness = _parts(wanted, at)
    if real < 0 or (wanted[1] != 0 and at[1] == 0):
        return None
    return Termination(real, inertia, stiffness)


def _nearly(wanted: Gaussian, at: Gaussian, digits: int) -> Termination:
    """About the same, its parts to so many digits, a damper below 0 left off."""
    real, *rest = _parts(wanted, at)
    real, inertia, stiffness = (_short(x, digits) for x in (max(real, Fraction(0)), *rest))
    return Termination(real, inertia, stiffness)


def _parts(wanted: Gaussian, at: Gaussian) -> tuple[Fraction, Fraction, Fraction]:
    """Damper, which may be negative, mass and spring."""
    (real, imaginary), (rate, frequency) = wanted, at
    none = Fraction(0)
    if imaginary == 0 or frequency == 0:
        return real, none, none
    if imaginary > 0:
        inertia = imaginary / frequency
        return real - inertia * rate, inertia, none
    stiffness = -imaginary * (rate**2 + frequency**2) / frequency
    return real + imaginary * rate / frequency, none, stiffness


def _short(x: Fraction, digits: int) -> Fraction:
    """x >= 0 to so many significant digits."""
    if x == 0:
        return x
    place = digits - len(str(int(x))) if x >= 1 else digits + len(str(int(1 / x)))
    unit = Fraction(10) ** -place
    return round(x / unit) * unit


def exact_value(held: Termination, at: Gaussian) -> Gaussian:
    """R + m s + k/s at s, exactly."""
    size = at[0] ** 2 + at[1] ** 2
    m, k = held.inertia, held.stiffness
    return held.damping + m * at[0] + k * at[0] / size, m * at[1] - k * at[1] / size


def value_at(one: Ratio, at: Gaussian) -> Gaussian | None:
    """Exact value of a rational function; None at a pole."""
    p, q = (_horner(r, at) for r in one)
    return None if q == _ZERO else _over_exact(p, q)


def _horner(p: Polynomial, at: Gaussian) -> Gaussian:
    total = _ZERO
    for c in reversed(p):
        total = _plus(_times(total, at), (c, Fraction(0)))
    return total


def _plus(a: Gaussian, b: Gaussian, factor: int = 1) -> Gaussian:
    return a[0] + factor * b[0], a[1] + factor * b[1]


def _times(a: Gaussian, b: Gaussian) -> Gaussian:
    return a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]


def _over_exact(a: Gaussian, b: Gaussian) -> Gaussian:
    size = b[0] ** 2 + b[1] ** 2
    return _times(a, (b[0] / size, -b[1] / size))


def _number(a: Gaussian) -> complex:
    return complex(float(a[0]), float(a[1]))


def _passed_on(impedance: sp.ImmutableMatrix, z: Entries) -> GrowingMode | None:
    """The growing mode of z12 or z21 that the other one does not see: it moves one port alone."""
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
    """As `_near_the_axis`, with 40 digits: for inequalities that fail by little, or in a gap."""
    for x in _negative_places(z):
        w = square_root(x, 30)
        for k in range(4, 132, 8):
            at = _short(w / 2**k, 6), w
            for turned in (False, True):
                for far in _best_exact(_turned(z) if turned else z, at):
                    mode = _mode_at(impedance, z, at, far, turned)
                    if mode is not None:
                        return mode
    return None


def _at_a_pole(impedance: sp.ImmutableMatrix, z: Entries) -> GrowingMode | None:
    """Ever closer to a pole on the axis, far port free: for residues that fail by little."""
    poles = greatest_common_divisor(axis_poles(z[1][1]), axis_poles(z[2][1]))
    places = [square_root(x, 60) for x in positive_roots(_poly(poles), bits=200)]
    free = Termination()
    for k in range(4, 132, 4):
        near = [(w / 2**k, w) for w in places]
        near += [(Fraction(1, 2**k), Fraction(0)), (Fraction(2**k), Fraction(0))]
        for rate, frequency in near:
            for turned in (False, True):
                mode = _mode_at(impedance, z, (_short(rate, 6), frequency), free, turned)
                if mode is not None:
                    return mode
    return None


def _best_exact(z: Entries, at: Gaussian) -> Iterator[Termination]:
    """What `_best_far` says, to 40 digits, and a clamp."""
    yield CLAMPED
    z12, z21, z22 = (value_at(one, at) for one in z[1:])
    if z12 is None or z21 is None or z22 is None:
        return
    loop = _times(z12, z21)
    size = square_root(loop[0] ** 2 + loop[1] ** 2, 40)
    if size + loop[0] == 0 or loop == _ZERO:
        return
    slope, share = loop[1] / (size + loop[0]), at[0] / at[1]  # tan(arg(L)/2)
    r = z22[0]
    for _ in range(6):
        r = z22[0] + abs(r * slope - z22[1]) * share
    yield _nearly((r - z22[0], r * slope - z22[1]), at, 40)
