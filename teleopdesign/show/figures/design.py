"""Figures of design: force against velocity, signals over time. Nothing is computed."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from ...base.files import write_beside
from ...base.sentences import unit_at_axis
from .letters import house_style

if TYPE_CHECKING:
    import matplotlib.figure

    from ...simulate import ForceVelocity, Simulation

ONE_COLUMN, TWO_COLUMNS = 3.5, 7.16  # inches

#: the four cases in the same colours (Okabe and Ito) and lines in every figure
CASES = {
    "none": ("#000000", "-", "no compensation"),
    "MBC": ("#0072B2", (0, (5, 1.6)), "motion-based cancellation"),
    "FF": ("#D55E00", (0, (4, 1.4, 1, 1.4)), "force feedback"),
    "hybrid": ("#009E73", "-", "hybrid"),
}
_SYMBOLS = {
    "R_D": "R_D",
    "R_A": "R_A",
    "R_M": "R_M",
    "R_V": "R_V",
    "R_H": "R_H",
    "E": "R_D - R_M",
    "L": "L",
    "L_D": "L_D",
    "L_E": "L_D - L",
    "R_FF": r"R_{\mathrm{FF}}",
    "R_MBC": r"R_{\mathrm{MBC}}",
    "L_velocity": r"\dot L",
    "L_acceleration": r"\ddot L",
}


#: a letter with a short index, and how often it is differentiated: "X_m", "X_m_velocity"
_INDEXED = re.compile(r"([A-Za-z])_([A-Za-z0-9]{1,3})(_velocity|_acceleration)?")
_DOTS = {None: "", "_velocity": r"\dot ", "_acceleration": r"\ddot "}


def symbol(name: str) -> str:
    """The signal's symbol in mathtext; a name without a symbol gets spaces for underscores."""
    if name in _SYMBOLS:
        return f"${_SYMBOLS[name]}$"
    if indexed := _INDEXED.fullmatch(name):
        letter, index, rate = indexed.groups()
        index = index if len(index) == 1 else rf"\mathrm{{{index}}}"
        return f"${_DOTS[rate]}{letter}_{{{index}}}$"
    return name.replace("_", " ")


def save_figure(
    figure: matplotlib.figure.Figure,
    path: str | Path,
    *,
    suffixes: tuple[str, ...] = (".pdf", ".svg", ".png"),
) -> list[Path]:
    """Write the figure in house style, once for each suffix; returns the paths of the files.

    path: its suffix is replaced by each of `suffixes`; an older file is replaced only when the new
        file is complete
    """
    import matplotlib.pyplot as plt

    files = [Path(path).with_suffix(suffix) for suffix in suffixes]
    # fonts and resolution are taken when it is drawn; what has no layout keeps none
    layout = {"figure.constrained_layout.use": figure.get_layout_engine() is not None}
    with plt.style.context([*house_style(), layout]):
        for file in files:
            with write_beside(file) as part:
                figure.savefig(part)
    return files


def plot_force_velocity(result: ForceVelocity) -> matplotlib.figure.Figure:
    """Force error against velocity, a panel for each case, from top to bottom.

    Axes are in SI units of the axis (N over m/s, or N m over rad/s); each panel states its rms
    force.
    """
    import matplotlib.pyplot as plt
    from matplotlib.ticker import MaxNLocator, MultipleLocator

    data = result.data
    cases = [str(c) for c in data["case"].values]
    unit = unit_at_axis(data["force"].attrs["units"])
    speed = unit_at_axis(data["velocity"].attrs["units"])
    largest = float(abs(data["force"]).max())
    limit = 1.0 if 0.4 < largest <= 1.0 else 1.15 * largest
    with plt.style.context(house_style()):
        figure, axes = plt.subplots(
            len(cases), 1, sharex=True, sharey=True, squeeze=False, figsize=(ONE_COLUMN, 5.4)
        )
        for letter, case, axis in zip("abcdefgh", cases, axes[:, 0], strict=False):
            colour, _, label = CASES.get(case, (None, "-", case))
            one = data.sel(case=case)
            axis.axhline(0.0, color="#BFBFBF", linewidth=0.5, zorder=0)
            axis.axvline(0.0, color="#BFBFBF", linewidth=0.5, zorder=0)
            axis.plot(one["velocity"].values, one["force"].values, color=colour)
            axis.set_title(f"({letter}) {label}", loc="left", pad=3)
            text = f"rms {result.rms[case]:.2f} {unit}"
            axis.text(0.985, 0.06, text, transform=axis.transAxes, ha="right", color=colour)
            axis.set_ylim(-limit, limit)
            if limit == 1.0:
                axis.yaxis.set_major_locator(MultipleLocator(0.5))
        axes[-1, 0].xaxis.set_major_locator(MaxNLocator(5))
        axes[-1, 0].set_xlabel(f"velocity ({speed})")
        figure.supylabel(rf"force error $R_D - R_M$ ({unit})", fontsize=8)
    return figure


def plot_simulation(
    simulation: Simulation, names: tuple[str, ...] = ()
) -> matplotlib.figure.Figure:
    """Signals against time, a panel for each signal.

    names: signals of the diagram, drawn in SI units;  default: "L", "R_A" and "R_M", if present
    """
    import matplotlib.pyplot as plt

    shown = names or tuple(n for n in ("L", "R_A", "R_M") if n in simulation.data)
    with plt.style.context(house_style()):
        height = 0.6 + 1.05 * len(shown)
        figure, axes = plt.subplots(
            len(shown), 1, sharex=True, squeeze=False, figsize=(ONE_COLUMN, height)
        )
        for name, axis in zip(shown, axes[:, 0], strict=True):
            signal = simulation[name]
            axis.plot(signal["time"].values, signal.values)
            axis.set_ylabel(f"{symbol(name)} ({unit_at_axis(signal.attrs['units'])})")
            axis.grid(True)
        axes[-1, 0].set_xlabel("time (s)")
        figure.align_ylabels()
    return figure
