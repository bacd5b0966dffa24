"""Cases side by side that run at once, those of coarse grids beside those of finer ones."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from .setup import Setup

if TYPE_CHECKING:
    from ..realise.side_by_side import GridRun

#: steps a sample, and delay of each late signal, s
GridKey = tuple[int, tuple[float, ...]]

#: numbers in the tables of inputs of grids that run at once: 0.4 GB
_MOST_AT_ONCE = 50_000_000


@dataclass(frozen=True)
class Wave:
    """Cases that run at once, so that the few that need fine steps leave no core without work.

    todo: grid -> its cases, by their numbers in a group
    is_first: no run has asked for these grids
    """

    todo: Mapping[GridKey, list[int]]
    is_first: bool

    def split(self, setup: Setup) -> tuple[Wave, Wave]:
        """The coarsest grids, as many as tables of inputs leave room for, and all others."""
        now: dict[GridKey, list[int]] = {}
        numbers = 0
        for grid in sorted(self.todo):
            numbers += setup.table_size(setup.timing(*grid))
            if now and numbers > _MOST_AT_ONCE:
                break
            now[grid] = self.todo[grid]
        later = {grid: members for grid, members in self.todo.items() if grid not in now}
        return replace(self, todo=now), replace(self, todo=later)

    def runs(self, setup: Setup, numbers: np.ndarray) -> list[GridRun]:
        """A run on each grid; one that a run before asked for may end at its limit.

        numbers: (cases of the group, parameters of the layout)
        """
        from ..realise.side_by_side import GridRun

        runs = []
        for (inner, delays), members in self.todo.items():
            timing = setup.timing(inner, delays)
            limit = math.inf if self.is_first else setup.ladder("refine", delays).limit(inner)
            tables = setup.arguments(timing)
            table = numbers[members]
            runs.append(GridRun(table, timing, tables["inputs"], tables["sampled"], limit))
        return runs
