"""Cases that run on a GPU and one by one: as a program, in numba's simulator of a GPU.

    NUMBA_ENABLE_CUDASIM=1 python tests/gpu_cases.py results.npz

numba decides at its import whether it simulates a GPU, so this is a process of its own. It compiles
nothing: the simulator executes Python, and so do the lanes here.
"""

import math
import sys

import numpy as np
from devices import DAHL, LINK, body

from teleopdesign.controllers import controller
from teleopdesign.diagrams import Control, Diagram, Junction, Moving, teleoperator
from teleopdesign.errors import ModelError
from teleopdesign.realise import side_by_side
from teleopdesign.realise._loop import module_source
from teleopdesign.realise.program import CompiledLoop
from teleopdesign.realise.side_by_side import KINDS, GridRun, Reduction
from teleopdesign.simulate import Sampling, prepare, simulate_many

RUBBING = {"coulomb__level": 0.5, "presliding__stiffness": 2e4, "viscous__damping": 0.4}
#: exit status where numba has no simulator of a GPU
NO_SIMULATOR = 3
VALUES = {
    "Z_m.presliding.stiffness": [2e4, 6e6, 2e4],
    "Z_m.coulomb.level": [0.5, 0.5, 0.0],
    "Z_s.inertia": [0.15, 0.2, 1e-300],
}


def push(t):
    return 3.0 * np.sin(300.0 * t + 0.3)


def with_bristles():
    bodies = [body(m, **RUBBING) for m in (0.15, 0.2)]
    return teleoperator(*bodies, coupling=LINK, hand=body(0.1), master_cancellation=DAHL)


def with_a_computer():
    """Actuators that are late, a controller that delays, commands that act between two samples."""
    bodies = [body(m, **RUBBING, actuation_delay__delay=2e-4) for m in (0.15, 0.2)]
    coupling = controller("delay", {"time": 2.4e-3}).then(LINK)
    diagram = teleoperator(
        *bodies, coupling=coupling, hand=body(0.1, viscous__damping=2.0), master_cancellation=DAHL
    )
    setting = Sampling(encoder_step=1e-5, delay=3e-4, velocity="observer", velocity_bandwidth=60.0)
    return prepare(diagram, duration=6e-3, inputs={"F_u": push}, computer=setting, jit=False)


def with_late_signals():
    """Two bodies on springs, each of which feels the other body late."""
    bodies = (
        Moving("M", body(0.1, **RUBBING), "x", "u", {"f": 1}, "f"),
        Moving("N", body(0.3, **RUBBING), "y", "w", {"g": 1}, "g"),
    )
    diagram = Diagram(
        "late",
        (
            *bodies,
            Control("T", controller("delay", {"time": 0.934e-3}), "x", "x_late", analog=True),
            Control("S", controller("delay", {"time": 0.77e-3}), "y", "y_late", analog=True),
            Control("P", LINK, "d", "u", "x", analog=True),
            Control("Q", LINK, "y_late", "v", "y", analog=True),
        ),
        (Junction("d", {"x_late": -1, "y": 1}), Junction("w", {"u": -1, "v": -1})),
        {"f": "force", "g": "force"},
        measured=("x", "y"),
    )
    inputs = {"f": push, "g": lambda t: 2.0 - 500.0 * t}
    return prepare(diagram, duration=3e-3, inputs=inputs, computer="continuous", jit=False)


SETUPS = {
    "bristles": lambda: prepare(
        with_bristles(), duration=3e-3, inputs={"F_u": push}, computer="continuous", jit=False
    ),
    "computer": with_a_computer,
    "late signals": with_late_signals,
}


def cases_of(setup):
    """Parameters of three cases; the second has a bristle too stiff for the step."""
    values, names = setup.diagram.values, setup.program.layout.parameters
    one = np.array([values[n] for n in names])
    cases = one * (1.0 + 0.1 * np.sin(np.arange(3)[:, None] + 3 * np.arange(len(one))))
    late = [i for i, n in enumerate(names) if n.endswith((".delay", ".time"))]
    cases[:, late] = one[late]
    cases[1, [i for i, n in enumerate(names) if n.endswith("presliding.stiffness")]] *= 300.0
    return cases


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


def plain_loop(laws, lanes):
    module = {"__name__": "plain"}
    exec(compile(module_source(laws, jit=False, lanes=lanes), "<generated>", "exec"), module)
    return CompiledLoop(lanes, module["run"], module["differentiate_at_rest"])


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
