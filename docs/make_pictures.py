"""The pictures of the README: its four steps on the logs that come with the package.

python docs/make_pictures.py
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

import teleopdesign as td  # noqa: E402

ROD = td.example("rod")
STYLE = Path(td.__file__).parent / "show" / "figures" / "teleopdesign.mplstyle"
OUTPUT = Path(__file__).parent / "_static"
MEASURED, BEFORE, AFTER = "0.6", "#D55E00", "#0072B2"
#: s, of the check record: slow strokes, where friction is most of the force
WINDOW = (6.66, 7.5)


def draw(diagnosis: td.Diagnosis) -> plt.Figure:
    """Forces in a part of the check record, residual over velocity before and after, ladder."""
    experiment = diagnosis.experiment
    before, after = (
        td.compare(row.model, experiment).data for row in (diagnosis.before, diagnosis.after)
    )
    before, after = (d.isel(sample=d["use"].values == "check") for d in (before, after))
    added = " + ".join(str(r.added.effect.name) for r in diagnosis.rungs if r.added is not None)
    with plt.style.context(STYLE):
        figure = plt.figure(figsize=(7.16, 3.2))
        upper, lower = figure.subfigures(2, 1, height_ratios=[1.0, 0.42])
        panels = upper.subplots(1, 3, width_ratios=[1.3, 1.0, 1.0])
        axes = dict(zip(("force", "before", "after"), panels, strict=True))
        _forces(axes["force"], before, after, added)
        for name, data, title in (
            ("before", before, "residual of your model"),
            ("after", after, f"residual with {added}"),
        ):
            color = BEFORE if name == "before" else AFTER
            axes[name].plot(
                data["velocity"], data["residual"], ".", ms=1.2, color=color, rasterized=True
            )
            axes[name].axhline(0, color="k", lw=0.5)
            axes[name].set_title(title, loc="left")
            axes[name].set(xlabel="velocity (m/s)", ylabel="residual force (N)")
        axes["after"].set_ylim(axes["before"].get_ylim())
        _ladder(lower.subplots(), diagnosis)
    return figure


def _forces(ax: Any, before: Any, after: Any, added: str) -> None:
    inside = (before["time"].values > WINDOW[0]) & (before["time"].values < WINDOW[1])
    time = before["time"].values[inside]
    ax.plot(time, before["measured"].values[inside], color=MEASURED, lw=2.6, label="measured")
    ax.plot(time, before["model"].values[inside], color=BEFORE, lw=1.0, label="your model")
    ax.plot(time, after["model"].values[inside], color=AFTER, lw=1.0, label=f"with {added}")
    ax.set(xlabel="time (s)", ylabel="force (N)")
    ax.set_title("measured and modelled force", loc="left")
    ax.legend(loc="lower left")


def _ladder(ax: Any, diagnosis: td.Diagnosis) -> None:
    names, errors = [], []
    for rung in diagnosis.rungs:
        names.append("your model" if rung.added is None else f"+ {rung.added}")
        errors.append(100 * rung.check_error)
    rows = range(len(names))
    ax.barh(rows, errors, height=0.66, color=[BEFORE] + [AFTER] * (len(names) - 1))
    floor = 100 * diagnosis.floor.value
    ax.axvline(floor, color="k", lw=0.8, ls="--")
    for row, error in zip(rows, errors, strict=True):
        ax.text(max(error, floor) + 0.06, row, f"{error:.2f} %", va="center")
    ax.text(floor + 0.75, len(names) - 1, f"(noise floor {floor:.2f} %)", va="center")
    ax.set_xlim(0, 1.1 * max(errors))
    ax.set_yticks(list(rows), names)
    ax.invert_yaxis()
    ax.set_xlabel("force error on the record that was not fitted (% of the measured force)")


def draw_felt(design: Any) -> plt.Figure:
    """What a hand feels of the device over amplitude, in the four cases of a compensation."""
    cases = td.diagrams.four_cases(design.diagram)
    amplitude = 1e-3 * np.geomspace(0.5, 10, 8)
    felt = td.measured_impedance(cases, amplitude=amplitude, frequency=5.0)
    predicted = td.frequency.quasi_linear_impedance(cases, amplitude=amplitude, frequency=5.0)
    return felt.plot(model=predicted)


def main() -> None:
    """The steps of the README, each with its picture."""
    with TemporaryDirectory() as folder:
        rod = Path(folder) / "rod"
        logs = [str(ROD / "fit.csv.gz"), str(ROD / "check.csv.gz")]
        units = [word for unit in ("x=m", "u=N", "f_h=N") for word in ("--unit", unit)]
        new = [sys.executable, "-m", "teleopdesign", "new", *logs, "--output", str(rod), *units]
        subprocess.run([*new, "--yes"], check=True)
        shutil.copy(rod / "understood.png", OUTPUT / "first_log.png")
        diagnosis = td.find_missing(td.load_experiment(rod))
        print(diagnosis)
        design = td.design_compensation(diagnosis)
        for name, figure, dpi in (
            ("diagnosis", draw(diagnosis), 220),
            ("first_compensation", design.plot(), 160),
            ("first_figure", draw_felt(design), 200),
        ):
            figure.savefig(OUTPUT / f"{name}.png", dpi=dpi)


if __name__ == "__main__":
    main()
