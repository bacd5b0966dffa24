"""A motion at the samples of a computer that takes energy out: its travel grows as Re(V z^k)."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np
import sympy as sp

from ...base.frozen import ByValue
from ..rate_independent import AbstractMotion
from .growing_wave import ROUNDING

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
