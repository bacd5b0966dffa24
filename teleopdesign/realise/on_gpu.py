"""Many simulations of one structure on an NVIDIA GPU: a thread for each case.

The loop and the laws are those of one simulation (`integrator.py`), with the same steps. Numbers
differ from those of the lanes (`side_by_side.py`) by rounding, because exp and sums of products are
rounded differently.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from importlib.metadata import version
from importlib.util import find_spec
from typing import Any

import numpy as np

from ..base.errors import ModelError
from ._gpu_source import KERNEL, gpu_source
from .compiled import compiled_module
from .kernel import LoopGrid, first_memory, grid
from .program import Program
from .side_by_side import (
    GridRun,
    LaneRequest,
    LaneResults,
    Reduction,
    execute_many,
    reduction_arrays,
    refuse_code,
    scale_sums,
)

#: threads of a block. A thread needs some 200 registers, so a processor of the GPU has room for 300
#: threads, which small blocks fill better
THREADS = 64
#: cases of a grid that run on a GPU: fewer would hold up the others, for each of its threads is far
#: slower than a core
FEWEST = 256
#: streams, in which grids run at the same time: one grid seldom fills the GPU
_STREAMS = 32
#: part of the free memory that is used
_USED = 0.8
_RINGS = ("held", "before", "after", "past")


def check_gpu() -> None:
    """Raise ModelError if no GPU can be used."""
    if _is_simulated():
        return
    if find_spec("numba_cuda") is None:
        raise ModelError(
            "simulate_many: device \"cuda\" needs numba-cuda: pip install 'teleopdesign[cuda]'"
        )
    try:
        from numba import cuda
    except Exception as error:  # a release that does not go with the installed numpy or numba
        raise ModelError(
            f'simulate_many: device "cuda": numba-cuda {version("numba-cuda")} cannot be imported '
            f"beside numpy {version('numpy')} and numba {version('numba')} "
            f"({type(error).__name__}: {error}): pip install 'teleopdesign[cuda]' installs "
            "versions that go together"
        ) from error
    if not cuda.is_available():
        why = " ".join(str(cuda.cuda_error() or "its driver lists none").split())
        raise ModelError(
            f'simulate_many: device "cuda": expected an NVIDIA GPU, found none ({why})'
        )


def execute_on_gpu(
    made: Program,
    runs: Sequence[GridRun],
    *,
    start: Mapping[str, float],
    kept: Sequence[int],
    reductions: Sequence[Reduction],
    begin: int,
) -> list[LaneResults]:
    """Run cases, each on its grid, as `execute_many` does; grids run at the same time.

    Grids of fewer than `FEWEST` cases run on the cores.
    raises ModelError: a block is known as code only, or one case needs more memory than the GPU has
    """
    refuse_code(made)
    request = LaneRequest(start, kept, reductions, begin)
    many = [run for run in runs if len(run.parameters) >= FEWEST]
    few = [run for run in runs if len(run.parameters) < FEWEST]
    on_gpu = iter(_execute_grids(made, many, request) if many else ())
    on_cores = iter(execute_many(made, few, **vars(request)) if few else ())
    return [next(on_gpu if len(run.parameters) >= FEWEST else on_cores) for run in runs]


def _execute_grids(
    made: Program, runs: Sequence[GridRun], request: LaneRequest
) -> list[LaneResults]:
    """Run cases of several grids on the GPU, as many at a time as its memory holds."""
    from numba import cuda

    results = [request.empty_results(run) for run in runs]
    memory = _USED * cuda.current_context().get_memory_info()[0]
    parts = [
        part
        for run, result in zip(runs, results, strict=True)
        for part in _Part(made, run, request, result, slice(0, len(run.parameters))).split(memory)
    ]
    # the longest first: the others run beside it
    parts.sort(key=lambda part: -part.run.timing.steps)
    streams = [cuda.stream() for _ in range(min(len(parts), _STREAMS))]
    running: list[_Running] = []
    room = memory
    for part in parts:
        if part.bytes > room:
            _collect(running)
            room = memory
        running.append(part.launch(streams[len(running) % len(streams)]))
        room -= part.bytes
    _collect(running)
    scale_sums(runs, results, request)
    return results


@dataclass(frozen=True)
class _Running:
    """A kernel that was started, and its results in the memory of the GPU.

    results: rows that are kept, reductions, measure of the reload, mark of signals that are not
        finite, each (entries, cases) or (cases,);  in_use: what must not be freed before the end
    """

    part: _Part
    stream: Any
    results: tuple[Any, ...]
    in_use: list[Any]

    def store(self) -> None:
        """Wait for the kernel, and copy its results."""
        result, here, kept = self.part.result, self.part.here, len(self.part.request.kept)
        out, sums, worst, spoiled = (x.copy_to_host(stream=self.stream) for x in self.results)
        self.stream.synchronize()
        result.kept[here] = np.moveaxis(out.reshape(-1, kept, out.shape[1]), -1, 0) if kept else 0.0
        result.reduced[here] = sums.T
        result.worst[here] = worst
        result.is_finite[here] = np.isfinite(spoiled)


def _collect(running: list[_Running]) -> None:
    for one in running:
        one.store()
    running.clear()


@dataclass(frozen=True)
class _Part:
    """Cases of a grid that run in one kernel;  here: their places among the cases of the grid."""

    made: Program
    run: GridRun
    request: LaneRequest
    result: LaneResults
    here: slice

    @property
    def cases(self) -> int:
        return int(self.here.stop - self.here.start)

    @cached_property
    def grid(self) -> LoopGrid:
        return grid(self.made, self.run.timing, 1)

    @property
    def _bytes_of_case(self) -> int:
        rings = sum(len(getattr(self.grid, ring)) for ring in _RINGS)
        rows = (self.run.timing.samples + 1) * len(self.request.kept)
        numbers = self.run.parameters.shape[1] + len(self.request.reductions) + 2  # worst, spoiled
        return int(8 * (rings + rows + numbers))

    @property
    def _bytes_of_tables(self) -> int:
        return int(self.run.inputs.nbytes + self.run.sampled.nbytes)

    @property
    def bytes(self) -> int:
        """What it needs of the GPU's memory."""
        return self._bytes_of_tables + self.cases * self._bytes_of_case

    def split(self, memory: float) -> Iterator[_Part]:
        """The cases in parts that fit into this memory, bytes."""
        most = (memory - self._bytes_of_tables) / self._bytes_of_case
        if most < 1:
            needed = self._bytes_of_tables + self._bytes_of_case
            raise ModelError(
                f"simulate_many: a simulation of {self.run.timing.steps:.2g} steps needs "
                f"{1e-9 * needed:.2g} GB, the GPU has {1e-9 * memory:.2g} GB free"
            )
        size = int(min(most, self.cases))
        for first in range(0, self.cases, size):
            yield replace(self, here=slice(first, min(first + size, self.cases)))

    def launch(self, stream: Any) -> _Running:
        """Start the kernel for these cases."""
        from numba import cuda

        made, run, request, cases = self.made, self.run, self.request, self.cases
        in_use: list[Any] = []

        def send(array: np.ndarray) -> Any:
            sent = np.ascontiguousarray(array)
            in_use.extend((sent, cuda.to_device(sent, stream=stream)))
            return in_use[-1]

        def empty(*shape: int) -> Any:
            in_use.append(cuda.device_array(shape, np.float64, stream=stream))
            return in_use[-1]

        rings = {name: empty(len(getattr(self.grid, name)), cases) for name in _RINGS}
        tables = {name: send(getattr(self.grid, name)) for name in ("late_steps", "late_samples")}
        columns = made.functions["COLUMNS"]
        none = np.zeros(len(made.layout.parameters))
        out = empty((run.timing.samples + 1) * len(request.kept), cases)
        sums = empty(len(request.reductions), cases)
        worst, spoiled = empty(cases), empty(cases)
        kernel = _kernel(made.laws)[-(-cases // THREADS), THREADS, stream]
        with warnings.catch_warnings():  # numba: a small grid leaves most of the GPU without work
            warnings.filterwarnings("ignore", message=".*under-utilization")
            kernel(
                *self.grid._replace(**rings, **tables),
                send(run.inputs),
                send(run.sampled),
                send(first_memory(made, 1, none, request.start)),
                send(run.parameters[self.here].T),
                send(columns + np.array(request.kept, dtype=np.int64)),
                out,
                run.limit,
                request.begin,
                *map(send, reduction_arrays(columns, request.reductions, 1)),
                send(request.first_sums(1)),
                sums,
                worst,
                spoiled,
            )
        return _Running(self, stream, (out, sums, worst, spoiled), in_use)


@lru_cache(maxsize=64)
def _kernel(laws: str) -> Any:
    return compiled_module(gpu_source(laws, is_simulated=_is_simulated()), KERNEL)[KERNEL]


def _is_simulated() -> bool:
    """Whether numba simulates a GPU, thread by thread in Python: NUMBA_ENABLE_CUDASIM=1."""
    from numba import config

    return bool(getattr(config, "ENABLE_CUDASIM", 0))
