"""The links of an arm in the fit of one joint: information from other joints, and what stays free.

The base parameters b of an arm act at all of its joints, and force is linear in them. The
information of the other joints on b is a quadratic, (b - c)^T H (b - c) with centre c, when their
other parameters are free. So a joint can be compared alone: to minimise

    |r - Y (b - c)|^2 + (b - c)^T H (b - c)        over b,     Y: force of its links per unit of b

is to minimise |W r|^2 with W = (1 + Y H^-1 Y^T)^(-1/2). A direction of the residual r that the
links can cause counts less, and not at all where no other joint has information on it. W differs
from the identity in at most as many directions as there are base parameters. Squares of each joint
are relative to its measured squares.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ..base.frozen import ByValue
from .filtering import Array

if TYPE_CHECKING:
    from .prepare import Stretch

#: eigenvalue of the scaled information matrix, over the largest one, below which a direction is not
#: determined: far above rounding, and far below the value of any parameter that a record determines
UNKNOWN = 1e-10


@dataclass(frozen=True, eq=False)
class Knowledge(ByValue):
    """Information of joints on the base parameters: squares b^T matrix b - 2 vector^T b.

    matrix: (b, b);  vector: (b,)
    """

    matrix: Array
    vector: Array

    def __add__(self, other: Knowledge) -> Knowledge:
        return Knowledge(self.matrix + other.matrix, self.vector + other.vector)

    def best(self) -> Array:
        """The base parameters (b,) with the least squares; 0 in directions without information."""
        centre, _ = _split_knowledge(self, np.diag(self.matrix))
        return centre


def _split_knowledge(knowledge: Knowledge, squares: Array) -> tuple[Array, Array]:
    """Centre (b,), and directions (b, b) of unit spread: long where there is little information.

    squares: (b,) squared scale of each base parameter
    """
    size = np.sqrt(np.where(squares > 0, squares, 1.0))
    scaled = knowledge.matrix / np.outer(size, size)
    values, vectors = np.linalg.eigh(0.5 * (scaled + scaled.T))
    least = UNKNOWN * max(float(values[-1]), 1.0)
    is_known = values > least
    inverse = np.where(is_known, 1.0 / np.where(is_known, values, 1.0), 0.0)
    centre = vectors @ (inverse * (vectors.T @ (knowledge.vector / size))) / size
    return centre, (vectors / np.sqrt(np.maximum(values, least))) / size[:, None]


@dataclass(frozen=True, eq=False)
class Shared(ByValue):
    """Data that removes the estimated link parameters from the residuals on one stretch.

    others: information of the other joints;  size: scale of the joint's force against theirs
    columns: (rows, b) low-passed force per base parameter, times the root of the rows' weight
    basis: (rows, m) directions common to all stretches
    less: (m,) by which each direction counts less
    back: (b, m) base parameters per residual in each direction;  centre: (b,)
    """

    others: Knowledge
    size: float
    columns: Array
    basis: Array
    less: Array
    back: Array
    centre: Array


def share(stretches: Sequence[Stretch], others: Knowledge, size: float) -> tuple[Stretch, ...]:
    """The stretches of one joint, each with `Shared` to remove the link parameters from residuals.

    others: information of the other joints
    size: root of the measured squares of the joint
    """
    columns = [weighted_columns(s) for s in stretches]
    all_rows = np.vstack(columns) / size
    centre, spread = _split_knowledge(others, np.diag(others.matrix) + np.sum(all_rows**2, axis=0))
    whole = all_rows @ spread
    basis, s, turned = np.linalg.svd(whole, full_matrices=False)
    less = 1.0 - 1.0 / np.sqrt(1.0 + s**2)
    back = spread @ turned.T * (s / (1.0 + s**2)) / size
    parts = np.split(basis, np.cumsum([len(c) for c in columns])[:-1])
    return tuple(
        replace(s, shared=Shared(others, size, c, u, less, back, centre))
        for s, c, u in zip(stretches, columns, parts, strict=True)
    )


def share_again(stretches: Sequence[Stretch]) -> tuple[Stretch, ...]:
    """Stretches whose rows have changed, with new `Shared` data."""
    first = stretches[0].shared if stretches else None
    return tuple(stretches) if first is None else share(stretches, first.others, first.size)


def weighted_columns(stretch: Stretch) -> Array:
    """Low-passed force per base parameter (rows, b), times the root of the rows' weight."""
    assert stretch.motion.links is not None
    return np.asarray(np.sqrt(stretch.weight) * stretch.motion.links.smooth[:, stretch.keep].T)


def clear(
    links: tuple[float, ...], stretches: Sequence[Stretch], parts: list[tuple[Array, Array]]
) -> list[tuple[Array, Array]]:
    """Residuals (rows) and tangents (p, rows), with reduced weight in the directions of the links.

    links: base parameters at which the residuals were computed
    """
    mine = [i for i, s in enumerate(stretches) if s.shared is not None]
    if not mine:
        return parts
    rows = [np.vstack([parts[i][0][None], parts[i][1]]) for i in mine]
    whole = np.zeros((len(rows[0]), 0))
    for i, row in zip(mine, rows, strict=True):
        shared = stretches[i].shared
        assert shared is not None
        row = np.sqrt(stretches[i].weight) * row
        row[0] += shared.columns @ (np.asarray(links) - shared.centre)
        whole = np.hstack([whole, row])
    first = stretches[mine[0]].shared
    assert first is not None
    basis = np.vstack([s.shared.basis for s in stretches if s.shared is not None])
    whole = whole - (whole @ basis * first.less) @ basis.T
    cleared, start = list(parts), 0
    for i, row in zip(mine, rows, strict=True):
        here = whole[:, start : start + row.shape[1]] / np.sqrt(stretches[i].weight)
        cleared[i], start = (here[0], here[1:]), start + row.shape[1]
    return cleared


def best_links(
    links: tuple[float, ...], stretches: Sequence[Stretch], residuals: Sequence[Array]
) -> tuple[float, ...]:
    """The base parameters that leave least of these residuals, which were computed at `links`."""
    change, centre = np.zeros(len(links)), np.asarray(links)
    for stretch, residual in zip(stretches, residuals, strict=True):
        shared = stretch.shared
        if shared is None:
            continue
        centre = shared.centre
        moved = np.sqrt(stretch.weight) * residual + shared.columns @ (np.asarray(links) - centre)
        change = change + shared.back @ (shared.basis.T @ moved)
    return tuple(float(x) for x in centre + change)
