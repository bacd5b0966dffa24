"""Residuals of several bodies, computed separately; a body that hardly changed is not recomputed.

Along measured motions the bodies of a model do not interact: the residual of a body depends on its
parameters alone. A search at one body needs no tangents of the other bodies, and in a fit the
parameters of the other bodies soon stop changing.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..measurement.filtering import Array
from ..model import Model
from ..realise.traced import Probe
from .effort import EFFORTS
from .prepare import Stretch
from .residual import relative_residuals


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
        slopes = np.concatenate([w * d.T for w, (_, d) in zip(roots, parts, strict=True)])
        return residual, slopes


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
class _Memory:
    """The last computed point of a body, in search coordinates, with its residual and Jacobian."""

    x: Array
    residual: Array
    jacobian: Array


def _is_near(x: Array, other: Array) -> bool:
    """Whether the tangents at one point may be used to extrapolate to the other."""
    sizes = np.maximum(np.abs(other), 1.0)
    return bool(np.all(np.abs(x - other) <= EFFORTS.followed_within * sizes))


def body_by_body(
    model: Model, names: Sequence[str], stretches: Sequence[Stretch], *, tolerance: float
) -> Callable[[Model, Array, Array], tuple[Array, Array]]:
    """A function that returns residual (rows,) and Jacobian (rows, p) of all stretches.

    names: the p parameters and shifts
    tolerance: relative change of the squares that a fit resolves
    The function takes a model, its parameters in search coordinates (p,), and the units of these
    coordinates (p,).
    """
    parts = separate_bodies(stretches)
    places = [model.locate(name)[0] for name in names]
    columns = [np.flatnonzero([p in part.bodies for p in places]) for part in parts]
    count = sum(len(part.rows) for part in parts)
    memory: dict[int, _Memory] = {}

    def here(i: int, there: Model, x: Array, units: Array) -> tuple[Array, Array]:
        known = memory.get(i)
        # not for a single body, which is the whole fit; nor far away, where the residual bends
        if known is not None and len(parts) > 1 and _is_near(x, known.x):
            change = known.jacobian @ (x - known.x)
            largest = EFFORTS.followed * tolerance * float(known.residual @ known.residual)
            if float(change @ change) <= largest:
                return known.residual + change, known.jacobian
        residual, slopes = parts[i].relative(there, [names[int(k)] for k in columns[i]])
        memory[i] = _Memory(x, residual, slopes * units)
        return memory[i].residual, memory[i].jacobian

    def all_bodies(there: Model, x: Array, units: Array) -> tuple[Array, Array]:
        residual, jacobian = np.empty(count), np.zeros((count, len(names)))
        for i, part in enumerate(parts):
            mine = columns[i]
            residual[part.rows], slopes = here(i, there, x[mine], units[mine])
            jacobian[np.ix_(part.rows, mine)] = slopes
        return residual, jacobian

    return all_bodies
