"""A growing wave: a motion that takes energy out of a linear system that is not passive.

    v(t) = Re(V e^(s t)) for t <= 0,   s = a + j w,   a > 0

Along this motion the force is Re(Z(s) V e^(s t)), also with dead times. With the best phase of V
the energy that flows in is (Re V^* Z V/a - abs(V^T Z V/s))/4: negative wherever Re V^* Z V < 0. The
motion starts arbitrarily near to rest, so no stored energy can have paid for the release. At the
samples of a computer the travel grows as Re(V z^k).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from fractions import Fraction

import mpmath
import numpy as np
import sympy as sp

from ...base.frozen import ByValue
from ...derive.polynomials import even_part, where_negative
from ..linear.family import family_of_matrix
from ..linear.impedance import Impedance
from ..linear.matrices import square_root
from ..linear.sweep import passive_margin
from ..rate_independent import AbstractMotion, AbstractRecord

LONGEST = 500  # most periods of a wave that are sampled; each of them releases energy
_DIGITS = 320  # decimal digits in which Z is evaluated
#: -Re Z as a share of abs(Z), below which a replay in double precision loses Re Z in its sum (about
#: 1e4 roundings)
_WEAKEST = 1e-11
#: Re Z as a share of abs(Z), above which double precision shows that Re Z is positive
_PLAIN = 1e-6
#: a sum of energies in double precision that is below this share of the sizes of its terms may be
#: rounding: 2^-48 is sixteen units in the last place (2^-52)
ROUNDING = 2.0**-48


@dataclass(frozen=True)
class GrowingWave(AbstractRecord):
    """A growing wave at the ports of an impedance: v(t) = Re(V e^(s t)) for t <= 0.

    impedance: forces over velocities, N s/m, n by n, in `realise.lti.S`
    rate, frequency: real and imaginary part of s, 1/s and rad/s, exact
    velocity: V at t = 0, m/s, complex, one for each port
    """

    impedance: sp.ImmutableMatrix
    rate: Fraction
    frequency: Fraction
    velocity: tuple[complex, ...]
    kind = "growing wave"

    @property
    def s(self) -> complex:
        """rate + j frequency, 1/s."""
        return complex(float(self.rate), float(self.frequency))

    @property
    def value(self) -> np.ndarray:
        """Z(s), (n, n), N s/m."""
        return value_at(self.impedance, self.rate, self.frequency)

    @property
    def energy(self) -> float:
        """Energy released from the distant past up to t = 0, J, in closed form."""
        z, v = self.value, np.array(self.velocity)
        return float(-((v.conj() @ z @ v).real / self.s.real + (v @ z @ v / self.s).real) / 4)

    def samples(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The last part of the wave: time (n,), s; velocities and forces (n, ports), m/s and N.

        If all poles decay, or grow slower than the wave, the force is also that of a motion that
        started from rest, after its transient.
        """
        t, _ = last_part(self.s)
        wave = np.exp(self.s * t)[:, None] * np.array(self.velocity)
        return t, wave.real, (wave @ self.value.T).real

    def replay(self) -> float:
        """Energy released, J: minus the integral of force times velocity over `samples`.

        0 where the sum is no larger than the rounding of its terms, because it then shows nothing.
        """
        _, velocity, force = self.samples()
        terms = last_part(self.s)[1] * (velocity * force).sum(axis=1)
        total = float(terms.sum())
        return -total if abs(total) > ROUNDING * float(np.abs(terms).sum()) else 0.0


def last_part(s: complex) -> tuple[np.ndarray, np.ndarray]:
    """Times of the last part of a motion that grows as e^(s t), and weights of an integral over it.

    The part is twelve time constants of growth (what came before is 1e-10 of it), or LONGEST
    periods if they are shorter, with a thousand times in each period, and in the whole. The weights
    are those of Simpson's rule.
    """
    span = 12.0 / s.real
    if s.imag:
        span = min(span, LONGEST * 2 * math.pi / s.imag)
    t = np.linspace(-span, 0.0, 2 * int(500 * (1 + span * s.imag / (2 * math.pi))) + 1)
    weights = np.ones(len(t))
    weights[1:-1:2], weights[2:-1:2] = 4, 2
    return t, (t[1] - t[0]) / 3 * weights


