"""Search for growing motions of a family at a point: where to look, and waves out of its ports.

The search starts beside frequencies with a negative margin, beside poles and over the right half
plane. Without dead times it knows these frequencies exactly, and modes that grow between dampers.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

import numpy as np
import sympy as sp

from ...derive.polynomials import roots_of
from ..linear.conditions import where_it_fails
from ..linear.family import Family
from ..linear.matrices import close, dampers, exact_complex, value_at
from ..linear.sweep import passive_margin, zeros_and_poles
from .growing_wave import GrowingWave, is_plain, wave_beside_axis, wave_of

#: most points with a termination that are tested for a motion, a millisecond each
_MOST = 40
#: powers of 1/2 by which points approach the axis or a pole, or (reversed) go far out
_CLOSER = tuple(range(1, 34, 2))


def near_poles(family: Family) -> np.ndarray:
    """Points beside poles, and on a grid from below the slowest root to above the fastest, (n,)."""
    zeros, poles = zeros_and_poles(family)
    sizes = np.abs([r for r in (*poles, *zeros) if r != 0] or [1.0])
    low, high = sizes.min(), sizes.max()
    turns = np.exp(1j * np.pi / 4 * np.arange(8))
    points = [p + abs(p) * 2.0**-k * turn for p in poles for k in _CLOSER for turn in turns]
    for k in _CLOSER:
        for turn in np.exp(1j * np.pi / 2 * np.array([0, 0.5, 0.9])):
            points += [low * 2.0**-k * turn, high * 2.0**k * turn]
    for size in np.geomspace(low / 4, high * 4, 25):
        points += list(size * np.exp(1j * np.linspace(0, 0.46 * np.pi, 12)))
    s = np.array(points)
    s = np.where(np.abs(s.imag) > 1e-9 * np.abs(s), s, s.real)  # rounding: no swing
    return np.asarray(s[(s.real > 1e-12 * np.abs(s)) & (s.imag >= 0)])


def near_axis(frequencies: Sequence[float], closer: Sequence[int]) -> np.ndarray:
    """Points beside the axis at frequencies (Hz), at these powers of 1/2 of their frequency."""
    w = 2 * np.pi * np.asarray(frequencies, dtype=float)
    return np.asarray((w[:, None] * (2.0 ** -np.array(closer, dtype=float) + 1j)).ravel())


def candidates(family: Family, points: np.ndarray) -> list[tuple[complex, complex, bool]]:
    """Points at which two passive terminations seem to make a two-port grow, the best one first.

    At such a point the near port with its termination -z_in(s) would grow, and -z_in(s) is a value
    that a passive termination can have. Numerical.

    family: of two ports;  points: s, 1/s, (n,)
    returns: (s, value of the far termination, whether the far port is port 1), of the best points
    """
    z11, z12, z21, z22 = family.at(points).reshape(-1, 4).T
    with np.errstate(all="ignore"):
        loop = z12 * z21
    scored = [
        *_score_points(z11, loop, z22, points, False),
        *_score_points(z22, loop, z11, points, True),
    ]
    scored.sort(key=lambda one: -one[0])
    return [one[1:] for one in scored[:_MOST]]


def _score_points(
    z11: np.ndarray, loop: np.ndarray, z22: np.ndarray, points: np.ndarray, turned: bool
) -> list[tuple[float, complex, complex, bool]]:
    """The best far termination at each point, with its score.

    The score says how far -z_in lies inside the values of passive terminations, times the growth
    relative to abs(s). turned: the far port is port 1
    """
    with np.errstate(all="ignore"):
        half = np.angle(points)
        sizes = 10.0 ** np.array(sorted(np.arange(-9, 9.1, 0.5), key=abs))
        turns = np.array([-1, -0.5, 0, 0.5, 1])
        size = np.where(z22 == 0, 1, np.abs(z22))[:, None, None] * sizes[None, :, None]
        grid = size * np.exp(1j * half[:, None, None] * turns[None, None, :])
        # the plain ones stand first: of equals, the first is taken
        best = _best_far(loop, z22, points)
        held = np.column_stack([0 * points, best, grid.reshape(len(points), -1)])
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
    """A far termination Z2 for which Re(z12 z21/(z22 + Z2)) is about as large as possible.

    z22 + Z2 = r (1 + j tan(arg(L)/2)), with r as small as a passive Z2 lets it be
    """
    slope = np.tan(np.angle(loop) / 2)
    share = s.real / np.maximum(s.imag, 1e-300)
    r = z22.real
    for _ in range(4):
        r = z22.real + np.abs(r * slope - z22.imag) * share
    second = r - z22.real + 1j * (r * slope - z22.imag)
    return np.where(np.isfinite(second) & (s.imag > 0), second, 0)


#: of the plainest and of the strongest points: so many are tested exactly
_TESTED = 20


def waves_out_of(family: Family, frequencies: Sequence[float] = ()) -> Iterator[GrowingWave]:
    """Waves that take energy out of the ports, the plainest first.

    frequencies: where to look, Hz, besides those that are known exactly
    """
    weak = None
    if family.size == 1 and not family.times:
        weak = wave_beside_axis(family.impedance)
        if weak is not None and is_plain(weak):
            yield weak
            weak = None
    parts = [near_poles(family), near_axis(frequencies, range(33))]
    if not family.times:
        places = where_it_fails(family, "passive")
        parts += [
            near_axis([float(x) ** 0.5 / (2 * np.pi) for x in places], range(33)),
            _modes_between_dampers(family),
        ]
    points = np.concatenate(parts)
    z = family.at(points)
    finite = np.isfinite(z).all(axis=(1, 2)) & z.any(axis=(1, 2))
    points, z = points[finite], z[finite]
    share = passive_margin(z) / np.abs(z).max(axis=(1, 2)) * points.real / np.abs(points)
    size = np.abs(np.log(np.abs(points) / np.median(np.abs(points))))
    plainest = np.lexsort((size, np.round(share, 2)))[:_TESTED]  # of equals, neither slow nor fast
    strongest = np.argsort(share)[:_TESTED]  # where all are weak, rounded shares are all alike
    for k in dict.fromkeys([*plainest, *strongest]):
        at = Fraction(points[k].real), Fraction(points[k].imag)
        wave = wave_of(family.z, *at)
        if wave is not None and wave.energy > 0 and (family.times or _takes_out(family, wave)):
            yield wave
    if weak is not None:
        yield weak


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
    v = [exact_complex((Fraction(x.real), Fraction(x.imag))) for x in wave.velocity]
    at, total = (wave.rate, wave.frequency), sp.QQ_I.zero
    for one, row in zip(v, family.n, strict=True):
        for entry, other in zip(row, v, strict=True):
            value = value_at(entry, family.d, at)
            if value is None:
                return False
            total += sp.QQ_I(one.x, -one.y) * value * other
    return bool(total.x < 0)
