"""Cases that run at the same time, those on coarse grids beside those on fine grids."""

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
    """Cases that run at the same time, so that the few with fine steps leave no core without work.

    todo: grid -> indices of its cases in a group
    is_first: True: these grids are not refined after another run
    """

    todo: Mapping[GridKey, list[int]]
    is_first: bool

    def split(self, setup: Setup) -> tuple[Wave, Wave]:
        """The coarsest grids, as many as the memory for input tables allows, and all others."""
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
        """One run for each grid; a refined run may stop at its limit.

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
