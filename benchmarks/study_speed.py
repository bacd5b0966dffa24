"""What many points cost: memory over their number, two workers against one, and Dask's overhead.

Points of a study of a teleoperator whose slave swings on a spring with a Dahl cancellation (0.5 s
each, steps of 0.1 ms, four values drawn), each in a new process, whose peak of memory is read at
its end. `memory` also reads what the process holds before the study, and the size of the Dataset.
`workers` takes turns of one and two processes; on a machine that others use, processor time per
point says what the second one costs, wall time what the load leaves. `dask` gives tasks of one
second each (of waiting, and of computing) to a local cluster of two processes and says how much
longer than the tasks the whole takes. `motions` simulates 5 s of a teleoperator with a cancellation
on either side, many times over, with its computer sampled and without one.

    python benchmarks/study_speed.py memory [--points N ...]
    python benchmarks/study_speed.py workers [--points N] [--turns K]
    python benchmarks/study_speed.py dask [--points N]
    python benchmarks/study_speed.py motions [--points N]
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import time
from statistics import median
from typing import Any

MIB = 1024.0  # KiB


def diagram() -> Any:
    """A slave that swings on its coupling and on a spring, its friction cancelled."""
    import teleopdesign as td

    friction = {"coulomb": {"level": 1.0}, "viscous": {"damping": 0.2}}
    slave = td.Body("prismatic", {"inertia": 0.3})
    for effect, values in friction.items():
        slave = slave.with_effect(td.EFFECTS[effect], values)
    wall = td.Body("prismatic", {"inertia": 0.0}).with_effect(
        td.EFFECTS["spring"], {"stiffness": 500.0}
    )
    return td.teleoperator(
        td.Body("prismatic", {"inertia": 0.1}),
        slave,
        coupling=td.controller("spring_damper", {"stiffness": 2000.0, "damping": 1.0}),
        environment=wall,
        slave_cancellation=td.controller("dahl", {"level": 0.8, "stiffness": 1000.0}),
    )


def both_cancelled() -> Any:
    """The same teleoperator with friction on either side, and its cancellation."""
    import teleopdesign as td

    one = diagram()
    law = td.controller("dahl", {"level": 0.8, "stiffness": 1000.0})
    return td.teleoperator(
        one.block("Z_s").body.with_values({"inertia": 0.1}),
        one.block("Z_s").body,
        coupling=td.controller("spring_damper", {"stiffness": 2000.0, "damping": 1.0}),
        environment=one.block("Z_E").body,
        slave_cancellation=law,
        master_cancellation=law,
    )


def motions(points: int) -> None:
    """Long motions on all cores, in this process: seconds, and why points have no numbers."""
    import teleopdesign as td

    ranges = {
        "C_s.dahl.level": (0.5, 0.95),
        "P.spring_damper.damping": (0.2, 5.0),
        "Z_E.spring.stiffness": (100.0, 2000.0),
        "C_s.dahl.stiffness": (300.0, 3000.0),
    }
    model = both_cancelled()
    for computer in ("continuous", td.Sampling()):

        def study(number: int, duration: float, computer: Any = computer) -> Any:
            return td.study(
                model,
                td.latin_hypercube(ranges, number, seed=1),
                measures=["tracking_error", td.measure("peak", signal="X_s")],
                duration=duration,
                initial={"X_s": 5e-3},
                computer=computer,
                workers=1,
            )

        study(64, 0.02)  # compiles, and loads what is needed
        started, used = time.perf_counter(), processor_seconds()
        result = study(points, 5.0)
        wall, processor = time.perf_counter() - started, processor_seconds() - used
        name = computer if isinstance(computer, str) else "sampled"
        refused = int((result.data["failure"] != "").sum())
        print(
            f"{points} motions of 5 s, {name}: wall {wall:.1f} s, processor {processor:.1f} s, "
            f"{refused} refused",
            flush=True,
        )


def run_study(points: int, workers: int) -> dict[str, float]:
    """One study in this process: seconds, memory (MiB) and size of the result."""
    import teleopdesign as td

    ranges = {
        "C_s.dahl.level": (0.5, 1.5),
        "P.spring_damper.damping": (0.2, 5.0),
        "Z_E.spring.stiffness": (100.0, 2000.0),
        "C_s.dahl.stiffness": (300.0, 3000.0),
    }

    def study(number: int, processes: int) -> Any:
        return td.study(
            diagram(),
            td.latin_hypercube(ranges, number, seed=1),
            measures=td.measure("peak", signal="X_s"),
            duration=0.5,
            initial={"X_s": 5e-3},
            workers=processes,
        )

    study(64, 1)  # compiles, and loads what is needed
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / MIB
    started, used = time.perf_counter(), processor_seconds()
    result = study(points, workers)
    wall, processor = time.perf_counter() - started, processor_seconds() - used
    return {
        "points": points,
        "workers": workers,
        "wall": wall,
        "processor": processor,
        "before": before,
        "peak": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / MIB,
        "of_workers": resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / MIB,
        "result": result.data.nbytes / MIB**2,
        "failed": int((result.data["failure"] != "").sum()) if "failure" in result.data else 0,
    }


def processor_seconds() -> float:
    """Of this process and of those that it started and that have ended."""
    both = (resource.getrusage(w) for w in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(one.ru_utime + one.ru_stime for one in both)


def in_new_process(points: int, workers: int) -> dict[str, float]:
    command = [sys.executable, __file__, "one", str(points), str(workers)]
    run = subprocess.run(command, check=True, capture_output=True, text=True)
    row: dict[str, float] = json.loads(run.stdout.splitlines()[-1])
    return row


def memory(points: list[int]) -> None:
    print(f"{'points':>8} {'processor':>10} {'before':>8} {'peak':>8} {'result':>8}  (s, MiB)")
    for number in points:
        r = in_new_process(number, 1)
        print(
            f"{number:>8} {r['processor']:>10.1f} {r['before']:>8.0f} {r['peak']:>8.0f}"
            f" {r['result']:>8.2f}",
            flush=True,
        )


def two_workers(points: int, turns: int) -> None:
    rows: dict[int, list[dict[str, float]]] = {1: [], 2: []}
    for _ in range(turns):
        for workers, listed in rows.items():
            r = in_new_process(points, workers)
            listed.append(r)
            print(f"{workers} workers: wall {r['wall']:.1f} s, processor {r['processor']:.1f} s")
    ratios = {
        name: median(r[name] for r in rows[1]) / median(r[name] for r in rows[2])
        for name in ("wall", "processor")
    }
    print(f"one over two: wall {ratios['wall']:.2f}, processor {ratios['processor']:.2f}")


def waits(number: float) -> float:
    """A task of one second that leaves the processor to others; returns how long it took, s."""
    started = time.perf_counter()
    time.sleep(1.0)
    return time.perf_counter() - started


def computes(number: float) -> float:
    """A task of one second of this process's processor time; returns how long it took, s."""
    started, end = time.perf_counter(), time.process_time() + 1.0
    while time.process_time() < end:
        pass
    return time.perf_counter() - started


