"""Is a logger that writes the command a row late or early taken for physics?

Devices are drawn by a simulator that shares no code with the package (`tests/hidden`), half of them
with an adequate model, half with one that lacks an effect that shows clearly. The command of each
is then written up to one row late or early. Right is: no effect named beside an adequate model, the
one that is missing named, alone, beside the others, and the shift itself.

What was found is in docs/theory.md, "The clock of the logger".

    python studies/clock_of_the_logger.py [--quick] [--output DIR]
"""

from __future__ import annotations

import sys
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr
from _study import write_study
from matplotlib.figure import Figure

import teleopdesign as td

#: the simulator of cases: code that shares nothing with the package
MAKER = Path(__file__).resolve().parents[1] / "tests" / "hidden"
#: rows by which the command is written late
ROWS = (-1.0, -0.3, 0.0, 0.3, 1.0)
#: effects that are missing in the other half
EFFECTS = ("stribeck", "presliding", "cogging", "spring", "coulomb_asymmetry")
#: among which a quick run searches: what a late log was once mistaken for, and what is missing
QUICK_EFFECTS = ("stribeck", "transmission_compliance")
#: cases with an adequate model, and seed of the first
ADEQUATE, SEED = 50, 5000


def logged(experiment: td.Experiment, rows: float) -> td.Experiment:
    """The experiment with each command written so many rows late; a part of a row is an average."""
    whole, part = divmod(rows, 1.0)

    def late(signal: np.ndarray) -> np.ndarray:
        first, second = (np.roll(signal, int(whole) + k) for k in (0, 1))
        return np.asarray((1.0 - part) * first + part * second)

    def one(record: Any) -> Any:
        signals = {
            n: (late(y) if n.endswith("actuator_force") else y)[2:-2]
            for n, y in record.signals.items()
        }
        whole_record = (slice(0, len(record.time) - 4),)
        return replace(record, time=record.time[2:-2], signals=signals, segments=whole_record)

    return replace(experiment, records=tuple(one(r) for r in experiment.records))


def drawn(folder: Path, effect: str, seed: int) -> td.Experiment | None:
    """A device that lacks this effect ("": none); None where no machine meets the level."""
    sys.path.insert(0, str(MAKER))
    from case_writer import write_files
    from cases import make_case

    level = "clear" if effect else "null"
    try:
        case = make_case(np.random.default_rng(seed), level, [effect] if effect else None)
    except RuntimeError:  # the maker says so where its tries are used up
        return None
    write_files(case, folder, folder / "truth.json")
    return td.load_experiment(folder)


def run(quick: bool = False) -> xr.Dataset:
    """A row a case: what is missing, what was named, shift written and estimated (rows)."""
    count, rows = (1, ROWS[-1:]) if quick else (ADEQUATE, ROWS)
    among = QUICK_EFFECTS if quick else None
    plan = [("", SEED + k, rows[k % len(rows)]) for k in range(count)]
    plan += [
        (EFFECTS[k % len(EFFECTS)], SEED + count + k, rows[k % len(rows)]) for k in range(count)
    ]
    cases = []
    with tempfile.TemporaryDirectory() as folder:
        for k, (effect, seed, shift) in enumerate(plan):
            experiment = drawn(Path(folder) / str(k), effect, seed)
            if experiment is None:
                continue
            diagnosis = td.find_missing(logged(experiment, shift), among=among)
            (late,) = diagnosis.model.record_shift.values()
            named = "+".join(c.effect.name for c in diagnosis.missing)
            estimated = late.value / experiment.records[0].sample_time
            cases.append((effect, named, diagnosis.verdict, shift, estimated))
            print(seed, *cases[-1], flush=True)
    names = ("missing", "named", "verdict", "written", "estimated")
    columns = {n: ("case", list(c)) for n, c in zip(names, zip(*cases, strict=True), strict=True)}
    return xr.Dataset(columns).assign_attrs(finding=_finding(cases))


def _finding(rows: list[tuple[str, str, str, float, float]]) -> str:
    adequate = [r for r in rows if not r[0]]
    false = sum(bool(r[1]) for r in adequate)
    lacking = [r for r in rows if r[0]]
    right = sum(r[0] == r[1] for r in lacking)
    off = np.abs([r[4] - r[3] for r in adequate])
    return (
        f"{false} of {len(adequate)} adequate models got an effect, {right} of {len(lacking)} "
        f"missing effects were named alone; beside adequate models the shift was off by "
        f"{np.median(off):.3f} rows (median), {off.max():.3f} at most"
    )


def plot(data: xr.Dataset) -> Figure:
    """Estimated over written shift, adequate and lacking models."""
    figure, axes = plt.subplots(figsize=(4.0, 3.2), layout="constrained")
    for label, mask, marker in (
        ("adequate model", data.missing == "", "o"),
        ("an effect is missing", data.missing != "", "x"),
    ):
        axes.plot(data.written[mask], data.estimated[mask], marker, label=label, ms=4)
    axes.plot([-1, 1], [-1, 1], color="0.6", lw=0.8, zorder=0)
    axes.set_xlabel("command written late (rows)")
    axes.set_ylabel("estimated (rows)")
    axes.legend(frameon=False)
    return figure


if __name__ == "__main__":
    write_study(__file__, __doc__ or "", run, quick="two cases, among few effects", plot=plot)
