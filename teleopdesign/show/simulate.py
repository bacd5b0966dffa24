"""How simulations look: signals over time, force against velocity or displacement."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..base.sentences import unit_at_axis
from ..base.shown import html_table
from .figures.style import CASES, ONE_COLUMN, TWO_COLUMNS, plt, symbol
from .registry import shows

if TYPE_CHECKING:
    import matplotlib.figure
    import xarray

    from ..simulate import ForceDisplacement, ForceVelocity, Simulation
    from ..simulate.on_grid import TableOverTime

#: colours (Okabe and Ito) and lines by case, in order
LINES = (("#000000", "-"), ("#0072B2", "-"), ("#D55E00", "-"), ("#009E73", "-"))
ENVIRONMENT = "#BFBFBF"


@shows("text")
def course_text(course: TableOverTime) -> str:
    """The number of samples of an input."""
    return f"course of {len(course.time)} samples"


@shows("text")
def simulation_text(simulation: Simulation) -> str:
    """Duration and scheme, and a line with the rms of each signal."""
    lines = [f"{_title(simulation)}, {simulation.data.attrs['scheme']}"]
    for name, x in simulation.data.items():
        known = {"step": x.attrs.get("step_error"), "give": x.attrs.get("give_error")}
        errors = [f"{of} {error:.1e}" for of, error in known.items() if error is not None]
        shown = f"  error over the largest: {', '.join(errors)}" if errors else ""
        lines.append(f"  {name:<28} rms {_rms(x):<10.4g} {x.attrs['units']:<6}{shown}".rstrip())
    return "\n".join(lines)


@shows("table")
def simulation_table(simulation: Simulation) -> str:
    """The rms, unit and meaning of each signal."""
    rows = [
        (n, f"{_rms(x):.4g}", x.attrs["units"], x.attrs["text"]) for n, x in simulation.data.items()
    ]
    head = ("signal", "rms", "unit", "")
    return html_table(_title(simulation), head, rows, note=simulation.data.attrs["scheme"])


def _title(simulation: Simulation) -> str:
    t = simulation.data["time"].values
    return f"Simulation of the {simulation.diagram.name}: {t[-1]:g} s, {len(t)} rows"


def _rms(signal: xarray.DataArray) -> float:
    return float(np.sqrt(np.mean(signal.values**2)))


@shows("figure")
def plot_simulation(simulation: Simulation, *names: str) -> matplotlib.figure.Figure:
    """Signals against time, a panel for each: `names`, or L, R_A and R_M if present; SI units."""
    shown = names or tuple(n for n in ("L", "R_A", "R_M") if n in simulation.data)
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


@shows("text")
def force_velocity_text(result: ForceVelocity) -> str:
    """The rms force of each case, and its mean size at the peak speed."""
    unit = result.data["force"].attrs["units"]
    lines = [
        f"  {case:<8} rms {rms:.3f} {unit}, at peak speed {result.at_peak_speed[case]:.3f} {unit}"
        for case, rms in result.rms.items()
    ]
    return "\n".join(["Force against velocity", *lines])


@shows("figure")
def plot_force_velocity(result: ForceVelocity) -> matplotlib.figure.Figure:
    """Force error against velocity, a panel for each case, from top to bottom.

    Axes are in SI units of the axis (N over m/s, or N m over rad/s); each panel states its rms
    force.
    """
    from matplotlib.ticker import MaxNLocator, MultipleLocator

    data = result.data
    cases = [str(c) for c in data["case"].values]
    unit = unit_at_axis(data["force"].attrs["units"])
    speed = unit_at_axis(data["velocity"].attrs["units"])
    largest = float(abs(data["force"]).max())
    limit = 1.0 if 0.4 < largest <= 1.0 else 1.15 * largest
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


@shows("text")
def force_displacement_text(result: ForceDisplacement) -> str:
    """Slope and width of the loop of each case, beside those of the environment."""
    lines = [
        f"  {case:<24} {loop.stiffness:8.4g} N/m (environment "
        f"{result.environment[case].stiffness:.4g}), loop {loop.width:.3f} N wide (environment "
        f"{result.environment[case].width:.3f}), rms difference {result.rms[case]:.3f} N"
        for case, loop in result.loops.items()
    ]
    return "\n".join(["Force against displacement", *lines])


@shows("figure")
def plot_force_displacement(result: ForceDisplacement) -> matplotlib.figure.Figure:
    """Displacement of the hand over time, its force over time, and its force over displacement."""
    data = result.data
    cases = [str(c) for c in data["case"].values]
    time = data["time"].values - data["time"].values[0]
    touched = float(abs(data["environment_force"]).max()) > 0
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(TWO_COLUMNS, 2.3))
    last = data.sel(case=cases[-1])
    if touched:
        right.plot(
            1e3 * last["environment_displacement"].values,
            last["environment_force"].values,
            color=ENVIRONMENT,
            linewidth=3.0,
            label="environment",
        )
    left.plot(time, 1e3 * last["displacement"].values, color="#000000", label="master")
    slave = 1e3 * last["environment_displacement"].values
    left.plot(time, slave, color="#D55E00", linestyle="--", label="slave")
    for (colour, line), case in zip(LINES, cases, strict=False):
        one = data.sel(case=case)
        style = {"color": colour, "linestyle": line}
        middle.plot(time, one["force"].values, **style)
        shown = 1e3 * one["displacement"].values
        right.plot(shown, one["force"].values, label=case, **style)
    left.set_ylabel("displacement (mm)")
    left.legend(loc="best")
    for axis in (left, middle):
        axis.set_xlabel("time (s)")
    for axis in (middle, right):
        axis.set_ylabel("force of the user (N)")
    right.set_xlabel("displacement (mm)")
    for letter, axis in zip("abc", (left, middle, right), strict=True):
        axis.set_title(f"({letter})", loc="left", pad=3)
        axis.grid(True)
    figure.legend(
        *right.get_legend_handles_labels(), loc="outside lower center", ncols=len(cases) + touched
    )
    return figure
