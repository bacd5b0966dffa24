"""Which cases a campaign has, and running them: resumable, a process a case, some at a time."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from _one_case import MAKER, write_json

#: levels, kinds and so on repeat with lengths that have no common factor: every pair of them occurs
LEVELS = (
    "clear", "weak", "clear", "null", "double", "clear", "weak", "outside", "clear", "null",
)  # fmt: skip
KINDS = ("device", "device", "teleoperator")
EXCITATIONS = ("normal", "rich", "normal", "poor", "normal", "normal", "rich")
RATES = (1000.0,) * 9 + (500.0, 2000.0)
#: s; a diagnosis that takes longer than this counts as failed
LONGEST = 1800.0


@dataclass(frozen=True)
class Planned:
    """How one case is drawn.

    effect: the one it hides (None: the maker draws)
    logger: rows by which its command is logged late, with a jitter and lost rows; None: a clean log
    """

    index: int
    seed: int
    level: str
    effect: str | None
    kind: str
    excitation: str
    rate: float
    logger: float | None = None

    @property
    def name(self) -> str:
        """Name of the case's folder."""
        return f"{self.index + 1:04d}"


def _pools() -> dict[tuple[str, str], tuple[str, ...]]:
    sys.path.insert(0, str(MAKER))
    from truth_effects import CONTACT, OTHERS, OUTSIDE, TEN

    singles = (*TEN, *OTHERS)
    pools = {}
    for level in ("clear", "weak"):
        pools[level, "device"] = singles
        pools[level, "teleoperator"] = (*singles, *CONTACT)
    pools["outside", "device"] = pools["outside", "teleoperator"] = tuple(OUTSIDE)
    return pools


def plan(
    number: int,
    *,
    seed: int,
    levels: Sequence[str] = LEVELS,
    kinds: Sequence[str] = KINDS,
    excitations: Sequence[str] = EXCITATIONS,
    rates: Sequence[float] = RATES,
    loggers: bool = False,
) -> list[Planned]:
    """The first `number` cases of a campaign; a longer one begins with the same.

    Effects come in turn, in an order drawn anew each round, for each level and kind of machine.
    loggers: every second pair of cases is logged up to one row late or early, see `Planned`
    """
    pools = _pools()
    turns: Counter[tuple[str, str]] = Counter()
    cases = []
    for index in range(number):
        level, kind = levels[index % len(levels)], kinds[index % len(kinds)]
        pool, effect = pools.get((level, kind)), None
        if pool is not None:
            turn, place = divmod(turns[level, kind], len(pool))
            order = np.random.default_rng([seed, *map(ord, level + kind), turn])
            effect = pool[order.permutation(len(pool))[place]]
            turns[level, kind] += 1
        cases.append(
            Planned(
                index=index,
                seed=seed,
                level=level,
                effect=effect,
                kind=kind,
                excitation=excitations[index % len(excitations)],
                rate=rates[index % len(rates)],
                logger=_shift(seed, index) if loggers and index // 2 % 2 else None,
            )
        )
    return cases


def _shift(seed: int, index: int) -> float:
    """Rows, from one early to one late; a third of the loggers is late by exactly one."""
    rng = np.random.default_rng([seed, index, 1])
    return 1.0 if index % 3 == 0 else round(float(rng.uniform(-1, 1)), 3)


def write_plan(folder: Path, cases: Sequence[Planned]) -> None:
    """FOLDER/plan.json, extended where it is there.

    raises SystemExit: it holds other cases under the same names
    """
    path = folder / "plan.json"
    planned = {c.name: asdict(c) for c in cases}
    if path.exists():
        written = json.loads(path.read_text(encoding="utf-8"))["cases"]
        for name in planned.keys() & written.keys():
            if planned[name] != written[name]:
                raise SystemExit(
                    f"{path}: case {name}: found {written[name]}, expected {planned[name]}; "
                    "use another folder or the options that it was begun with"
                )
        planned = written | planned
    write_json(path, {"cases": planned})


def _environment() -> dict[str, str]:
    """One thread each for linear algebra and kernels: workers share the cores between them."""
    names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
    return {**os.environ, "MPLBACKEND": "Agg", **dict.fromkeys(names, "1")}


def _wanted(folder: Path, case: Planned, baselines: Sequence[str]) -> bool:
    if (folder / "truth" / f"{case.name}.none").exists():
        return False
    parts = ("truth", "answers", *baselines)
    return not all((folder / part / f"{case.name}.json").exists() for part in parts)


def _run_one(folder: Path, case: Planned, baselines: Sequence[str]) -> str:
    """What to say about the case when it is done; failures are kept beside the answers."""
    failed = folder / "failed" / f"{case.name}.all.txt"
    for old in failed.parent.glob(f"{case.name}.*.txt"):
        old.unlink()
    script = Path(__file__).with_name("_one_case.py")
    command = [sys.executable, str(script), str(folder), case.name, *baselines]
    try:
        done = subprocess.run(
            command, env=_environment(), capture_output=True, text=True, timeout=LONGEST
        )
    except subprocess.TimeoutExpired:
        wrong = f"took longer than {LONGEST:g} s"
    else:
        if done.returncode == 0:
            return "done"
        wrong = done.stderr.strip() or f"ended with status {done.returncode}"
    if not list(failed.parent.glob(f"{case.name}.*.txt")):  # the case itself could not say more
        failed.parent.mkdir(parents=True, exist_ok=True)
        failed.write_text(wrong + "\n", encoding="utf-8")
    return f"FAILED: {wrong.splitlines()[-1]}"


def duration(seconds: float) -> str:
    """45 s, 12 min, 3 h 05 min."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 90 else f"{minutes // 60} h {minutes % 60:02d} min"


def run_campaign(
    folder: Path,
    cases: Sequence[Planned],
    *,
    workers: int = 1,
    baselines: Sequence[str] = (),
    describe: Callable[[Planned], str] = lambda case: case.level,
) -> None:
    """Make and diagnose what is not there yet; a line a case with the time that remains.

    baselines: names of those that answer on the same files;  describe: text about a finished case
    """
    write_plan(folder, cases)
    todo = [c for c in cases if _wanted(folder, c, baselines)]
    print(f"{len(cases)} cases in {folder}, {len(todo)} to do, {workers} at a time", flush=True)
    began = time.perf_counter()
    with ThreadPoolExecutor(workers) as pool:
        running = {pool.submit(_run_one, folder, c, baselines): c for c in todo}
        try:
            for count, future in enumerate(as_completed(running), start=1):
                case, status = running[future], future.result()
                spent = time.perf_counter() - began
                left = duration(spent / count * (len(todo) - count))
                text = describe(case) if status == "done" else status
                print(f"[{count}/{len(todo)}] {case.name} {text}; {left} left", flush=True)
        except KeyboardInterrupt:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
