"""Residuals of several bodies, computed separately; a body that hardly changed is not recomputed.

Along measured motions the bodies of a model do not interact: the residual of a body depends on its
parameters alone. A search at one body needs no tangents of the other bodies, and in a fit the
parameters of the other bodies soon stop changing.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..measurement.filtering import Array
from ..measurement.prepare import Stretch
from ..model import Model
from ..realise.tangent_columns import Probe
from .residual import relative_residuals
from .search_plan import EFFORTS


@dataclass(frozen=True, eq=False)
class Apart:
    """Stretches of some bodies whose parameters act on no other body.

    rows: indices of these stretches' rows among the rows of all stretches
    bodies: names of the bodies that the stretches belong to
    """

    stretches: tuple[Stretch, ...]
    rows: NDArray[np.intp]
    bodies: frozenset[str]

    def relative(self, model: Model, names: Sequence[str | Probe]) -> tuple[Array, Array]:
        """Weighted `relative_residuals` (rows,) and their derivatives (rows, p)."""
        parts = relative_residuals(model, self.stretches, names)
        roots = [np.sqrt(s.weight) for s in self.stretches]
        residual = np.concatenate([w * r for w, (r, _) in zip(roots, parts, strict=True)])
        slopes = np.concatenate([w * d for w, (_, d) in zip(roots, parts, strict=True)], axis=1)
        return residual, slopes.T


def separate_bodies(stretches: Sequence[Stretch]) -> tuple[Apart, ...]:
    """The stretches of each body; all together where an arm's shared link parameters join them."""
    names = list(dict.fromkeys(s.motion.body for s in stretches))
    if any(s.shared is not None for s in stretches):
        return (_select_stretches(stretches, names),)
    return tuple(_select_stretches(stretches, [name]) for name in names)


def select_bodies(stretches: Sequence[Stretch], bodies: Collection[str]) -> Apart:
    """The stretches of these bodies, and of the bodies that are joined to them."""
    joined = (part.bodies for part in separate_bodies(stretches) if part.bodies & set(bodies))
    return _select_stretches(stretches, frozenset().union(*joined))


def _select_stretches(stretches: Sequence[Stretch], bodies: Collection[str]) -> Apart:
    mine = np.concatenate([np.full(len(s.keep), s.motion.body in bodies) for s in stretches])
    here = tuple(s for s in stretches if s.motion.body in bodies)
    return Apart(here, np.flatnonzero(mine), frozenset(bodies))


@dataclass(frozen=True, eq=False)
class _Point:
    """A computed point of a body, in search coordinates, with its residual.

    slopes: computes the Jacobian there
    """

    x: Array
    residual: Array
    slopes: Callable[[], Array]

    @cached_property
    def jacobian(self) -> Array:
        """Derivatives of the residual by the coordinates, computed where they are asked for."""
        return self.slopes()

    def follow(self, x: Array, tolerance: float) -> Array | None:
        """The residual at a point near by, along the tangents; None where they may not lead there.

        tolerance: relative change of the squares that a fit resolves
        """
        sizes = np.maximum(np.abs(self.x), 1.0)
        if np.any(np.abs(x - self.x) > EFFORTS.followed_within * sizes):
            return None
        change = self.jacobian @ (x - self.x)
        largest = EFFORTS.followed * tolerance * float(self.residual @ self.residual)
        return self.residual + change if float(change @ change) <= largest else None


class BodyByBody:
    """Residual (rows,) and Jacobian (rows, p) of all stretches, by the last points of each body.

    names: the p parameters and shifts
    tolerance: relative change of the squares that a fit resolves
    Its functions take a model, its parameters in search coordinates (p,), and the units of these
    coordinates (p,).
    """

    def __init__(
        self, model: Model, names: Sequence[str], stretches: Sequence[Stretch], *, tolerance: float
    ) -> None:
        self._parts = separate_bodies(stretches)
        self._names, self._tolerance = names, tolerance
        places = [model.locate(name)[0] for name in names]
        self._columns = [np.flatnonzero([p in b.bodies for p in places]) for b in self._parts]
        self._rows = sum(len(part.rows) for part in self._parts)
        self._last: dict[int, _Point] = {}

    def both(self, model: Model, x: Array, units: Array) -> tuple[Array, Array]:
        """Residual and Jacobian."""
        residual, jacobian = np.empty(self._rows), np.zeros((len(self._names), self._rows)).T
        for i, (part, mine) in enumerate(zip(self._parts, self._columns, strict=True)):
            followed, point = self._at(i, model, x[mine], units[mine], slopes=True)
            residual[part.rows] = followed
            jacobian[np.ix_(part.rows, mine)] = point.jacobian
        return residual, jacobian

    def residual(self, model: Model, x: Array, units: Array) -> Array:
        """The residual alone, the same as that of `both`."""
        residual = np.empty(self._rows)
        for i, (part, mine) in enumerate(zip(self._parts, self._columns, strict=True)):
            residual[part.rows], _ = self._at(i, model, x[mine], units[mine], slopes=False)
        return residual

    def _at(
        self, i: int, model: Model, x: Array, units: Array, *, slopes: bool
    ) -> tuple[Array, _Point]:
        """Residual of one body, and the point whose tangents hold there.

        slopes: whether they are computed with the residual, at once
        """
        known = self._last.get(i)
        # not for a single body, which is the whole fit
        if known is not None and len(self._parts) > 1:
            followed = known.follow(x, self._tolerance)
            if followed is not None:
                return followed, known
        names = [self._names[int(k)] for k in self._columns[i]]
        part = self._parts[i]
        if slopes:
            residual, columns = part.relative(model, names)
            jacobian = columns * units
            known = _Point(x, residual, lambda: jacobian)
        else:
            residual, _ = part.relative(model, ())
            known = _Point(x, residual, lambda: part.relative(model, names)[1] * units)
        self._last[i] = known
        return residual, known
