"""The laws of a computer along its passes: what a search for their effects needs of any cut."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..effects.of_blocks.controllers import ControlEffect
from ..measurement.filtering import Array
from .computer import ComputerPart, Passes, Placed, velocity_of
from .cuts import COMPUTER


@dataclass(frozen=True)
class ControlFit:
    """Effects of the computer with their values, and what they leave.

    shift: rows by which the log of the command is late
    residual: use -> residual over the rms of the signal, so that its squares add up to those of
        the errors;  blocks: use -> number of the block of each row
    errors: use -> cut -> relative error;  stderr: of each value, SI
    """

    placed: tuple[Placed, ...]
    shift: int
    residual: dict[str, Array]
    errors: dict[str, dict[str, float]]
    stderr: tuple[float, ...] = ()

    def error(self, use: str) -> float:
        """Root mean square of the errors of the cuts."""
        return float(np.sqrt(np.mean(np.square(list(self.errors[use].values())))))

    @property
    def squares(self) -> float:
        return float(np.sum(self.residual["fit"] ** 2))


@dataclass(frozen=True, eq=False)
class ScaledValues:
    """Values of k effects over their units, as coordinates of a search."""

    placed: tuple[Placed, ...]
    unit: Array

    def at(self, x: Array) -> tuple[Placed, ...]:
        """The effects at other coordinates (k,)."""
        values = (x * self.unit).tolist()
        pairs = zip(self.placed, values, strict=True)
        return tuple(Placed(p.effect, p.at, v) for p, v in pairs)

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Lower and upper bounds of the coordinates."""
        declared = [p.effect.declared for p in self.placed]
        lower = np.array([d.lower for d in declared]) / self.unit
        return lower, np.array([d.upper for d in declared]) / self.unit

    @property
    def start(self) -> Array:
        """Their coordinates, slightly inside the bounds."""
        lower, upper = self.bounds
        values = np.array([p.value for p in self.placed]) / self.unit
        return np.clip(values, lower + 1e-9, upper - 1e-9)


class ControlRows(ABC):
    """The controllers of some cuts, and the rows at which the computer passed, a log after another.

    places: blocks at which an effect may act
    """

    @property
    @abstractmethod
    def blocks(self) -> Mapping[str, NDArray[np.intp]]:
        """Use -> number of the block of each row of the residuals."""

    @abstractmethod
    def base(self) -> ControlFit:
        """The laws as stated, their free parameters estimated."""

    @abstractmethod
    def estimate(self, before: ControlFit, effect: ControlEffect, at: str) -> ControlFit:
        """The best values of an effect and those before it."""

    def __init__(self, part: ComputerPart, rows: Sequence[Passes]) -> None:
        self.part, self.rows = part, tuple(rows)
        self.places = part.places

    def samples(self, at: str) -> Array:
        """Samples on which an effect acts: the command, or what a block makes of recorded rows."""
        name = self._signal(at)
        return np.concatenate([self.part.value(r, name) for r in self.rows])

    def is_candidate(self, effect: str, at: str) -> bool:
        """Whether an effect of a block is a candidate."""
        return True

    def _signal(self, at: str) -> str:
        if at == COMPUTER:
            return next(c.signal for c in self.part.cuts if COMPUTER in c.blocks)
        return self.part.diagram.block(at).outputs[0]

    def coordinates(self, placed: Sequence[Placed]) -> ScaledValues:
        """The values of effects as coordinates of a search."""
        return ScaledValues(tuple(placed), np.array([self._unit(p) for p in placed]))

    def _unit(self, placed: Placed) -> float:
        """Scale of a value in a fit: its own size, or a hundredth of what the effect acts on."""
        return abs(placed.value) or 0.01 * float(np.abs(self.samples(placed.at)).max(initial=1e-9))

    def blind(self, one: Placed, placed: Sequence[Placed]) -> float:
        """Share of the moving rows in which the law behind an effect has no influence."""
        if one.effect.passes is None:
            return 0.0
        others = [p for p in placed if p.key != one.key]
        moving, passing = [], []
        for r in self.rows:
            samples = self.part.value(r, self._signal(one.at), others)
            motions = [s for s in r.signals if self.part.diagram.is_position(s)]
            moves = np.any([velocity_of(r.signals[s], r.period) != 0 for s in motions], axis=0)
            moving.append(moves | (not motions))
            passing.append(one.effect.passes(samples, one.value))
        where = np.concatenate(moving)
        return 1.0 - float(np.mean(np.concatenate(passing)[where])) if where.any() else 0.0
