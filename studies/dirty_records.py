"""What does a spoilt recording do: is it read, refused with its reason, or does the answer change?

Devices with an adequate model are drawn by a simulator that shares no code with the package
(`tests/hidden`). Their records are then spoilt, one defect at a time at three strengths: samples
lost, repeated or at other moments, a clock that drifts, outliers, clipping, dead spans, hum, a
quantised command, a late log, a low-passed force, a wrong sign. Each is read, checked and diagnosed
as a user would. Right is: the model stays adequate, or the reader or `check` says what is wrong.

What was found is in docs/trust.md, "Dirty records".

    python studies/dirty_records.py [--quick] [--cases K ...] [--output DIR]

Cases from 1000 on are read and checked, not diagnosed. What is finished stays in DIR, a file a
case: the same command goes on from there.
"""

from __future__ import annotations

import argparse
import gzip
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

import teleopdesign as td

#: the simulator of cases: code that shares nothing with the package
MAKER = Path(__file__).resolve().parents[1] / "tests" / "hidden"
SEED, RATE = 7000, 500.0
Table = dict[str, np.ndarray]


def _columns(table: Table, *starts: str) -> list[str]:
    return [name for name in table if name.startswith(starts)]


def _kept(table: Table, rows: np.ndarray) -> Table:
    return {name: y[rows] for name, y in table.items()}


def _changed(table: Table, change: Callable[[np.ndarray], np.ndarray], *starts: str) -> Table:
    return table | {name: change(table[name]) for name in _columns(table, *starts)}


def _low_passed(y: np.ndarray, frequency: float) -> np.ndarray:
    keep, out = np.exp(-2 * np.pi * frequency / RATE), np.empty_like(y)
    last = y[0]
    for i, value in enumerate(y):
        out[i] = last = keep * last + (1 - keep) * value
    return out


def _spans(rng: Any, rows: int, share: float, length: int = 25) -> np.ndarray:
    """Rows within spans of that length, which together are that share of all."""
    dead = np.zeros(rows, dtype=bool)
    for _ in range(max(round(share * rows / length), 1)):
        start = int(rng.integers(rows - length))
        dead[start : start + length] = True
    return dead


def _lost(table: Table, rng: Any, strength: float) -> Table:
    lost = rng.random(len(table["t"])) < strength
    lost[0] = False
    return _kept(table, ~lost)


def _repeated(table: Table, rng: Any, strength: float) -> Table:
    """A row is the one before it, under its own time."""
    again = np.flatnonzero(rng.random(len(table["t"])) < strength)
    again = again[again > 0]
    out = {name: y.copy() for name, y in table.items()}
    for name in out:
        if name != "t":
            out[name][again] = table[name][again - 1]
    return out


def _jittered(table: Table, rng: Any, strength: float) -> Table:
    """Samples are taken at moments that jitter, and the log has the even grid (rms in rows)."""
    t = table["t"]
    moments = t + strength / RATE * rng.standard_normal(len(t))
    return {name: y if name == "t" else np.interp(moments, t, y) for name, y in table.items()}


def _drifting(table: Table, rng: Any, strength: float) -> Table:
    """The force channel's clock is fast by this share."""
    t = table["t"]
    return _changed(table, lambda y: np.interp(t * (1 + strength), t, y), "f")


def _outliers(table: Table, rng: Any, strength: float) -> Table:
    def change(y: np.ndarray) -> np.ndarray:
        hit = rng.random(len(y)) < strength
        return np.where(hit, y + 10 * y.std() * rng.choice([-1, 1], len(y)), y)

    return _changed(table, change, "f", "x")


def _clipped(table: Table, rng: Any, strength: float) -> Table:
    def change(y: np.ndarray) -> np.ndarray:
        limit = np.quantile(np.abs(y), 1 - strength)
        return np.clip(y, -limit, limit)

    return _changed(table, change, "f", "u")