def value_at(z: sp.ImmutableMatrix, rate: Fraction, frequency: Fraction) -> np.ndarray:
    """Z at rate + j frequency, N s/m, (n, n), to double precision; NaN at a pole."""
    # poles and zeros of badly scaled systems lie close together, and near s = 0 dead times leave
    # differences of numbers that agree in tens of digits
    with mpmath.workdps(_DIGITS):
        s = mpmath.mpc(*(mpmath.mpf(x.numerator) / x.denominator for x in (rate, frequency)))
        try:
            rows = family_of_matrix(z).precisely(s)
            return np.array([[complex(x) for x in row] for row in rows])
        except (ZeroDivisionError, OverflowError):
            return np.full(z.shape, np.nan, dtype=complex)


def wave_of(z: sp.ImmutableMatrix, rate: Fraction, frequency: Fraction) -> GrowingWave | None:
    """The wave at s = rate + j frequency that releases most energy.

    The decision is in double precision, with a dead time within 1e-9 of abs(Z). `wave_beside_axis`
    decides exactly.

    z: N s/m, (n, n);  rate: 1/s;  frequency: rad/s
    returns: None where no wave at s releases energy
    """
    s, is_late = complex(float(rate), float(frequency)), z.has(sp.exp)
    if is_late:
        near = family_of_matrix(z).at(np.array([s]))
        if passive_margin(near)[0] > _PLAIN * np.abs(near).max():
            return None
    value = value_at(z, rate, frequency)
    if not np.all(np.isfinite(value)):
        return None
    real = (value + value.conj().T) / 2
    sizes, vectors = np.linalg.eigh(real)
    if sizes[0] >= (-1e-9 * np.abs(value).max() if is_late else 0):
        return None
    v = vectors[:, 0]
    if frequency == 0:
        v = v.real  # there is no phase to choose: the wave is one exponential
    else:
        v = v * np.exp(1j * (math.pi - np.angle(v @ value @ v / s)) / 2)
    return GrowingWave(z, rate, frequency, tuple(complex(x) for x in v))


def rates_at(frequency: Fraction, number: int) -> Iterable[tuple[Fraction, Fraction]]:
    """Rates of growth, halved so many times, at a frequency."""
    return ((frequency / 2**k, frequency) for k in range(1, number + 1))


def wave_beside_axis(z: Impedance) -> GrowingWave | None:
    """The wave of an impedance that grows fastest against its frequency, just beside the axis.

    That Re Z < 0 at its s is verified exactly.

    returns: None where Re Z is negative nowhere on the axis, or where no wave is resolved
    """
    waves = [_find_beside_axis(z, x) for x in where_negative(even_part(z.p, z.q))]
    growing = [w for w in waves if w is not None]
    # the one that grows fastest against its frequency is the plainest to look at
    return max(growing, key=lambda w: w.rate / w.frequency, default=None)


def is_plain(wave: GrowingWave) -> bool:
    """Whether a replay in double precision shows that Re Z is negative at a wave of one port."""
    at = complex(wave.value[0, 0])
    return -at.real / abs(at) > _WEAKEST


def _find_beside_axis(z: Impedance, x: Fraction) -> GrowingWave | None:
    """A wave at the frequency sqrt(x) or close to it; None where none is resolved.

    The rate of growth is halved until Re Z < 0.
    """
    for digits in (20, 60, 200):  # enough for a dip in frequency that narrow, relative
        frequency = square_root(x, digits)
        for rate, _ in rates_at(frequency, 4 * digits):
            value = z.at(rate, frequency)
            if value is not None and value[0] < 0:
                wave = wave_of(sp.ImmutableMatrix([[z.expression]]), rate, frequency)
                if wave is not None:
                    return wave
    return None


#: z, the forward shift by one sample
Z = sp.Symbol("z")
#: most samples of a replayed motion, a second of computing; a longer wave is cut off, and then does
#: not start at rest
_SAMPLES = 1_000_000
#: most samples between two steps: a controller that grows by 1 % a sample needs 1000
_LONGEST_WAIT = 4096


