"""Search for a growing wave that takes energy out of a family at a point: any ports, dead times.

The search starts beside frequencies with a negative margin, beside poles and over the right half
plane. Without dead times it knows these frequencies exactly, and modes that grow between dampers.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction

import numpy as np
import sympy as sp

from ...derive.polynomials import X, as_poly, roots_of, where_negative
from ..linear.conditions import hermitian_minors
from ..linear.family import Family
from ..linear.gaussian import ZERO, add, multiply, value_at
from ..linear.matrices import close, dampers
from ..linear.sweep import passive_margin
from .growing_wave import GrowingWave, growing_wave, halvings, wave_of
from .points import near_axis, near_poles

#: of the plainest and of the strongest points: so many are tested exactly
_TESTED = 20


def wave_out_of(family: Family, frequencies: Sequence[float] = ()) -> GrowingWave | None:
    """A wave that takes energy out of the ports; None where the search has no result.

    frequencies: where to look, Hz, besides those that are known exactly
    """
    if family.size == 1 and not family.times:
        return growing_wave(family.impedance)
    parts = [near_poles(family), near_axis(frequencies, range(33))]
    if not family.times:
        parts += [
            near_axis(_exact_frequencies(family), range(33)),
            _modes_between_dampers(family),
        ]
    points = np.concatenate(parts)
    z = family.at(points)
    finite = np.isfinite(z).all(axis=(1, 2))
    points, z = points[finite], z[finite]
    share = passive_margin(z) / np.abs(z).max(axis=(1, 2)) * points.real / np.abs(points)
    size = np.abs(np.log(np.abs(points) / np.median(np.abs(points))))
    plainest = np.lexsort((size, np.round(share, 2)))[:_TESTED]  # of equals, neither slow nor fast
    strongest = np.argsort(share)[:_TESTED]  # where all are weak, rounded shares are all alike
    for k in dict.fromkeys([*plainest, *strongest]):
        at = Fraction(points[k].real), Fraction(points[k].imag)
        wave = wave_of(family.z, *at)
        if wave is not None and wave.energy > 0 and (family.times or _takes_out(family, wave)):
            return wave
    return select_fastest(wave_at(family.z, f) for f in frequencies)


def select_fastest(waves: Iterable[GrowingWave | None]) -> GrowingWave | None:
    """The wave that grows fastest relative to its frequency; None where there is no wave."""
    growing = [w for w in waves if w is not None]
    return max(growing, key=lambda w: w.rate / (w.frequency or w.rate), default=None)


def wave_at(z: sp.ImmutableMatrix, frequency: float) -> GrowingWave | None:
    """A growing wave at about that frequency (Hz) that releases energy; None where there is none.

    The rate of growth is halved until a wave releases energy, down to 2^-30 of the frequency: a
    margin below this share is near rounding.
    """
    w = Fraction(2 * np.pi * frequency)
    for rate in halvings(8 * w, 33):
        wave = wave_of(z, rate, w)
        if wave is not None and wave.energy > 0:
            return wave
    return None


def _exact_frequencies(family: Family) -> list[float]:
    """Frequencies, Hz, at which Z + Z^H is not positive on the axis, from exact polynomials."""
    minors = hermitian_minors(family.n, family.d)
    places = (x for p in minors for x in where_negative(as_poly(p, X)))
    return [float(x) ** 0.5 / (2 * np.pi) for x in places]


def _modes_between_dampers(family: Family) -> np.ndarray:
    """Modes that grow between dampers of several strengths: there Z + Z^H is negative, 1/s."""
    made = [np.zeros(0, dtype=complex)]
    for factor in (1, 64, Fraction(1, 64)):
        held = [
            c * sp.QQ(*Fraction(factor).as_integer_ratio()) for c in dampers(family.n, family.d)
        ]
        made.append(roots_of(close(family.n, family.d, held)))
    s = np.concatenate(made)
    s = np.where(np.abs(s.imag) < 1e-12 * np.abs(s), s.real, s)
    return s[(s.real > 0) & (s.imag >= 0)]


def _takes_out(family: Family, wave: GrowingWave) -> bool:
    """Whether V^H (Z + Z^H) V < 0 at the wave, exactly; V: its velocities, read as fractions."""
    v = [(Fraction(x.real), Fraction(x.imag)) for x in wave.velocity]
    at, total = (wave.rate, wave.frequency), ZERO
    for (re, im), row in zip(v, family.n, strict=True):
        for entry, other in zip(row, v, strict=True):
            value = value_at(entry, family.d, at)
            if value is None:
                return False
            total = add(total, multiply(multiply((re, -im), value), other))
    return total[0] < 0
