"""How much faster is the compiled kernel than python-control, at equal error?

One simulated second of the compensated haptic interface in its position loop (hybrid compensation,
LuGre friction of 1e5 N/m, controllers in continuous time, for python-control knows no others). Both
run the same equations with the same piecewise linear reference and are measured against one result:
scipy's Radau at rtol 1e-10 on the python-control system. Error: largest difference of the friction
force at the samples over its largest value. For each method and tolerance of python-control the
kernel gets the longest step that errs no more; the ratio that counts is the smallest one.
Compilation and building of both are not counted, input tables of the kernel are. python-control
takes inputs as linear between samples, so its integrators meet a kink every millisecond.

    python benchmarks/simulation_speed.py [--json FILE] [--quick]
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any

import control
import numpy as np
from scipy.integrate import solve_ivp

from teleopdesign.blocks import Body, Value
from teleopdesign.diagrams import Diagram, world_haptics_2005
from teleopdesign.effects import EFFECTS
from teleopdesign.realise.iosystem import to_iosystem
from teleopdesign.simulate import prepare

TARGET = 500.0
PERIOD = 1e-3  # s, of the reference's samples
STEPS = (1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5, 5e-6)
SETTINGS = [
    (method, rtol) for method in ("LSODA", "RK45", "Radau") for rtol in (1e-3, 1e-4, 1e-6, 1e-8)
]


def interface() -> Diagram:
    """The haptic interface with LuGre friction on its device."""
    numbers = {
        "inertia": 0.15,
        "coulomb.level": 0.5,
        "stribeck.extra_static_level": 0.1,
        "stribeck.stribeck_velocity": 0.005,
        "presliding.stiffness": 1e5,
        "viscous.damping": 0.1,
    }
    effects = tuple(EFFECTS[n] for n in ("coulomb", "stribeck", "presliding", "viscous"))
    device = Body("prismatic", {n: Value(v) for n, v in numbers.items()}, effects)
    return world_haptics_2005(position_loop=True).with_block("Z_M", device)


def timed(call: Callable[[], Any], repeat: int) -> tuple[float, Any]:
    """Median processor time of a call, s, and its last result; other jobs do not count."""
    times = []
    for _ in range(repeat):
        start = time.thread_time()
        result = call()
        times.append(time.thread_time() - start)
    return median(times), result


def position(time: np.ndarray) -> np.ndarray:
    """Samples of the reference L_D, m; between them it is linear, as python-control takes it."""
    return 0.01 * np.sin(2 * np.pi * 1.5 * time)


def reference(system: Any, grid: np.ndarray) -> np.ndarray:
    """Friction force at the samples, Radau at rtol 1e-10; started anew at each sample's kink."""
    inputs = np.zeros(len(system.input_labels))
    which = system.input_labels.index("L_D")
    row = system.output_labels.index("Z_M_friction")
    state = np.zeros(system.nstates)
    friction = [0.0]

    def rate(t: float, x: np.ndarray) -> np.ndarray:
        inputs[which] = np.interp(t, grid, position(grid))
        return np.asarray(system.dynamics(t, x, inputs))

    for start, end in zip(grid[:-1], grid[1:], strict=True):
        solution = solve_ivp(rate, (start, end), state, method="Radau", rtol=1e-10, atol=1e-13)
        state = solution.y[:, -1]
        inputs[which] = position(end)
        friction.append(float(np.asarray(system.output(end, state, inputs))[row]))
    return np.array(friction)


def of_control(
    system: Any, grid: np.ndarray, truth: np.ndarray, settings: list[tuple[str, float]]
) -> list[dict]:
    """Time and error of python-control for each method and tolerance."""
    table = np.zeros((len(system.input_labels), len(grid)))
    table[system.input_labels.index("L_D")] = position(grid)
    row = system.output_labels.index("Z_M_friction")
    out = []
    for method, rtol in settings:
        options = {"rtol": rtol, "atol": 1e-3 * rtol}

        def call(method: str = method, options: dict = options) -> Any:
            return control.input_output_response(
                system, grid, table, solve_ivp_method=method, solve_ivp_kwargs=options
            )

        seconds, response = timed(call, 1)
        error = np.abs(response.outputs[row] - truth).max() / np.abs(truth).max()
        out.append({"method": method, "rtol": rtol, "seconds": seconds, "error": float(error)})
    return out


def of_kernel(diagram: Diagram, grid: np.ndarray, truth: np.ndarray) -> list[dict]:
    """Time and error of the kernel for each step."""
    follow = {"L_D": lambda t: np.interp(t, grid, position(grid))}
    prepared = prepare(diagram, duration=grid[-1], inputs=follow, computer="continuous")
    column = prepared.program.layout.columns.index("Z_M_friction")
    out = []
    for step in STEPS:
        timing = prepared.timing(round(prepared.sampling.period / step))
        prepared.run(timing)
        seconds, (rows, _) = timed(lambda timing=timing: prepared.run(timing), 5)
        error = np.abs(rows[:, column] - truth).max() / np.abs(truth).max()
        out.append({"step": step, "seconds": seconds, "error": float(error)})
    return out


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--json", type=Path, help="also write the figures to this file")
    parser.add_argument("--quick", action="store_true", help="0.2 s, one method of python-control")
    arguments = parser.parse_args()
    diagram = interface()
    system = to_iosystem(diagram)
    grid = PERIOD * np.arange(201 if arguments.quick else 1001)
    truth = reference(system, grid)
    settings = [("LSODA", 1e-6)] if arguments.quick else SETTINGS
    kernel = of_kernel(diagram, grid, truth)
    pairs = []
    for row in of_control(system, grid, truth, settings):
        equal = [k for k in kernel if k["error"] <= row["error"]]
        if not np.isfinite(row["error"]) or row["error"] > 0.1 or not equal:
            continue
        best = min(equal, key=lambda k: k["seconds"])
        pairs.append({"control": row, "kernel": best, "ratio": row["seconds"] / best["seconds"]})
    print("python-control               error    time     kernel step  error    time      ratio")
    for pair in pairs:
        c, k = pair["control"], pair["kernel"]
        print(
            f"{c['method']:<6} rtol {c['rtol']:<8.0e}  {c['error']:>12.1e} {c['seconds']:>7.2f} s"
            f"  {k['step'] * 1e3:>8.3g} ms {k['error']:>9.1e} {k['seconds'] * 1e3:>6.2f} ms"
            f" {pair['ratio']:>8.0f}"
        )
    smallest = min(pairs, key=lambda p: p["ratio"])
    print(f"smallest ratio at equal error: {smallest['ratio']:.0f} (target {TARGET:.0f})")
    if arguments.json:
        figures = {"smallest": smallest, "target": TARGET, "pairs": pairs, "kernel": kernel}
        arguments.json.write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
