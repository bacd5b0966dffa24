"""What does a spoilt recording do: is it read, refused with its reason, or does the answer change?

Devices are drawn by a simulator that shares no code with the package (`tests/hidden`): those of
even number have an adequate model, those of odd number lack one clear effect. Their records are
then spoilt, one defect at a time at three strengths: samples lost, repeated or at other moments, a
clock that drifts, outliers, clipping, dead spans, hum, a quantised command, a late log, a
low-passed force, a wrong sign. Each is read, checked and diagnosed as a user would, among the
effects that a defect could imitate. Right is: the model stays adequate, the effect is named, or the
reader or `check` says what is wrong. A name that the device does not deserve is a false one.

What was found is in docs/trust.md, "Dirty records".

    python studies/dirty_records.py [--quick] [--cases K ...] [--output DIR]

What is finished stays in DIR, a file for each case and strength: the same command goes on there.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from _defects import DEFECTS, RATE, rewrite_records

import teleopdesign as td

#: the simulator of cases: code that shares nothing with the package
MAKER = Path(__file__).resolve().parents[1] / "tests" / "hidden"
SEED = 7000
CLEAN = len(DEFECTS)
#: strength -> its points (defect, strength), in the order of work; the records as drawn come first
STAGES = {
    2: ((CLEAN, 0), *((d, 2) for d in range(CLEAN))),
    3: tuple((d, 3) for d in range(CLEAN)),
    1: tuple((d, 1) for d in range(CLEAN)),
}
POINTS = tuple(point for stage in STAGES.values() for point in stage)
#: effects that are tried: those that a defect could imitate, and those that are hidden
AMONG = (
    *("actuation_delay", "actuator_lag", "actuator_gain", "added_inertia", "backlash", "bias"),
    *("coulomb_asymmetry", "presliding", "quadratic_drag", "spring", "stribeck"),
    *("transmission_compliance", "viscous_asymmetry"),
)
#: what cases of odd number lack, in turn
HIDDEN = ("stribeck", "spring", "presliding", "quadratic_drag", "actuation_delay", "bias")
CASES = 50


@dataclass(frozen=True)
class Examined:
    """What became of one spoilt experiment.

    false_names: effects named that are neither hidden nor a look-alike of what is
    is_named: whether the hidden effect is named, NaN where none is hidden
    left: the final error in noise floors
    """

    warnings: float
    false_names: float
    is_named: float
    undecided: float
    left: float


@lru_cache(maxsize=CASES)
def _drawn(case: int) -> Any:
    """A device with a measured force; what it lacks is `HIDDEN`, in turn, for odd numbers."""
    sys.path.insert(0, str(MAKER))
    from cases import make_case

    rng = np.random.default_rng([SEED, case])
    if case % 2 == 0:
        return make_case(rng, "null", rate=RATE, hand=True)
    return make_case(rng, "clear", [HIDDEN[case // 2 % len(HIDDEN)]], rate=RATE, hand=True)


def _deserved(drawn: Any) -> set[str]:
    """The hidden effect and its look-alikes: no method could tell these apart."""
    groups = [{one["effect"] for one in g} for g in drawn.figures["indistinguishable"]]
    return {h.effect for h in drawn.hidden}.union(*groups)


def _write_spoilt(folder: Path, case: int, defect: int, strength: int) -> None:
    drawn = _drawn(case)
    from case_writer import write_files

    write_files(drawn, folder, folder / "truth.json")
    if defect == CLEAN:
        return
    one = DEFECTS[defect]
    rng = np.random.default_rng([SEED, case, defect, strength])
    rewrite_records(folder, lambda table: one.spoil(table, rng, one.sizes[strength - 1]))


def examine(case: float, point: float) -> Examined:
    """Read, check and diagnose one spoilt case;  point: see `POINTS`.

    raises ExperimentError: it is refused, and why
    """
    defect, strength = POINTS[int(point)]
    deserved = _deserved(_drawn(int(case)))
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch) / f"case{int(case)}"
        _write_spoilt(folder, int(case), defect, strength)
        experiment = td.load_experiment(folder)
        warnings = sum(f.concern == "warning" for f in td.check_experiment(experiment))
        answer = td.find_missing(experiment, among=AMONG)
    names = {added.effect.name for added in answer.missing}
    return Examined(
        warnings=warnings,
        false_names=float(len(names - deserved)),
        is_named=float(bool(names & deserved)) if deserved else float("nan"),
        undecided=float(answer.verdict == "undecided"),
        left=answer.left,
    )


def _read(name: str) -> Callable[[Examined], float]:
    def value(examined: Examined) -> float:
        return float(getattr(examined, name))

    return value


MEASURES = {name: _read(name) for name in Examined.__dataclass_fields__}


def run(
    cases: Sequence[int], stages: Mapping[int, Sequence[tuple[int, int]]], folder: Path
) -> list[xr.Dataset]:
    """A study for each strength and case: what became of the case under every defect."""
    data = []
    for stage, chosen in stages.items():
        points = np.array([POINTS.index(p) for p in chosen], dtype=float)
        for case in cases:
            out = folder / f"{Path(__file__).stem}_{stage}_{case:04d}.nc"
            print(f"strength {stage}, case {case}", flush=True)
            axes = {"case": float(case), "point": points}
            data.append(td.study(examine, axes, measures=MEASURES, workers=1, out=out).data)
    return data


def _reason(text: str) -> str:
    """A refusal without the name of the file, which is the same defect in any."""
    return text.split(": ", 1)[-1]


def _cell(data: Sequence[Any], size: str) -> str:
    """What became of one defect of that size in all cases; a point that is not there has no say."""
    reasons = [r for d in data if (r := str(d["failure"].values))]

    def values(name: str) -> np.ndarray:
        numbers = [float(d[name].values) for d in data if name in d]
        return np.array([x for x in numbers if x == x])

    warnings, false = values("warnings"), values("false_names")
    named, undecided = values("is_named"), values("undecided")
    parts = [f"warned {int((warnings > 0).sum())} of {len(warnings)}"]
    if reasons:
        parts.append(f"refused {len(reasons)} ({_reason(reasons[0])})")
    if len(false):
        unsaid = int(((false > 0) & (warnings == 0)).sum())
        parts.append(f"false names {int((false > 0).sum())}, {unsaid} without a warning")
        parts.append(f"named {int(named.sum())} of {len(named)}, undecided {int(undecided.sum())}")
        parts.append(f"left {np.median(values('left')):.2g}")
    return f"{size}: {'; '.join(parts)}"


def table(studies: Sequence[xr.Dataset]) -> str:
    """A line for each defect, a column for each strength, in Markdown."""
    lines = ["| defect | weak | middle | strong |", "| --- | --- | --- | --- |"]
    for defect in (CLEAN, *range(CLEAN)):
        cells = []
        for strength in (0,) if defect == CLEAN else (1, 2, 3):
            point = float(POINTS.index((defect, strength)))
            data = [d.sel(point=point) for d in studies if point in d["point"].values]
            one = None if defect == CLEAN else DEFECTS[defect]
            size = "as drawn" if one is None else f"{one.sizes[strength - 1]:g} {one.unit}"
            cells.append(_cell(data, size) if data else "-")
        name = "none" if defect == CLEAN else DEFECTS[defect].name
        lines.append(f"| {' | '.join([name, *cells, *([''] * (3 - len(cells)))])} |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--quick", action="store_true", help="one case, as drawn and at one point")
    parser.add_argument(
        "--cases", type=int, nargs="+", default=[*range(CASES)], help="their numbers"
    )
    parser.add_argument(
        "--strengths", type=int, nargs="+", default=[*STAGES], choices=STAGES, help="1 to 3"
    )
    parser.add_argument("--output", type=Path, default=Path(__file__).parent / "output")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    cases, stages = options.cases, {k: STAGES[k] for k in options.strengths}
    if options.quick:
        cases, stages = [0], {2: STAGES[2][:2]}
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch) if options.quick else options.output
        text = table(run(cases, stages, folder))
    print(text)
    path = (options.output / Path(__file__).stem).with_suffix(".md")
    path.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