def _dead(table: Table, rng: Any, strength: float) -> Table:
    dead = _spans(rng, len(table["t"]), strength)
    held = np.maximum.accumulate(np.where(dead, 0, np.arange(len(dead))))
    return {name: y if name == "t" else y[held] for name, y in table.items()}


def _humming(table: Table, rng: Any, strength: float) -> Table:
    hum = np.sqrt(2) * np.sin(2 * np.pi * 50 * table["t"] + rng.uniform(0, 2 * np.pi))
    return _changed(table, lambda y: y + strength * y.std() * hum, "f", "u")


def _quantised(table: Table, rng: Any, strength: float) -> Table:
    def change(y: np.ndarray) -> np.ndarray:
        step = strength * np.abs(y).max()
        return np.round(y / step) * step

    return _changed(table, change, "u")


def _late(table: Table, rng: Any, strength: float) -> Table:
    """The command is written late (rows)."""
    t = table["t"]
    return _changed(table, lambda y: np.interp(t - strength / RATE, t, y), "u")


def _soft(table: Table, rng: Any, strength: float) -> Table:
    return _changed(table, lambda y: _low_passed(y, strength), "f")


def _turned(table: Table, rng: Any, strength: float) -> Table:
    """1: the force, 2: the command, 3: the position has the other sign."""
    return _changed(table, lambda y: -y, {1: "f", 2: "u", 3: "x"}[round(strength)])


@dataclass(frozen=True)
class Defect:
    """What is spoilt, how (weak, middle, strong), and the unit of that."""

    name: str
    spoil: Callable[[Table, Any, float], Table]
    sizes: tuple[float, float, float]
    unit: str


DEFECTS = (
    Defect("lost samples", _lost, (0.001, 0.01, 0.1), "of all"),
    Defect("repeated samples", _repeated, (0.001, 0.01, 0.1), "of all"),
    Defect("jittered samples", _jittered, (0.01, 0.1, 0.5), "rows rms"),
    Defect("clock drift of the force", _drifting, (1e-5, 1e-4, 1e-3), "fast"),
    Defect("outliers", _outliers, (0.0003, 0.003, 0.03), "of all"),
    Defect("clipping", _clipped, (0.001, 0.01, 0.1), "of all"),
    Defect("dead spans", _dead, (0.003, 0.03, 0.2), "of all"),
    Defect("hum at 50 Hz", _humming, (0.01, 0.1, 0.5), "of rms"),
    Defect("quantised command", _quantised, (0.001, 0.01, 0.1), "of the largest"),
    Defect("late command", _late, (0.5, 2.0, 8.0), "rows"),
    Defect("low-passed force", _soft, (100.0, 30.0, 8.0), "Hz"),
    Defect("wrong sign", _turned, (1, 2, 3), "1 force, 2 command, 3 position"),
)
CLEAN = len(DEFECTS)
#: (defect, strength): the records as they are first, then all defects of middle strength, ...
POINTS = ((CLEAN, 0), *((d, k) for k in (2, 3, 1) for d in range(CLEAN)))
#: cases from this number on are read and checked, not diagnosed: a diagnosis takes some ten seconds
FIRST_CHECKED_ONLY = 1000
QUICK = (0, 5, 14, 24)


@dataclass(frozen=True)
class Examined:
    """What became of one spoilt experiment; NaN: not asked."""

    warnings: float
    names_effect: float
    undecided: float
    left: float


@lru_cache(maxsize=1)
def _drawn(case: int) -> Any:
    """A device with an adequate model and a measured force."""
    sys.path.insert(0, str(MAKER))
    from cases import make_case

    return make_case(np.random.default_rng([SEED, case]), "null", rate=RATE, hand=True)


