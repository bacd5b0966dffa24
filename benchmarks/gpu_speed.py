"""Simulations a second on a GPU and on the cores beside it, and how far their numbers differ.

5 s of motion of the teleoperator of `study_speed.py motions`, with friction and a cancellation on
either side, in continuous time and with a sampled computer; three figures of each motion are kept.
The devices take turns; the first call of each, which compiles, is measured apart. `growing` has
wider ranges, in which two in a hundred sampled motions grow: these need finer and finer steps.

    python benchmarks/gpu_speed.py [--points N ...] [--turns K]
"""

from __future__ import annotations

import argparse
import time
from statistics import median
from typing import Any

import numpy as np
from study_speed import both_cancelled

import teleopdesign as td
from teleopdesign.realise.on_gpu import FEWEST

RANGES = {
    "C_s.dahl.level": (0.5, 0.95),
    "Z_E.spring.stiffness": (100.0, 2000.0),
    "C_s.dahl.stiffness": (300.0, 3000.0),
}
DAMPED, WIDE = {"P.spring_damper.damping": (1.0, 3.0)}, {"P.spring_damper.damping": (0.2, 5.0)}
REDUCE = {"rms": ("X_s", "rms"), "peak": ("F_P", "peak"), "end": ("X_m", "final")}
MODELS = {
    "continuous": ("continuous", WIDE),
    "sampled": (td.Sampling(), DAMPED),
    "growing": (td.Sampling(), WIDE),
}


def simulate(name: str, points: int, device: Any, duration: float = 5.0) -> tuple[Any, float]:
    """The figures of so many motions, and the seconds that they took."""
    computer, damping = MODELS[name]
    random = np.random.default_rng(1)
    values = {n: random.uniform(*ends, points) for n, ends in (RANGES | damping).items()}
    started = time.perf_counter()
    data = td.simulate_many(
        both_cancelled(),
        values,
        duration=duration,
        initial={"X_s": 5e-3},
        computer=computer,
        reduce=REDUCE,
        device=device,
    )
    return data, time.perf_counter() - started


def describe_differences(one: Any, other: Any) -> str:
    """The largest difference of any figure, over its largest size, and how many cases differ more
    than by rounding: motions that amplify it."""
    known = (one["reason"] == "").values
    sizes = {n: np.nanmax(np.abs(other[n].values)) for n in REDUCE}
    apart = np.max([np.abs(one[n] - other[n]).values[known] / sizes[n] for n in REDUCE], axis=0)
    return f"differ by {apart.max():.1e} at most, {np.sum(apart > 1e-9)} by more than 1e-9"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--points", type=int, nargs="+", default=[10_000, 100_000, 1_000_000])
    parser.add_argument("--turns", type=int, default=3)
    a = parser.parse_args()
    for name in MODELS:
        for device in ("cpu", "cuda"):
            first = simulate(name, FEWEST, device, 0.02)[1]
            print(f"{name}, {device}: {first:.1f} s for the first call", flush=True)
        seconds: dict[str, list[float]] = {"cpu": [], "cuda": []}
        for _ in range(a.turns):
            cpu, wall = simulate(name, a.points[0], "cpu")
            seconds["cpu"].append(wall)
            gpu, wall = simulate(name, a.points[0], "cuda")
            seconds["cuda"].append(wall)
        for device, walls in seconds.items():
            each = a.points[0] / median(walls)
            print(f"{name}, {device}: {a.points[0]} points, {each:.0f} a second", flush=True)
        refused = int((gpu["reason"] != "").sum())
        print(f"{name}: {refused} refused, {describe_differences(gpu, cpu)}", flush=True)
        for points in a.points[1:] if name != "growing" else ():
            each = points / simulate(name, points, "cuda")[1]
            print(f"{name}, cuda: {points} points, {each:.0f} a second", flush=True)


if __name__ == "__main__":
    main()
