"""What one simulated second costs, as a ratio to C: scalar and side by side, in one run.

A device with a Dahl bristle and viscous friction under a sinusoidal force: 1 s, steps of 0.1 ms.
C is the same scheme written by hand for this one model, scalar and with a lane for each simulation
(`in_c.py`), compiled on the spot where gcc is; it is not part of the package. scipy takes a
compiled right-hand side, python-control its own form of the diagram, both by LSODA at rtol 1e-6.
Times are processor time of one thread, medians; engines take turns, so that other jobs weigh on all
of them. Errors: largest difference of the position from the kernel at a fifth of the step, over its
largest value.

    python benchmarks/kernel_speed.py [--json FILE] [--quick]
"""

from __future__ import annotations

import argparse
import ctypes
import json
import math
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any

import control
import numpy as np
from in_c import SCALAR, SIMD, compiled, pointer
from numba import njit
from scipy.integrate import solve_ivp

from teleopdesign.blocks import Body, Value
from teleopdesign.diagrams import haptic_interface
from teleopdesign.effects import EFFECTS
from teleopdesign.realise.iosystem import to_iosystem
from teleopdesign.realise.kernel import execute
from teleopdesign.realise.side_by_side import LANES, GridRun, Reduction, execute_many
from teleopdesign.simulate import prepare

MASS, LEVEL, STIFFNESS, DAMPING = DEVICE = 0.15, 0.5, 1e5, 0.1
STEPS, INNER, H = 10_000, 10, 1e-4


def force(t: Any) -> Any:
    """N; slides both ways, three reversals in a second."""
    return 2.0 * np.sin(2 * np.pi * 1.5 * t)


@njit
def rate(t, y):  # type: ignore[no-untyped-def]
    x, v, z = y
    acceleration = (2.0 * math.sin(2 * math.pi * 1.5 * t) - DAMPING * v - STIFFNESS * z) / MASS
    return np.array([v, acceleration, v - STIFFNESS * abs(v) / LEVEL * z])


def compiled_c(folder: Path) -> Callable[[], np.ndarray] | None:
    """The simulation in C, or None where there is no gcc."""
    library = compiled(SCALAR, folder, "model")
    if library is None:
        return None
    parameters, table = np.array(DEVICE), half_steps()
    out = np.zeros(STEPS // INNER + 1)
    counts = ctypes.c_long(STEPS), ctypes.c_long(INNER), ctypes.c_double(H)

    def call() -> np.ndarray:
        library.simulate(*counts, *map(pointer, (parameters, table, out)))
        return out

    return call


def simd_c(folder: Path) -> Callable[[], np.ndarray] | None:
    """A block of `LANES` simulations in C, a lane each; positions of the first one."""
    library = compiled(SIMD.replace("MANY", str(LANES)), folder, "lanes")
    if library is None:
        return None
    parameters, table = np.repeat(DEVICE, LANES), half_steps()
    out, squares = np.zeros((STEPS // INNER + 1, LANES)), np.zeros(LANES)
    counts = ctypes.c_long(STEPS), ctypes.c_long(INNER), ctypes.c_double(H)

    def call() -> np.ndarray:
        library.simulate(*counts, *map(pointer, (parameters, table, out, squares)))
        return out[:, 0]

    return call


def half_steps() -> np.ndarray:
    """The force at every half step, N."""
    return np.asarray(force(0.5 * H * np.arange(2 * STEPS + 1)))


def engines(folder: Path) -> dict[str, tuple[int, Callable[[], np.ndarray]]]:
    """Name -> simulations a call, and the call; it returns positions at the samples."""
    effects = {
        "coulomb.level": LEVEL,
        "presliding.stiffness": STIFFNESS,
        "viscous.damping": DAMPING,
    }
    values = {n: Value(x) for n, x in {"inertia": MASS, **effects}.items()}
    laws = tuple(EFFECTS[n] for n in ("coulomb", "presliding", "viscous"))
    diagram = haptic_interface(Body("prismatic", values, laws))
    duration = STEPS * H
    setup = prepare(diagram, duration=duration, inputs={"R_V": force}, computer="continuous")
    layout, timing = setup.program.layout, setup.timing(INNER)
    column, numbers = layout.columns.index("L"), setup.diagram.values
    arguments = setup.arguments(timing)
    one = np.array([numbers[n] for n in layout.parameters])
    grid = 1e-3 * np.arange(STEPS // INNER + 1)
    system = to_iosystem(diagram)
    inputs = np.zeros((len(system.input_labels), len(grid)))
    inputs[system.input_labels.index("R_V")] = force(grid)

    def scalar() -> np.ndarray:
        rows, _ = execute(setup.program, numbers, timing, every_step=False, **arguments)
        return rows[:, column]

    def side_by_side() -> np.ndarray:
        table = np.tile(one, (LANES, 1))
        reductions = [Reduction("rms", column, column)]
        kept = {"kept": [column], "reductions": reductions, "begin": 0}
        run = GridRun(table, timing, arguments["inputs"], arguments["sampled"])
        start = arguments["start"]
        return execute_many(setup.program, [run], start=start, **kept)[0].kept[0, :, 0]

    def scipy() -> np.ndarray:
        options = {"t_eval": grid, "rtol": 1e-6, "atol": 1e-9}
        return solve_ivp(rate, (0.0, grid[-1]), np.zeros(3), "LSODA", **options).y[0]

    def python_control() -> np.ndarray:
        options = {"rtol": 1e-6, "atol": 1e-9}
        response = control.input_output_response(
            system, grid, inputs, solve_ivp_method="LSODA", solve_ivp_kwargs=options
        )
        return response.outputs[system.output_labels.index("L")]

    made: dict[str, tuple[int, Callable[[], np.ndarray]]] = {}
    if (c := compiled_c(folder)) is not None:
        made["C, by hand"] = 1, c
    made["kernel, one simulation"] = 1, scalar
    made[f"kernel, {LANES} side by side"] = LANES, side_by_side
    if (lanes := simd_c(folder)) is not None:
        made[f"C, by hand, {LANES} lanes"] = LANES, lanes
    made["scipy, compiled right-hand side"] = 1, scipy
    made["python-control"] = 1, python_control
    fine = setup.timing(5 * INNER)
    rows, _ = execute(setup.program, numbers, fine, every_step=False, **setup.arguments(fine))
    made["reference"] = 0, lambda: rows[:, column]
    return made


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--json", type=Path, help="also write the figures to this file")
    parser.add_argument("--quick", action="store_true", help="3 turns in place of 15")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        made = engines(Path(folder))
        reference = made.pop("reference")[1]()
        times: dict[str, list[float]] = {name: [] for name in made}
        errors = {}
        for turn in range(3 if arguments.quick else 15):
            for name, (many, call) in made.items():
                if turn and times[name][-1] > 0.5 and turn > 2:
                    continue  # python-control takes seconds: three turns do
                if not turn:
                    call()
                start = time.thread_time()
                position = call()
                times[name].append((time.thread_time() - start) / many)
                errors[name] = float(np.abs(position - reference).max() / np.abs(reference).max())
    first = next(iter(made))
    unit = median(times[first])
    figures = [
        {"engine": n, "ms": 1e3 * median(t), "ratio": median(t) / unit, "error": errors[n]}
        for n, t in times.items()
    ]
    print(f"{'engine':<34} {'ms a simulated s':>16} {'ratio':>9} {'error':>9}")
    for row in figures:
        print(f"{row['engine']:<34} {row['ms']:>16.3f} {row['ratio']:>9.2f} {row['error']:>9.1e}")
    if arguments.json:
        arguments.json.write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
