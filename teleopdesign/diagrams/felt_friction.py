"""Coulomb friction of parallel rods at the hand: the possible forces form a zonotope.

With motion L = G X of the rods, friction between -F_C and F_C on each of them pushes the hand with

    F = -G^T f,   f in [-F_C1, F_C1] x ... x [-F_Cn, F_Cn]

A hand that moves along a unit direction u feels h(u) = sum_k F_Ck abs(G u)_k against it: the
support function of that zonotope. It is largest towards a corner and smallest across a facet, on
which one rod alone slides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from ..base.errors import ModelError
from ..base.frozen import ByValue

_MOST_RODS = 16  # 2^15 corners


@dataclass(frozen=True, eq=False)
class FeltFriction(ByValue):
    """Friction of n rods in the n coordinates of a hand; see `felt_friction`.

    geometry: G (n, n);  levels: F_C (n,), N
    """

    geometry: np.ndarray
    levels: np.ndarray

    def along(self, directions: np.ndarray) -> np.ndarray:
        """Friction against a motion along each direction, N: the support function.

        directions: (..., n), of any length; friction is per unit of this length
        """
        return np.asarray(np.abs(directions @ self.geometry.T) @ self.levels)

    def force(self, directions: np.ndarray) -> np.ndarray:
        """Force of friction on a hand that moves along each direction (..., n), N: minus a corner.

        Rods that do not move in this motion contribute nothing.
        """
        sliding = np.sign(directions @ self.geometry.T)
        return np.asarray(-(sliding * self.levels) @ self.geometry)

    def holds(self, forces: np.ndarray, *, tolerance: float = 1e-9) -> np.ndarray:
        """Whether friction can balance each of these forces on the hand (..., n), N.

        tolerance: of each rod's level, relative;  returns: (...,)
        """
        rods = forces @ np.linalg.inv(self.geometry)
        return np.asarray((np.abs(rods) <= (1 + tolerance) * self.levels).all(axis=-1))

    @property
    def largest(self) -> tuple[float, np.ndarray]:
        """Level (N) and unit direction (n,) of the largest friction: the farthest corner."""
        n = len(self.levels)
        signs = np.array([(1.0, *rest) for rest in product((-1.0, 1.0), repeat=n - 1)])
        corners = (signs * self.levels) @ self.geometry
        sizes = np.linalg.norm(corners, axis=1)
        farthest = int(np.argmax(sizes))
        size = float(sizes[farthest])
        return size, corners[farthest] / (size or 1.0)

    @property
    def smallest(self) -> tuple[float, np.ndarray]:
        """Level (N) and unit direction (n,) of the smallest friction: across the nearest facet."""
        alone = np.linalg.inv(self.geometry).T  # row k: the motion of the hand that moves rod k
        lengths = np.linalg.norm(alone, axis=1)
        nearest = int(np.argmin(self.levels / lengths))
        return float(self.levels[nearest] / lengths[nearest]), alone[nearest] / lengths[nearest]

    def __repr__(self) -> str:
        (most, _), (least, _) = self.largest, self.smallest
        return f"Friction of {len(self.levels)} rods: {least:.4g} to {most:.4g} N at the hand"


def felt_friction(geometry: np.ndarray, levels: Sequence[float]) -> FeltFriction:
    """Friction that a hand feels from parallel rods.

    geometry: G (n, n), as for `parallel_rods`
    levels: Coulomb level of each rod, or the part that a cancellation leaves, N
    raises ModelError: G is no regular n x n matrix, a level is negative, more than 16 rods
    """
    g, f = np.asarray(geometry, dtype=float), np.asarray(levels, dtype=float)
    if f.ndim != 1 or g.shape != (len(f), len(f)) or not 1 <= len(f) <= _MOST_RODS:
        raise ModelError(
            f"felt_friction: geometry is {g.shape} and levels {f.shape}, expected (n, n) and (n,) "
            f"with n up to {_MOST_RODS}"
        )
    if np.linalg.matrix_rank(g) < len(f):
        raise ModelError("felt_friction: the geometry is singular: some motion of the hand is free")
    if not (f >= 0).all():
        raise ModelError(f"felt_friction: levels must not be negative, found {f.min():g} N")
    return FeltFriction(g, f)