@dataclass(frozen=True, eq=False)
class SampledWave(AbstractMotion, ByValue):
    """A motion at the samples that takes energy out: the travel grows as Re(V z^k), k <= 0.

    law: H(z);  damping, sample_time, stiffness: as in `sampled_passivity`
    rate, frequency: s = rate + j frequency with z = (1 + s)/(1 - s)
    travel: over each sample, m, (n,), from (almost) rest
    """

    law: sp.Expr
    damping: sp.Expr
    sample_time: sp.Expr
    stiffness: sp.Expr
    rate: Fraction
    frequency: Fraction
    travel: np.ndarray = field(repr=False, compare=False)
    kind = "sampled wave"

    @property
    def factor(self) -> complex:
        """z, the factor of the travel from one sample to the next; abs(z) > 1."""
        return _factor(self.rate, self.frequency)

    def replay(self) -> float:
        """Energy released, J, computed from rest with the controller's difference equation."""
        system = self.law, self.damping, self.sample_time, self.stiffness
        return float(_released_energy(self.travel, *system))


def sampled_wave(
    law: sp.Expr,
    damping: sp.Expr,
    sample_time: sp.Expr,
    stiffness: sp.Expr,
    rate: Fraction,
    frequency: Fraction,
) -> SampledWave:
    """The motion with growing travel at s = rate + j frequency, in the phase that releases most.

    Where the controller itself grows faster than this travel, the motion is a step, and a second
    step along the force that the first one has caused.
    """
    system = law, damping, sample_time, stiffness
    z = _factor(rate, frequency)
    growth = np.log(abs(z))
    number = int(min(np.ceil(16 / growth), _SAMPLES)) if growth > 0 else _SAMPLES
    wave = z ** np.arange(-number, 1)
    out, best = _largest(wave.real, wave.imag, system)
    waited = 1
    while out <= 0 and waited <= _LONGEST_WAIT:
        waited *= 2
        steps = np.eye(2, waited, k=0), np.eye(2, waited, k=waited - 2)
        out, best = _largest(steps[0][0], steps[1][1], system)
    return SampledWave(*system, rate, frequency, best)


def _largest(
    one: np.ndarray, other: np.ndarray, system: tuple[sp.Expr, sp.Expr, sp.Expr, sp.Expr]
) -> tuple[float, np.ndarray]:
    """Of all mixtures of two travels (n,), the one that releases most: its energy, J, and travel.

    The energy is a quadratic form of the mixture. The best mixture is its largest eigenvector.
    """
    out = _released_energy(np.array([one, other, one + other]), *system)
    if not np.isfinite(out).all():
        return -np.inf, one  # a controller that leaves double precision on the way
    mixed = (out[2] - out[0] - out[1]) / 2
    share = np.linalg.eigh(np.array([[out[0], mixed], [mixed, out[1]]]))[1][:, -1]
    travel = share[0] * one + share[1] * other
    return float(_released_energy(travel, *system)), travel


def _factor(rate: Fraction, frequency: Fraction) -> complex:
    s = complex(float(rate), float(frequency))
    return (1 + s) / (1 - s) if s != 1 else complex(1e12)  # a single travel


def _released_energy(
    travel: np.ndarray, law: sp.Expr, damping: sp.Expr, sample_time: sp.Expr, stiffness: sp.Expr
) -> np.ndarray:
    """Energy released, J, by each of the motions, travel (..., n).

    0 where it may be rounding; not finite where the controller leaves double precision
    """
    from scipy.signal import lfilter

    position = np.cumsum(travel, axis=-1)
    before = np.concatenate([np.zeros_like(position[..., :1]), position[..., :-1]], axis=-1)
    above, below = (sp.Poly(part, Z) for part in sp.fraction(sp.cancel(law)))
    a = [float(c) for c in below.all_coeffs()]
    b = [float(c) for c in above.all_coeffs()]  # of a law that does nothing: [0]
    b = [0.0] * (len(a) - len(b)) + b
    with np.errstate(over="ignore", invalid="ignore"):  # what grows leaves double precision
        work = lfilter(b, a, before) * travel
        lost = float(damping) / float(sample_time) * (travel**2).sum(axis=-1)
        stored = float(stiffness) * position[..., -1] ** 2 / 2
        out = -(work.sum(axis=-1) + lost + stored)
        size = np.abs(work).sum(axis=-1) + np.abs(lost) + np.abs(stored)
        return np.where(np.abs(out) > ROUNDING * size, out, np.where(np.isfinite(out), 0.0, out))
