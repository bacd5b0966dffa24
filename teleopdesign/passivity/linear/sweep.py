"""The least margin of a family over frequency: numerical, no proof.

Nonnegative margins on the axis are necessary and not sufficient: they show neither poles in the
right half plane nor residues at poles on the axis.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

#: margins of matrices Z, (m, n, n) -> (m,)
SweptMargin = Callable[[np.ndarray], np.ndarray]


def passive_margin(z: np.ndarray) -> np.ndarray:
    """Smallest eigenvalue of the Hermitian part of each matrix, (n,); NaN where z is not finite.

    z: (n, k, k), on the axis or in the right half plane
    """
    finite = np.isfinite(z).all(axis=(1, 2))
    margin = np.full(len(z), np.nan)
    margin[finite] = np.linalg.eigvalsh((z[finite] + z[finite].conj().swapaxes(1, 2)) / 2)[:, 0]
    return margin


def stable_margin(z: np.ndarray) -> np.ndarray:
    """Llewellyn's stability parameter minus 1 of each matrix, (n,); z: (n, 2, 2), on the axis.

    inf where z12 z21 = 0;  -inf where Re z11 < 0 or Re z22 < 0
    """
    r1, r2, loop = z[:, 0, 0].real, z[:, 1, 1].real, z[:, 0, 1] * z[:, 1, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        margin = (2 * r1 * r2 - loop.real) / np.abs(loop) - 1
    margin = np.where(loop == 0, np.inf, margin)
    return np.where((r1 < 0) | (r2 < 0), -np.inf, margin)


def margin_of(claim: str) -> SweptMargin:
    """The margin that a claim asks for: "passive" in N s/m, "absolutely stable" without unit."""
    return stable_margin if claim == "absolutely stable" else passive_margin


def least_over(
    margin: Callable[[np.ndarray], np.ndarray], grid: np.ndarray, *, rounds: int, points: int
) -> tuple[float, float, np.ndarray]:
    """The frequency of the least margin, that margin, and the margins on the grid.

    margin: of frequencies, NaN where there is none;  grid: frequencies, in order
    rounds, points: of finer grids beside the least margin
    """
    values = margin(grid)
    first = np.where(np.isnan(values), np.inf, values)
    k = int(np.argmin(first))
    at, least, beside = float(grid[k]), float(first[k]), grid
    for _ in range(rounds):
        beside = np.geomspace(beside[max(k - 1, 0)], beside[min(k + 1, len(beside) - 1)], points)
        finer = margin(beside)
        finer = np.where(np.isnan(finer), np.inf, finer)
        k = int(np.argmin(finer))
        if finer[k] <= least:
            at, least = float(beside[k]), float(finer[k])
    return at, least, values
