"""Cases that run on a GPU and one by one: as a program, in numba's simulator of a GPU.

    NUMBA_ENABLE_CUDASIM=1 python tests/gpu_cases.py results.npz

numba decides at its import whether it simulates a GPU, so this is a process of its own. It compiles
nothing: the simulator executes Python, and so do the lanes here.
"""

import math
import sys

import numpy as np
import side_by_side_cases
from devices import DAHL, LINK, body
from side_by_side_cases import RUBBING, plain_loop, push, with_a_computer, with_late_signals

from teleopdesign.base.errors import ModelError
from teleopdesign.diagrams import teleoperator
from teleopdesign.realise import side_by_side
from teleopdesign.realise.side_by_side import KINDS, GridRun, Reduction
from teleopdesign.simulate import prepare, simulate_many

#: exit status where numba has no simulator of a GPU
NO_SIMULATOR = 3
VALUES = {
    "Z_m.presliding.stiffness": [2e4, 6e6, 2e4],
    "Z_m.coulomb.level": [0.5, 0.5, 0.0],
    "Z_s.inertia": [0.15, 0.2, 1e-300],
}


def with_bristles():
    bodies = [body(m, **RUBBING) for m in (0.15, 0.2)]
    return teleoperator(*bodies, coupling=LINK, hand=body(0.1), master_cancellation=DAHL)


SETUPS = {
    "bristles": lambda: prepare(
        with_bristles(), duration=3e-3, inputs={"F_u": push}, computer="continuous", jit=False
    ),
    "computer": lambda: with_a_computer(6e-3, velocity="observer", velocity_bandwidth=60.0),
    "late signals": lambda: with_late_signals(3e-3, 0.934e-3),
}


def cases_of(setup):
    return side_by_side_cases.cases_of(setup, 3)


def start_of(setup):
    return dict.fromkeys(setup.program.layout.states[:3], 1e-4)


def reductions_of(setup):
    """Every kind of reduction, each of another column; an energy is that of two columns."""
    return [Reduction(kind, i, 1 if kind == "energy" else i) for i, kind in enumerate(KINDS)]


def together(setup, execute, cases=None):
    """Results of the three cases side by side: all signals, and each kind of reduction."""
    timing = setup.timing(setup.inner())
    arguments = setup.arguments(timing)
    cases = cases_of(setup) if cases is None else cases
    run = GridRun(cases, timing, arguments["inputs"], arguments["sampled"])
    kept = range(len(setup.program.layout.columns))
    wanted = {"kept": kept, "reductions": reductions_of(setup), "begin": 1}
    return execute(setup.program, [run], start=start_of(setup), **wanted)[0]


def main(path):
    try:
        from numba import cuda
    except ImportError:
        sys.exit(NO_SIMULATOR)
    from teleopdesign.realise import on_gpu
    from teleopdesign.realise.on_gpu import execute_on_gpu

    on_gpu.FEWEST = 0
    side_by_side.LANES, side_by_side.loop_of = 3, plain_loop
    context = type(cuda.current_context())
    arrays = {}
    for name, make in SETUPS.items():
        result = together(make(), execute_on_gpu)
        arrays |= {f"{name}.{key}": value for key, value in vars(result).items()}
    setup = SETUPS["bristles"]()
    cases = cases_of(setup)
    cases[2, setup.program.layout.parameters.index("Z_s.inertia")] = 1e-300
    with np.errstate(all="ignore"):
        spoiled = together(setup, execute_on_gpu, cases)
    arrays |= {f"spoiled.{key}": value for key, value in vars(spoiled).items()}
    # bytes: for two of three cases with 600 of results each, and for less than one
    for name, room in (("two parts", 3000), ("no room", 500)):
        context.get_memory_info = lambda self, room=room: (room / 0.8, room / 0.8)
        try:
            arrays[name] = together(setup, execute_on_gpu).kept
        except ModelError as error:
            arrays[name] = np.array(str(error))
    context.get_memory_info = lambda self: (math.inf, math.inf)
    reduce = {"end": ("X_s", "final"), "drawn": (("F_m", "X_m"), "energy")}
    run = {"duration": 2e-3, "inputs": {"F_u": push}, "computer": "continuous", "reduce": reduce}
    # with a least number of two, the case that is refined alone runs on the cores
    for label, device, on_gpu.FEWEST in (
        ("cpu", "cpu", 0),
        ("cuda", "cuda", 0),
        ("both", "cuda", 2),
    ):
        data = simulate_many(with_bristles(), VALUES, device=device, **run)
        names = (*reduce, "step", "reason")
        arrays |= {f"{label}.{name}": data[name].values for name in names}
    np.savez(path, **arrays)


if __name__ == "__main__":
    main(sys.argv[1])