def value(result: float) -> float:
    return result


def dask(points: int) -> None:
    from distributed import Client, LocalCluster

    import teleopdesign as td

    options: dict[str, Any] = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    with LocalCluster(**options) as cluster, Client(cluster):
        for task in (waits, computes):
            arguments = {"measures": {"value": value}, "scheduler": cluster.scheduler_address}
            td.study(task, {"number": [-1.0, -2.0]}, **arguments)  # modules are read
            started = time.perf_counter()
            result = td.study(task, {"number": list(map(float, range(points)))}, **arguments)
            wall, tasks = time.perf_counter() - started, float(result["value"].sum())
            print(
                f"{points} tasks, {task.__name__} 1 s, two processes: {wall:.2f} s, tasks "
                f"{tasks:.2f} s: {100 * (2 * wall / tasks - 1):.1f} % more than half of these",
                flush=True,
            )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    what = parser.add_subparsers(dest="what", required=True)
    of_memory = what.add_parser("memory", help="peak of memory over the number of points")
    of_memory.add_argument("--points", type=int, nargs="+", default=[1_000, 10_000, 100_000])
    of_workers = what.add_parser("workers", help="two workers against one")
    of_workers.add_argument("--points", type=int, default=20_000)
    of_workers.add_argument("--turns", type=int, default=3)
    of_dask = what.add_parser("dask", help="overhead of a cluster at one second a task")
    of_dask.add_argument("--points", type=int, default=40)
    of_motions = what.add_parser("motions", help="long motions of a teleoperator")
    of_motions.add_argument("--points", type=int, default=10_000)
    one = what.add_parser("one", help="one study, its figures as a line of JSON")
    one.add_argument("points", type=int)
    one.add_argument("workers", type=int)
    a = parser.parse_args()
    if a.what == "memory":
        memory(a.points)
    elif a.what == "workers":
        two_workers(a.points, a.turns)
    elif a.what == "dask":
        dask(a.points)
    elif a.what == "motions":
        motions(a.points)
    else:
        print(json.dumps(run_study(a.points, a.workers)))


if __name__ == "__main__":
    main()
