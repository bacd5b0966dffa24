"""Many simulations of one structure on an NVIDIA GPU: a thread for each case.

The loop and the laws are those of one simulation (`integrator.py`), with the same steps. Numbers
differ from those of the lanes (`side_by_side.py`) by rounding, because exp and sums of products are
rounded differently.

The memory of a case stays in registers if the compiler knows every place in it. Therefore all parts
are inlined, loops over quantities are written out, and a column that is chosen when the loop runs
is looked for among all columns. Rings and results lie in the memory of the GPU, case beside case,
so that threads read and write together.
"""

from __future__ import annotations

import ast
import re
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from importlib.metadata import version
from importlib.util import find_spec
from typing import Any

import numpy as np

from ..base.errors import ModelError
from .compiled import compiled_module
from .kernel import LoopGrid, first_memory, grid
from .program import PLAIN, Program, loop_source
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
#: name of the kernel
_KERNEL = "simulate_cases"
_HEAD = """from numba import cuda
from numba.cuda.libdevice import floor as round_down

jitted = cuda.jit(device=True, forceinline=True)
entry = jitted
"""
# numba's simulator of a GPU runs plain Python
_SIMULATED_HEAD = f"from numba import cuda\n{PLAIN}"
_COLUMN = """
@jitted
def column_at(place, memory):
    value = 0.0
    for i in range(MANY_COLUMNS):
        if place == COLUMNS + i:
            value = memory[COLUMNS + i]
    return value

"""
_TEXT = '''

@cuda.jit(cache=True)
def simulate_cases(
    samples, inner, h, period, lag, late_steps, encoder_step, smoothing,
    held, held_slots, before, after, late_slots, late_samples, past, past_slots,
    inputs, sampled, start, parameters, kept, out, limit, begin, kinds, columns, others, first,
    results, worst, spoiled,
):
    """Run each case in a thread;  arrays: rings, parameters and results, each (entries, cases).

    start: the memory at the start, without parameters;  first: reductions at the start
    worst: largest measure of the reload;  spoiled: NaN where a signal is not finite
    """
    case = cuda.grid(1)
    if case >= worst.size:
        return
    memory = cuda.local.array(ROWS, np.float64)
    for row in range(ROWS):
        memory[row] = start[row]
    for row in range(MANY_PARAMETERS):
        memory[PARAMETERS + row] = parameters[row, case]
    for row in range(held.shape[0]):
        held[row, case] = 0.0
    for row in range(before.shape[0]):
        before[row, case] = 0.0
        after[row, case] = 0.0
    for row in range(past.shape[0]):
        past[row, case] = 0.0
    for row in range(len(first)):
        results[row, case] = first[row]
    run(
        samples, inner, h, period, lag, late_steps, encoder_step, smoothing,
        held[:, case], held_slots, before[:, case], after[:, case], late_slots,
        late_samples, past[:, case], past_slots,
        False, inputs, sampled,
        memory, kept, out[:, case], limit, begin, kinds, columns, others, results[:, case],
    )
    largest = 0.0
    for i in range(MANY_BRISTLES):
        largest = max(largest, memory[WORST + i])
    worst[case] = largest
    spoiled[case] = memory[SPOILED]
'''


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
    running: list[Callable[[], None]] = []
    room = memory
    for part in parts:
        if part.bytes > room:
            while running:
                running.pop(0)()
            room = memory
        running.append(part.launch(streams[len(running) % len(streams)]))
        room -= part.bytes
    for store in running:
        store()
    scale_sums(runs, results, request)
    return results


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

    def launch(self, stream: Any) -> Callable[[], None]:
        """Start the kernel for these cases; returns what waits for its end and copies results."""
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

        def store() -> None:
            arrays = [x.copy_to_host(stream=stream) for x in (out, sums, worst, spoiled)]
            stream.synchronize()
            self._store(*arrays)
            in_use.clear()  # nothing of it may be freed before the end

        return store

    def _store(
        self, rows: np.ndarray, sums: np.ndarray, worst: np.ndarray, spoiled: np.ndarray
    ) -> None:
        result, here, kept = self.result, self.here, len(self.request.kept)
        result.kept[here] = np.moveaxis(rows.reshape(-1, kept, self.cases), -1, 0) if kept else 0.0
        result.reduced[here] = sums.T
        result.worst[here] = worst
        result.is_finite[here] = np.isfinite(spoiled)


@lru_cache(maxsize=64)
def _kernel(laws: str) -> Any:
    return compiled_module(_gpu_source(laws, is_simulated=_is_simulated()), _KERNEL)[_KERNEL]


def _is_simulated() -> bool:
    """Whether numba simulates a GPU, thread by thread in Python: NUMBA_ENABLE_CUDASIM=1."""
    from numba import config

    return bool(getattr(config, "ENABLE_CUDASIM", 0))


def _gpu_source(laws: str, *, is_simulated: bool = False) -> str:
    """The module whose kernel `simulate_cases` simulates a case in each thread.

    laws: from `Generator.source`;  is_simulated: for numba's simulator of a GPU
    """
    head = [_SIMULATED_HEAD if is_simulated else _HEAD, _COLUMN]
    source = loop_source(laws, head, is_typed=not is_simulated) + _TEXT
    counts = {n: int(count) for n, count in re.findall(r"^(\w+) = (\d+)$", source, re.MULTILINE)}
    return ast.unparse(ast.fix_missing_locations(_Unroller(counts).visit(ast.parse(source))))


class _Unroller(ast.NodeTransformer):
    """Writes loops over a constant number of quantities as their passes, one after the other.

    counts: name of a constant -> its value
    """

    def __init__(self, counts: Mapping[str, int]) -> None:
        self.counts = counts

    def visit_For(self, node: ast.For) -> ast.For | list[ast.stmt]:
        self.generic_visit(node)
        match node.iter:
            case ast.Call(func=ast.Name("range"), args=[ast.Name(name)]) if name in self.counts:
                passes: list[ast.stmt] = []
                for i in range(self.counts[name]):
                    passes += [ast.Assign([node.target], ast.Constant(i)), *node.body]
                return passes or [ast.Pass()]
        return node
