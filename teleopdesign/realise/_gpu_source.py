"""Source of the loop for a GPU: the laws, the loop of `integrator.py`, and a thread for each case.

The memory of a case stays in registers if the compiler knows every place in it. Therefore all parts
are inlined, loops over quantities are written out, and a column that is chosen when the loop runs
is looked for among all columns. Rings and results lie in the memory of the GPU, case beside case,
so that threads read and write together.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping

from .program import PLAIN, loop_source

#: name of the kernel
KERNEL = "simulate_cases"
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


def gpu_source(laws: str, *, is_simulated: bool = False) -> str:
    """The module whose kernel `simulate_cases` simulates a case in each thread.

    laws: from `Generator.source`;  is_simulated: for numba's simulator of a GPU
    """
    head = [_SIMULATED_HEAD if is_simulated else _HEAD, _COLUMN]
    module = ast.parse(loop_source(laws, head, is_typed=not is_simulated) + _TEXT)
    counts: dict[str, int] = {}
    for line in module.body:
        match line:
            case ast.Assign(targets=[ast.Name(name)], value=ast.Constant(int(count))):
                counts[name] = count
    return ast.unparse(ast.fix_missing_locations(_Unroller(counts).visit(module)))


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
