"""Many simulations of one structure side by side: blocks of lanes over all cores.

A block runs without Python's lock, with the same loop and laws as one simulation (`integrator.py`);
blocks share no memory that is written. Numbers differ from those of one simulation by rounding,
because exp is computed differently (`lane_exp.py`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

import numpy as np

from ..base.errors import ModelError
from ..base.machine import count_workers
from .kernel import Timing, fastest_rates, first_memory, grid, slopes_at_rest
from .program import CompiledLoop, Program, loop_of

#: simulations of a block that run in one loop (lanes): with 8, each takes twice the time; with 32,
#: a tenth less, but more cases are needed to fill a block
LANES = 16

#: cases whose rates at rest are computed by one thread at a time
_CASES_OF_RATES = 1024

Result = TypeVar("Result")

#: reduction -> number by which the loop knows it (`integrator.keep`), and where it starts
KINDS: Mapping[str, tuple[int, float]] = {
    "final": (0, 0.0),
    "maximum": (1, -np.inf),
    "minimum": (2, np.inf),
    "peak": (3, 0.0),
    "mean": (4, 0.0),
    "rms": (5, 0.0),
    "energy": (6, 0.0),
}


@dataclass(frozen=True)
class Reduction:
    """A number computed from a signal over time.

    kind: of `KINDS`;  column: of the program;  other: for "energy" the column of the velocity
    """

    kind: str
    column: int
    other: int = 0


@dataclass(frozen=True)
class GridRun:
    """Cases that run on one grid of steps.

    parameters: (cases, parameters of the layout);  inputs, sampled, limit: as in `kernel.execute`
    """

    parameters: np.ndarray
    timing: Timing
    inputs: np.ndarray
    sampled: np.ndarray
    limit: float = math.inf


@dataclass(frozen=True)
class LaneResults:
    """Results of simulations side by side, case by case.

    kept: (cases, rows, requested columns);  reduced: (cases, reductions)
    worst: measure of the reload of bristles (see `kernel`)
    is_finite: whether all signals remained finite
    """

    kept: np.ndarray
    reduced: np.ndarray
    worst: np.ndarray
    is_finite: np.ndarray


def lanes_of(made: Program) -> CompiledLoop:
    """The loop of this program for a block of lanes.

    raises ModelError: a block is known as code only
    """
    refuse_code(made)
    return loop_of(made.laws, LANES)


def refuse_code(made: Program) -> None:
    """Raise ModelError if a block is known as code only, which cannot run side by side."""
    if made.has_code:
        raise ModelError(
            "simulate_many: a nonlinear python-control system is code, which no lanes run side by "
            "side: simulate one after the other"
        )


def rates_of_cases(made: Program, parameters: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Fastest rate at rest (1/s) of each case, and index of the state with the largest part in it.

    parameters: (cases, parameters of the layout)
    """
    loop = lanes_of(made)
    if not made.layout.states:
        return np.zeros(len(parameters)), np.zeros(len(parameters), dtype=int)

    def rates(first: int) -> tuple[np.ndarray, np.ndarray]:
        here = parameters[first : first + _CASES_OF_RATES]
        slopes = [
            slopes_at_rest(made, loop, _arrange_in_lanes(here[lane : lane + LANES], LANES))
            for lane in range(0, len(here), LANES)
        ]
        return fastest_rates(np.concatenate(slopes)[: len(here)])

    blocks = _spread_over_threads(
        [partial(rates, first) for first in range(0, len(parameters), _CASES_OF_RATES)]
    )
    largest, states = (np.concatenate(part) for part in zip(*blocks, strict=True))
    return largest, states


def execute_many(
    made: Program,
    runs: Sequence[GridRun],
    *,
    start: Mapping[str, float],
    kept: Sequence[int],
    reductions: Sequence[Reduction],
    begin: int,
) -> list[LaneResults]:
    """Run cases, each on its grid; all blocks of all grids share the cores.

    start: as in `kernel.execute`, for all cases;  kept: columns whose rows are returned
    begin: first row that is reduced
    """
    request = LaneRequest(start, kept, reductions, begin)
    results = [request.empty_results(run) for run in runs]
    blocks = [
        (run.timing.steps, partial(_run_block, made, run, request, result, first))
        for run, result in zip(runs, results, strict=True)
        for first in range(0, len(run.parameters), LANES)
    ]
    # the longest first: the cores then end at about the same time
    _spread_over_threads([block for _, block in sorted(blocks, key=lambda b: -b[0])])
    scale_sums(runs, results, request)
    return results


