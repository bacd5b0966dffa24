"""How searches look: the best point, its limits, trade-offs, simulations fitted to measurements."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..base.sentences import percent, unit_at_axis, with_standard_error
from ..base.shown import html_table
from ..base.units import unit_after_number
from ..simulate.units import signal_units
from ..tuning.follow import MOST_APART
from .figures.style import AFTER, BEFORE, MEASURED, ONE_COLUMN, UNTOLD, plt, symbol
from .registry import shows
from .studies.data import words

if TYPE_CHECKING:
    import matplotlib.figure

    from ..tuning import CheckedLimit, ParetoFront, SimulationFit, Tuned, TuningLimit

#: rms by which a tenth of the give moves a signal, over what the fit leaves, from which a fit says
#: so: the values of a driven mass moved by four standard errors where it was 0.8
MUCH = 0.3
#: evaluated points that are further from the front than this many of its lengths are not drawn
_BESIDE = 1.5


@shows("text")
def limit_text(limit: TuningLimit) -> str:
    """The bound with its unit, and the intervals for which it must hold."""
    within = ", ".join(f"{n} {a:g} to {b:g}" for n, (a, b) in limit.over.items())
    side = "<=" if limit.from_above else ">="
    bound = f"{limit.name} {side} {limit.bound:g}{unit_after_number(limit.unit)}"
    return f"{bound}, for all {within}" if within else bound


@shows("text")
def checked_limit_text(checked: CheckedLimit) -> str:
    """Whether the limit is kept, its value, and the method that shows the value."""
    state = "missed" if not checked.holds else "active" if checked.active else "kept"
    if np.isnan(checked.value):
        return f"{state}: {checked.limit}; {checked.how}"
    at = ", ".join(f"{n} = {v:.4g}" for n, v in checked.worst.items())
    value = f"{checked.value:.5g}{unit_after_number(checked.unit)}{f' at {at}' if at else ''}"
    return f"{state}: {checked.limit}: {value}; {checked.how}"


@shows("text")
def tuned_text(tuned: Tuned) -> str:
    """The measure at the best point, its values, and its limits."""
    head = f"The best found of {tuned.number} points (seed {tuned.seed})"
    if not tuned.keeps_limits:
        head = f"No point of {tuned.number} keeps all limits; the nearest"
    before = f"{tuned.before:.5g} -> " if np.isfinite(tuned.before) else ""
    lines = [
        f"{head}: {tuned.name} {before}{tuned.objective:.5g}{unit_after_number(tuned.unit)}",
        f"  {', '.join(f'{n} = {v:.5g}' for n, v in tuned.values.items())}",
        *(f"  {one}" for one in tuned.limits),
    ]
    if tuned.at_ends:
        lines.append(f"  at an end of the interval: {', '.join(tuned.at_ends)}")
    return "\n".join(lines)


@shows("table")
def tuned_table(tuned: Tuned) -> str:
    """The values of the best point, and its limits."""
    rows = [(n, f"{v:.5g}") for n, v in tuned.values.items()]
    rows += [(str(one.limit), str(one)) for one in tuned.limits]
    return html_table(f"The best found: {tuned.name} {tuned.objective:.5g}", ("", ""), rows)


@shows("text")
def front_text(front: ParetoFront) -> str:
    """Both measures and the values of each point."""
    units = [unit_after_number(u) for u in front.units]
    head = (
        f"The best trade-offs found of {front.number} points (seed {front.seed}), "
        f"{front.names[0]} against {front.names[1]}"
    )
    lines = [head + (f"; {front.dropped} failed the last check" if front.dropped else "")]
    for point, (x, y) in zip(front.points, front.objectives, strict=True):
        numbers = ", ".join(f"{n} = {v:.4g}" for n, v in point.values.items())
        lines.append(f"  {x:.4g}{units[0]}, {y:.4g}{units[1]}: {numbers}")
    return "\n".join(lines)


@shows("figure")
def plot_pareto(front: ParetoFront) -> matplotlib.figure.Figure:
    """The front as steps; points that keep the limits in grey; the untuned diagram as a cross."""
    x, y = front.objectives.T
    figure, axes = plt.subplots(figsize=(ONE_COLUMN, 0.8 * ONE_COLUMN))
    axes.plot(*front.evaluated.T, ".", color=UNTOLD, markersize=2.5, label="keeps the limits")
    axes.step(*front.evaluated_best.T, where="post", color=AFTER, label="best found")
    axes.plot(x, y, "o", color=AFTER, markersize=4, zorder=3, label="limits checked again")
    if np.isfinite(front.before).all():
        axes.plot(*front.before, "x", color=BEFORE, zorder=4, label="before")
    axes.set_xlim(right=min(axes.get_xlim()[1], _farthest(x)))
    axes.set_ylim(top=min(axes.get_ylim()[1], _farthest(y)))
    first, second = (
        f"{words(name)} ({unit_at_axis(unit or '1')})"
        for name, unit in zip(front.names, front.units, strict=True)
    )
    axes.set_xlabel(first)
    axes.set_ylabel(second)
    axes.legend()
    return figure


def _farthest(values: np.ndarray) -> float:
    """Limit of an axis: the largest value of the front and a margin beyond it."""
    return float(values.max() + _BESIDE * ((values.max() - values.min()) or abs(values.max()) or 1))


@shows("notes")
def fit_notes(fitted: SimulationFit) -> tuple[str, ...]:
    """Warnings to read before the values are used."""
    out = []
    if fitted.at_ends:
        out.append(f"at an end of the interval: {', '.join(fitted.at_ends)}")
    if fitted.undetermined:
        out.append(f"the data do not determine: {', '.join(fitted.undetermined)}")
    if rough := [n for n, x in fitted.apart.items() if x > MOST_APART]:
        out.append(f"no standard errors, as motion follows by jumps: {', '.join(rough)}")
    if soft := [f"{n} by {x:.2g}" for n, x in fitted.by_give.items() if x > MUCH]:
        softness = f"ideal friction gives by {fitted.case.give:g}, which may move values"
        out.append(
            f"{softness}: a tenth of it moves {', '.join(soft)} of its rms; state less `give`"
        )
    if fitted.agreeing < fitted.searches:
        out.append(f"{fitted.agreeing} of {fitted.searches} searches came to these values")
    return tuple(out)


def _fit_rows(fitted: SimulationFit) -> list[tuple[str, str]]:
    """Each value with its standard error, and how far each signal is followed."""
    rows = []
    for name, value in fitted.values.items():
        unit = unit_after_number(fitted.case.unit(name))
        rows.append((name, f"{with_standard_error(value, fitted.errors[name])}{unit}"))
    units = signal_units(fitted.diagram)
    for name, rms in fitted.rms.items():
        was = f"{100 * fitted.before[name]:.3g} -> " if np.isfinite(fitted.before[name]) else ""
        share = f"{was}{percent(fitted.of_signal[name], '.3g')}"
        rows.append((f"rms of {name}", f"{rms:.3g} {units(name)} ({share} of the signal)"))
    return rows


def _fit_title(fitted: SimulationFit) -> str:
    return f"Simulation of the {fitted.diagram.name}, fitted to {', '.join(fitted.rms)}"


@shows("text")
def fit_text(fitted: SimulationFit) -> str:
    """Values, signals and warnings, a line each."""
    lines = [_fit_title(fitted), *(f"  {name:<34} {text}" for name, text in _fit_rows(fitted))]
    return "\n".join([*lines, *(f"  {one}" for one in fitted.remarks)])


@shows("table")
def fit_table(fitted: SimulationFit) -> str:
    """Values and signals; the warnings below."""
    rows, note = _fit_rows(fitted), "; ".join(fitted.remarks)
    return html_table(_fit_title(fitted), ("", ""), rows, note=note)


@shows("figure")
def plot_simulation_fit(fitted: SimulationFit) -> matplotlib.figure.Figure:
    """For each signal: measured points and the simulation as a line; below, their difference."""
    names = tuple(fitted.rms)
    time = fitted.data["time"].values
    figure, axes = plt.subplots(
        2 * len(names),
        1,
        sharex=True,
        squeeze=False,
        figsize=(ONE_COLUMN, 0.6 + 2.1 * len(names)),
        height_ratios=[2, 1] * len(names),
    )
    for k, name in enumerate(names):
        above, below = axes[2 * k, 0], axes[2 * k + 1, 0]
        measured = fitted.data[f"{name}_measured"]
        simulated = fitted.data[f"{name}_simulated"].values
        unit = unit_at_axis(measured.attrs["units"])
        above.plot(time, measured.values, ".", color=MEASURED, markersize=1.5, label="measured")
        above.plot(time, simulated, color=AFTER, label="simulated")
        above.set_ylabel(f"{symbol(name)} ({unit})")
        below.axhline(0.0, color="#BFBFBF", linewidth=0.5, zorder=0)
        below.plot(time, simulated - measured.values, color=AFTER, linewidth=0.6)
        below.set_ylabel(f"difference ({unit})")
    axes[0, 0].legend()
    axes[-1, 0].set_xlabel("time (s)")
    figure.align_ylabels()
    return figure
