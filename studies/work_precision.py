"""What does accuracy cost: the package's simulation beside scipy and python-control.

Machines whose exact motion is known from code that shares nothing with the package (`tests/exact`):
a mass on a Dahl bristle under a sinusoidal force, stick-slip on a belt, two masses with a gap. Each
is simulated with steps or tolerances from coarse to fine; the error is the largest of the position
at the samples over its range, the cost processor time of one call, the better of two. scipy has the
same right-hand side in Python, python-control its own form of the diagram (none of the gap), both
by LSODA.

What was found is in docs/trust.md, "Numbers that are right".

    python studies/work_precision.py [--quick] [--output DIR]
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import control
import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from _study import write_study
from matplotlib.figure import Figure
from scipy.integrate import solve_ivp

from teleopdesign.realise.iosystem import to_iosystem
from teleopdesign.simulate import simulate

TESTS = Path(__file__).resolve().parents[1] / "tests"
sys.path.insert(0, str(TESTS))
from exact.machines import Belt, Bristle, Gap  # noqa: E402
from exact.simulated import Pair, pair  # noqa: E402

MACHINES = {"Dahl oscillator": Bristle(), "stick-slip": Belt(), "gap": Gap()}
ENGINES = ("teleopdesign", "scipy", "python-control")
#: s; "refine" would take the coarse ones back: they show the order
STEPS = (2e-4, 1e-4, 5e-5, 2e-5, 1e-5)
TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10)
DURATION = 0.5


def _bristle_rate(m: Any) -> Callable[[float, np.ndarray], list[float]]:
    body, spring = (m.body, m.spring) if isinstance(m, Belt) else (m, 0.0)

    def rate(t: float, y: np.ndarray) -> list[float]:
        x, v, z = y
        friction, bristle = body.friction(v, z, np.sign(v))
        return [v, (m.force(t) - spring * x - friction - body.viscous * v) / body.mass, bristle]

    return rate


def _gap_rate(m: Gap) -> Callable[[float, np.ndarray], list[float]]:
    def rate(t: float, y: np.ndarray) -> list[float]:
        x, v, x_t, v_t = y
        d = x - x_t
        force = m.coupling(d, v - v_t, (np.sign(d - m.gap / 2), np.sign(d + m.gap / 2)))
        return [v, (m.drive(t) - force - m.viscous * v) / m.first, v_t, force / m.second]

    return rate


def _engine(engine: str, machine: Any, both: Pair, times: np.ndarray) -> Callable[..., np.ndarray]:
    """Position at the times for a step (s) or a relative tolerance."""
    if engine == "teleopdesign":
        signal, more = both.columns["x"]

        def position(step: float) -> np.ndarray:
            made = simulate(both.diagram, duration=times[-1], step=step, **both.arguments)
            return made[signal].values + more(times)

    elif engine == "scipy":
        rate = _gap_rate(machine) if isinstance(machine, Gap) else _bristle_rate(machine)
        start = np.zeros(4 if isinstance(machine, Gap) else 3)
        more = both.columns["x"][1]

        def position(rtol: float) -> np.ndarray:
            options = {"t_eval": times, "rtol": rtol, "atol": 1e-3 * rtol}
            return solve_ivp(rate, (0.0, times[-1]), start, "LSODA", **options).y[0] + more(times)

    else:
        system = to_iosystem(both.diagram)
        name, more = both.columns["x"]
        inputs = np.zeros((len(system.input_labels), len(times)))
        for signal, force in both.arguments["inputs"].items():
            inputs[system.input_labels.index(signal)] = force(times)
        row = system.output_labels.index(name)

        def position(rtol: float) -> np.ndarray:
            options = {"rtol": rtol, "atol": 1e-3 * rtol}
            made = control.input_output_response(
                system, times, inputs, solve_ivp_method="LSODA", solve_ivp_kwargs=options
            )
            return np.asarray(made.outputs[row] + more(times))

    return position


def run(quick: bool = False) -> xr.Dataset:
    """Error over range and processor time (s) of each machine, engine and setting."""
    machines = dict(list(MACHINES.items())[:1]) if quick else MACHINES
    times = 1e-3 * np.arange(51 if quick else round(DURATION * 1e3) + 1)
    shape = (len(machines), len(ENGINES), len(STEPS))
    error, seconds = np.full(shape, np.nan), np.full(shape, np.nan)
    for i, machine in enumerate(machines.values()):
        both = pair(machine)
        exact = both.exact(times)["x"]
        for j, engine in enumerate(ENGINES):
            if engine == "python-control" and isinstance(machine, Gap):
                continue  # `to_iosystem` refuses what meets across a gap: the law bends in a motion
            position = _engine(engine, machine, both, times)
            settings = STEPS if engine == "teleopdesign" else TOLERANCES
            position(settings[0])  # compiles
            for k, setting in enumerate(settings[:2] if quick else settings):
                spent = []
                for _ in range(2):
                    began = time.process_time()
                    x = position(setting)
                    spent.append(time.process_time() - began)
                error[i, j, k] = np.abs(x - exact).max() / np.ptp(exact)
                seconds[i, j, k] = min(spent)
    axes = ("machine", "engine", "setting")
    coords = {"machine": list(machines), "engine": list(ENGINES)}
    data = {
        "error": (axes, error, {"units": "1"}),
        "seconds": (axes, seconds, {"units": "s"}),
    }
    return xr.Dataset(data, coords, attrs={"duration_s": float(times[-1])})


def summary(data: xr.Dataset) -> str:
    """A line for each machine, engine and setting."""
    lines = [f"{'machine':<18}{'engine':<16}{'error':>10}{'ms':>10}"]
    for machine in data["machine"].values:
        for engine in data["engine"].values:
            one = data.sel(machine=machine, engine=engine)
            for e, s in zip(one["error"].values, one["seconds"].values, strict=True):
                if np.isfinite(e):
                    lines.append(f"{machine:<18}{engine:<16}{e:>10.1e}{1e3 * s:>10.2f}")
    return "\n".join(lines)


def plot(data: xr.Dataset) -> Figure:
    """Error over processor time, a panel for each machine."""
    names = data["machine"].values
    figure, panels = plt.subplots(1, len(names), figsize=(3.6 * len(names), 3.2), squeeze=False)
    for panel, machine in zip(panels[0], names, strict=True):
        for engine in data["engine"].values:
            one = data.sel(machine=machine, engine=engine)
            panel.loglog(1e3 * one["seconds"], one["error"], "o-", label=engine)
        panel.set(title=machine, xlabel="processor time (ms)", ylabel="error of position / range")
        panel.grid(True, alpha=0.3)
    panels[0][0].legend()
    figure.tight_layout()
    return figure


if __name__ == "__main__":
    write_study(__file__, __doc__ or "", run, quick="one machine, 50 ms", text=summary, plot=plot)