@dataclass(frozen=True)
class LaneRequest:
    """Start and results of all runs: arguments of `execute_many`."""

    start: Mapping[str, float]
    kept: Sequence[int]
    reductions: Sequence[Reduction]
    begin: int

    def empty_results(self, run: GridRun) -> LaneResults:
        """Arrays for the results of a run."""
        cases, rows = len(run.parameters), run.timing.samples + 1
        return LaneResults(
            np.empty((cases, rows, len(self.kept))),
            np.empty((cases, len(self.reductions))),
            np.empty(cases),
            np.empty(cases, dtype=bool),
        )

    def first_sums(self, lanes: int) -> np.ndarray:
        """Where each reduction starts, in each lane."""
        return np.repeat([KINDS[r.kind][1] for r in self.reductions], lanes).astype(float)


def _run_block(
    made: Program, run: GridRun, request: LaneRequest, result: LaneResults, first: int
) -> None:
    """Run the block of cases that starts with case `first`, and write their results."""
    here = slice(first, min(first + LANES, len(run.parameters)))
    columns, timing, used = made.functions["COLUMNS"], run.timing, here.stop - first
    rows, kept, loop = timing.samples + 1, request.kept, lanes_of(made)
    lanes = loop.lanes
    parameters = _arrange_in_lanes(run.parameters[here], lanes)
    memory = first_memory(made, lanes, parameters, request.start)
    sums = request.first_sums(lanes)
    out = np.empty(rows * len(kept) * lanes)
    loop.run(
        *grid(made, timing, lanes),
        False,
        run.inputs,
        run.sampled,
        memory,
        lanes * (columns + np.array(kept, dtype=np.int64)),
        out,
        run.limit,
        request.begin,
        *reduction_arrays(columns, request.reductions, lanes),
        sums,
    )
    table = memory.reshape(-1, lanes)[:, :used]
    worst_rows = made.functions["WORST"] + np.arange(len(made.layout.exponential))
    result.kept[here] = np.moveaxis(out.reshape(rows, len(kept), lanes), -1, 0)[:used]
    result.reduced[here] = sums.reshape(-1, lanes)[:, :used].T
    result.worst[here] = table[worst_rows].max(axis=0, initial=0.0)
    result.is_finite[here] = np.isfinite(table[made.functions["SPOILED"]])


def _spread_over_threads(blocks: Sequence[Callable[[], Result]]) -> list[Result]:
    """The results of the blocks, in their order."""
    if len(blocks) == 1 or count_workers() == 1:
        return [block() for block in blocks]
    with ThreadPoolExecutor(count_workers()) as threads:
        return [running.result() for running in [threads.submit(block) for block in blocks]]


def reduction_arrays(
    first: int, reductions: Sequence[Reduction], lanes: int
) -> tuple[np.ndarray, ...]:
    """Kinds, columns and other columns of the reductions, as the loop takes them."""
    kinds = [KINDS[r.kind][0] for r in reductions]
    columns = [lanes * (first + r.column) for r in reductions]
    others = [lanes * (first + r.other) for r in reductions]
    return tuple(np.array(x, dtype=np.int64) for x in (kinds, columns, others))


def _arrange_in_lanes(parameters: np.ndarray, lanes: int) -> np.ndarray:
    """Parameters of at most a block of cases, row by row; empty lanes repeat the last case."""
    cases = np.minimum(np.arange(lanes), len(parameters) - 1)
    return np.ascontiguousarray(parameters[cases].T).reshape(-1)


def scale_sums(
    runs: Sequence[GridRun], results: Sequence[LaneResults], request: LaneRequest
) -> None:
    """Divide the sums over samples, so that they are means and integrals."""
    for run, result in zip(runs, results, strict=True):
        rows = run.timing.samples + 1 - request.begin
        for i, reduction in enumerate(request.reductions):
            sums = result.reduced[:, i]
            result.reduced[:, i] = _scale(reduction.kind, sums, rows, run.timing)


def _scale(kind: str, sums: np.ndarray, rows: int, timing: Timing) -> np.ndarray:
    if kind == "mean":
        return sums / rows
    if kind == "rms":
        return np.sqrt(sums / rows)
    return sums * timing.period if kind == "energy" else sums
