"""Points s at which a two-port may grow between passive terminations, the most likely ones first.

The choice of points is numerical. `growing_mode` then confirms a point in exact arithmetic.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ..checker.absolute_stability import Entries, Ratio
from ..checker.polynomials import Polynomial
from .two_port import stable_margin

#: powers of 1/2 by which points approach the axis or a pole, or (reversed) go far out
_CLOSER = tuple(range(1, 34, 2))


def points_of_growth(z: Entries) -> np.ndarray:
    """Points s of the right half plane at which a search for growth looks, 1/s, (n,).

    The points lie beside the axis where an inequality fails, beside poles, and on a grid over the
    quadrant with imaginary part >= 0.

    z: z11, z12, z21, z22 as coprime numerators and denominators
    """
    return np.array([*_points_near_axis(z), *points_near_poles(z)])


def _points_near_axis(z: Entries) -> Iterator[complex]:
    """Points beside the axis, at some of the frequencies where Llewellyn's margin is negative."""
    sizes = np.abs([r for p, q in z for r in (*roots_of(p), *roots_of(q)) if r != 0] or [1.0])
    w = np.unique(np.r_[np.geomspace(sizes.min() / 1e3, sizes.max() * 1e3, 400), sizes])
    value = np.stack([evaluate_at(one, 1j * w) for one in z], axis=1).reshape(-1, 2, 2)
    with np.errstate(all="ignore"):
        margin = stable_margin(value)
    negative = np.flatnonzero(margin < 0)
    if not len(negative):
        return
    chosen = {int(negative[np.argmin(margin[negative])]), *negative[:: len(negative) // 8 + 1]}
    for k in chosen:
        yield from (complex(w[k] * 2.0**-n, w[k]) for n in (*_CLOSER, *range(35, 68, 4)))


def roots_of(p: Polynomial) -> np.ndarray:
    """Roots of a polynomial (lowest power first) in floating point, (n,)."""
    return np.roots([float(c / p[-1]) for c in reversed(p)]) if len(p) > 1 else np.array([])


def points_near_poles(z: Sequence[Ratio]) -> Iterator[complex]:
    """Points s beside poles, and on a grid from below the slowest root to above the fastest, 1/s.

    z: coprime numerators and denominators of the entries of any matrix
    """
    poles = [r for _, q in z for r in roots_of(q)]
    roots = [*poles, *(r for p, _ in z for r in roots_of(p))]
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
    """Points at which two passive terminations seem to make a two-port grow, the best one first.

    At such a point the near port with its termination -z_in(s) would grow, and -z_in(s) is a value
    that a passive termination can have. Numerical.

    values: z11, z12, z21, z22 at each point, each (n,);  points: s, 1/s, (n,)
    returns: (s, value of the far termination, whether the far port is port 1)
    """
    z11, z12, z21, z22 = values
    with np.errstate(all="ignore"):
        loop = z12 * z21
    scored = [
        *_score_points(z11, loop, z22, points, False),
        *_score_points(z22, loop, z11, points, True),
    ]
    scored.sort(key=lambda one: -one[0])
    return [one[1:] for one in scored]


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


def evaluate_at(one: Ratio, s: np.ndarray) -> np.ndarray:
    """Values of a rational function at points s, (n,), in floating point; not finite at a pole."""
    p, q = ([float(c) for c in reversed(r)] or [0.0] for r in one)
    with np.errstate(all="ignore"):  # a point may be a pole
        return np.asarray(np.polyval(p, s) / np.polyval(q, s))
