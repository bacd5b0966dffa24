"""A linear impedance between several motions: a hand on several axes, a body with full inertia.

force_i = sum_j (M_ij a_j + B_ij v_j + K_ij x_j)        Z(s) = M s^2 + B s + K
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
import sympy as sp

from ..base.arguments import check_types, describe_value
from ..base.errors import ModelError, did_you_mean

MatrixRows = tuple[tuple[float, ...], ...]


@check_types
@dataclass(frozen=True)
class MatrixImpedance:
    """Z = mass s^2 + damping s + stiffness, square matrices of one size (SI).

    Entry (i, j) is the force i per motion j; entries that are zero are no parameters.
    raises ModelError: the matrices are not square and of one size
    """

    mass: MatrixRows
    damping: MatrixRows
    stiffness: MatrixRows

    def __post_init__(self) -> None:
        for name in _PARTS:
            rows = getattr(self, name)
            if len(rows) != self.size or any(len(row) != self.size for row in rows):
                raise ModelError(
                    f"impedance: {name} is no {self.size} x {self.size} matrix like the others"
                )

    @property
    def size(self) -> int:
        """Number of motions."""
        return len(self.mass)

    @property
    def parameters(self) -> dict[str, float]:
        """Entries that are not zero: "stiffness_1_2" -> value (SI)."""
        return {
            f"{name}_{i + 1}_{j + 1}": value
            for name in _PARTS
            for i, row in enumerate(getattr(self, name))
            for j, value in enumerate(row)
            if value != 0
        }

    def with_values(self, values: Mapping[str, float]) -> MatrixImpedance:
        """The impedance with other values (SI) of its entries, such as "stiffness_1_2".

        raises ModelError: there is no such entry, or it is zero now
        """
        known = self.parameters
        for name in values:
            if name not in known:
                raise ModelError(f'impedance: no entry "{name}"{did_you_mean(name, known)}')
        changed = {}
        for part in _PARTS:
            matrix = np.array(getattr(self, part))
            for name, value in values.items():
                of, i, j = name.rsplit("_", 2)
                if of == part:
                    matrix[int(i) - 1, int(j) - 1] = value
            changed[part] = _rows(matrix)
        return replace(self, **changed)

    def forces(
        self,
        motions: Sequence[tuple[sp.Expr, sp.Expr, sp.Expr]],
        symbol: Callable[[str], sp.Symbol],
    ) -> list[sp.Expr]:
        """Force along each motion, as expressions.

        motions: position, velocity, acceleration of each;  symbol: name of a parameter -> its
            symbol
        """
        total = [sp.S(0)] * self.size
        for name in self.parameters:
            of, i, j = name.rsplit("_", 2)
            rate = motions[int(j) - 1][_PARTS[of]]
            total[int(i) - 1] += symbol(name) * rate
        return total

    def entry(self, row: int, column: int, s: sp.Symbol) -> sp.Expr:
        """Z_ij(s); row and column count from 0."""
        return sp.Add(*(getattr(self, p)[row][column] * s**k for p, k in _PARTS.items()))

    def over(self, s: np.ndarray) -> np.ndarray:
        """Z at complex s (n,): (n, size, size)."""
        powers = {p: s[:, None, None] ** k for p, k in _PARTS.items()}
        return np.asarray(sum(powers[p] * np.array(getattr(self, p)) for p in _PARTS))


#: matrix -> the derivative of the motion that it multiplies
_PARTS = {"stiffness": 0, "damping": 1, "mass": 2}
assert {f.name for f in fields(MatrixImpedance)} == set(_PARTS)


def matrix_impedance(
    *, mass: Any = 0.0, damping: Any = 0.0, stiffness: Any = 0.0
) -> MatrixImpedance:
    """An impedance from square matrices, or from numbers for the whole diagonal.

    mass, damping, stiffness: SI; at least one of them a matrix
    raises ModelError: an argument is no matrix or number, or sizes differ
    """
    matrices = {"mass": mass, "damping": damping, "stiffness": stiffness}
    for name, matrix in matrices.items():
        _refuse_other(matrix, name)
    sizes = {len(np.atleast_2d(m)) for m in matrices.values() if np.ndim(m) == 2}
    if len(sizes) != 1:
        shapes = ", ".join(f"{n} {np.shape(m)}" for n, m in matrices.items())
        raise ModelError(f"impedance: expected square matrices of one size, found {shapes}")
    size = sizes.pop()
    full = {n: m if np.ndim(m) == 2 else float(m) * np.eye(size) for n, m in matrices.items()}
    return MatrixImpedance(**{n: _rows(np.asarray(m, dtype=float)) for n, m in full.items()})


def _refuse_other(matrix: Any, name: str) -> None:
    """Refuse an argument that is neither a number nor a matrix of numbers."""
    try:
        array = np.asarray(matrix)
        right = array.dtype.kind in "iuf" and array.ndim in (0, 2) and bool(np.all(array == array))
    except (ValueError, TypeError):  # rows of different lengths
        right = False
    if not right:
        raise ModelError(
            f"impedance: {name}: found {describe_value(matrix)}, "
            "expected a square matrix, or a number "
            "for its diagonal"
        )


def _rows(matrix: np.ndarray) -> MatrixRows:
    return tuple(tuple(float(x) for x in row) for row in matrix)