def _write_spoilt(folder: Path, case: int, defect: int, strength: int) -> None:
    drawn = _drawn(case)
    from case_writer import write_files

    write_files(drawn, folder, folder / "truth.json")
    if defect == CLEAN:
        return
    one = DEFECTS[defect]
    rng = np.random.default_rng([SEED, case, defect, strength])
    for path in sorted(folder.glob("*.csv.gz")):
        head, *lines = gzip.decompress(path.read_bytes()).decode().splitlines()
        values = np.array([line.split(",") for line in lines], dtype=float)
        table = dict(zip(head.split(","), values.T, strict=True))
        spoilt = one.spoil(table, rng, one.sizes[strength - 1])
        rows = np.column_stack(list(spoilt.values())).tolist()
        text = "\n".join([head, *(",".join(f"{x:.9g}" for x in row) for row in rows), ""])
        path.write_bytes(gzip.compress(text.encode(), 5, mtime=0))


def examine(case: float, point: float) -> Examined:
    """Read, check and diagnose one spoilt case;  point: see `POINTS`.

    raises ExperimentError: it is refused, and why
    """
    defect, strength = POINTS[int(point)]
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch) / f"case{int(case)}"
        _write_spoilt(folder, int(case), defect, strength)
        experiment = td.load_experiment(folder)
        warnings = sum(f.concern == "warning" for f in td.check_experiment(experiment))
        if case >= FIRST_CHECKED_ONLY:
            return Examined(warnings, *[float("nan")] * 3)
        answer = td.find_missing(experiment)
    named = answer.verdict == "effects_missing"
    undecided = answer.verdict == "undecided"
    return Examined(warnings, float(named), float(undecided), answer.left)


def _read(name: str) -> Callable[[Examined], float]:
    def value(examined: Examined) -> float:
        return float(getattr(examined, name))

    return value


MEASURES = {name: _read(name) for name in Examined.__dataclass_fields__}


def run(cases: Sequence[int], points: Sequence[int], folder: Path) -> dict[int, td.Study]:
    """A study for each case: what became of it at each of the points."""
    studies = {}
    for case in cases:
        out = folder / f"{Path(__file__).stem}_{case:04d}.nc"
        axes = {"case": float(case), "point": np.array(points, dtype=float)}
        print(f"case {case}", flush=True)
        studies[case] = td.study(examine, axes, measures=MEASURES, workers=1, out=out)
    return studies


def _reason(text: str) -> str:
    """A refusal without the name of the file, which is the same defect in any."""
    return text.split(": ", 1)[-1]


def table(studies: dict[int, td.Study], points: Sequence[int]) -> str:
    """A line for each defect and strength, in Markdown."""
    lines = [
        "| defect | strength | read | refused | `check` warns | names an effect | undecided | "
        "left, noise floors |",
        "| --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for k, point in enumerate(points):
        data = [one.data.isel(point=k) for one in studies.values()]
        reasons = [r for d in data if (r := str(d["failure"].values))]
        refused = f"{len(reasons)} ({_reason(reasons[0])})" if reasons else "0"

        def values(name: str, data: list[Any] = data) -> np.ndarray:
            found = [float(d[name].values) for d in data if name in d]
            return np.array([x for x in found if x == x])

        warnings, names = values("warnings"), values("names_effect")
        read = len(warnings)
        left = f"{np.median(values('left')):.2g}" if len(names) else "-"
        counts = [f"{int(values(n).sum())} of {len(names)}" for n in ("names_effect", "undecided")]
        defect, strength = POINTS[point]
        cells = ["none", "-"]
        if defect != CLEAN:
            one = DEFECTS[defect]
            cells = [one.name, f"{one.sizes[strength - 1]:g} {one.unit}"]
        cells += [str(read), refused, f"{int((warnings > 0).sum())} of {read}", *counts, left]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--quick", action="store_true", help="one case and four points, no file")
    parser.add_argument("--cases", type=int, nargs="+", default=[*range(50)], help="their numbers")
    parser.add_argument("--output", type=Path, default=Path(__file__).parent / "output")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    points: Sequence[int] = range(len(POINTS))
    if options.quick:
        options.cases, points = [FIRST_CHECKED_ONLY], QUICK
    with tempfile.TemporaryDirectory() as scratch:
        studies = run(options.cases, points, Path(scratch) if options.quick else options.output)
        text = table(studies, points)
    print(text)
    path = (options.output / Path(__file__).stem).with_suffix(".md")
    path.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
