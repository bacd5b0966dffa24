"""Zeros of a sum of late polynomials: the rightmost that a search finds, and a proof of one.

f(s) = sum_k p_k(s) e^(-s T_k),   as dead time (s) -> coefficients in s, highest first
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

Terms = Mapping[float, np.ndarray]

#: steps in which the dead times grow to their size, and of Newton's method in each
_STEPS, _NEWTON = 20, 3
#: minima of abs(f) along the axis from which zeros are sought
_LOWEST = 12
#: of the sizes of all terms: more than floating point loses in them
_ROUNDING = 1e-11


def rightmost_root(terms: Terms) -> complex:
    """Of the zeros that a search finds the one with the largest real part, 1/s; -inf: none.

    Followed from those without dead times, and from where abs(f) is small along the axis.
    """
    degree = max(map(len, terms.values())) - 1
    together = np.zeros(degree + 1)
    for p in terms.values():
        together[degree + 1 - len(p) :] += p
    s = np.roots(together).astype(complex)
    for share in np.arange(1, _STEPS + 1) / _STEPS:
        s = _improve({share * t: p for t, p in terms.items()} if share < 1 else terms, s, _NEWTON)
    size = max(float(np.abs(np.roots(together)).max(initial=0.0)), 1e-6)
    w = np.concatenate([np.geomspace(1e-3, 10, 500), np.linspace(0, 10, 1500)]) * size
    w.sort()
    height = np.abs(_values(terms, 1j * w)[0])
    low = np.flatnonzero((height[1:-1] < height[:-2]) & (height[1:-1] <= height[2:])) + 1
    low = low[np.argsort(height[low])][:_LOWEST]
    s = np.concatenate([s, 1j * w[low]])
    s = _improve(terms, s, 12)
    value, _, scale = _values(terms, s)
    with np.errstate(all="ignore"):
        near = np.abs(value) < 1e-9 * scale
    s = s[near & np.isfinite(s)]
    return complex(max(s, key=lambda x: x.real)) if len(s) else complex(-np.inf)


def holds_root(terms: Terms, at: complex) -> float | None:
    """Radius of a disc about `at` in which f has a zero, by Rouche's theorem; None: not shown.

    On its edge f - f'(at) (s - at) is smaller than f'(at) (s - at): the rest of the series is
    bounded by that of the same series with all its terms positive.
    """
    value, slope, _ = (x[0] for x in _values(terms, np.array([at])))
    for radius in abs(at) * 10.0 ** np.arange(-10.0, -1.0):
        rest, edge = 0.0, 0.0
        for t, p in terms.items():
            growth = np.exp(-t * at.real)
            sizes, base = np.abs(p), abs(at)
            first = np.polyval(sizes, base)
            bent = np.polyval(np.polyder(sizes), base) + t * first
            whole = np.polyval(sizes, base + radius) * np.exp(t * radius)
            edge += growth * whole
            rest += growth * (whole - first - bent * radius)
        if abs(value) + rest + _ROUNDING * edge < abs(slope) * radius * (1 - 1e-9):
            return float(radius)
    return None


def _improve(terms: Terms, s: np.ndarray, steps: int) -> np.ndarray:
    for _ in range(steps):
        value, slope, _ = _values(terms, s)
        with np.errstate(all="ignore"):
            step = value / slope
            s = np.where(np.isfinite(step), s - step, s)
    return s


def _values(terms: Terms, s: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """f, f' and the sum of the sizes of all its terms at points s."""
    value, slope, scale = 0 * s, 0 * s, np.zeros(len(s))
    with np.errstate(all="ignore"):
        for t, p in terms.items():
            late, here = np.exp(-s * t), np.polyval(p, s)
            value = value + here * late
            slope = slope + (np.polyval(np.polyder(p), s) - t * here) * late
            scale = scale + np.polyval(np.abs(p), np.abs(s)) * np.abs(late)
    return value, slope, scale
