"""Residuals of some bodies of several, with all weights.

Along measured motions the bodies of a model do not interact: the residual of a body depends on its
parameters alone. A search at one body needs neither residual nor tangents of the others.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..measurement.filtering import Array
from ..measurement.prepare import Stretch
from ..model import Model
from ..realise.tangent_columns import Probe
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
        slopes = np.concatenate([w * d for w, (_, d) in zip(roots, parts, strict=True)], axis=1)
        return residual, slopes.T


def separate_bodies(stretches: Sequence[Stretch]) -> tuple[Apart, ...]:
    """The stretches of each body; all together where an arm's shared link parameters join them."""
    names = list(dict.fromkeys(s.motion.body for s in stretches))
    if any(s.shared is not None for s in stretches):
        return (_select_stretches(stretches, names),)
    return tuple(_select_stretches(stretches, [name]) for name in names)


def all_bodies(stretches: Sequence[Stretch]) -> Apart:
    """All stretches together."""
    return _select_stretches(stretches, [s.motion.body for s in stretches])


def select_bodies(stretches: Sequence[Stretch], bodies: Collection[str]) -> Apart:
    """The stretches of these bodies, and of the bodies that are joined to them."""
    joined = (part.bodies for part in separate_bodies(stretches) if part.bodies & set(bodies))
    return _select_stretches(stretches, frozenset().union(*joined))


def _select_stretches(stretches: Sequence[Stretch], bodies: Collection[str]) -> Apart:
    mine = np.concatenate([np.full(len(s.keep), s.motion.body in bodies) for s in stretches])
    here = tuple(s for s in stretches if s.motion.body in bodies)
    return Apart(here, np.flatnonzero(mine), frozenset(bodies))
