"""Comparisons along the measured motion and by simulation: errors in words, and figures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...base.sentences import percent
from ...base.shown import html_table
from ...base.units import unit_of
from ...diagnose.by_simulation import SimulationComparison
from ...diagnose.comparison import Comparison
from ...diagnose.covariance import ResidualCorrelations, residual_correlations
from ...diagnose.recording import DiagnosedRecording
from ..figures.carrier import carrier_of_change, with_carrier
from ..figures.diagnosis import (
    check_rows,
    direction_legend,
    draw_before_and_after,
    draw_by_direction,
    draw_courses,
)
from ..figures.friction_curve import curve_graph
from ..figures.graph import draw_graph
from ..figures.style import AFTER, TWO_COLUMNS, plt
from ..registry import shows
from ..report.motion import simulated_motions

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def _errors(comparison: Comparison) -> list[tuple[str, str]]:
    """Error of each use that has records, and the noise floor, in %."""
    rows = [("fit error", comparison.fit_error), ("check error", comparison.check_error)]
    rows += [("noise floor", comparison.floor.value)]
    return [(name, f"{100 * error:.2f} %") for name, error in rows if error == error]


def _title(comparison: Comparison) -> str:
    if comparison.prepared.is_curve:
        return "Comparison on a friction curve"
    return f"Comparison below {comparison.prepared.bandwidth:.3g} Hz"


@shows("table")
def comparison_table(comparison: Comparison) -> str:
    """The errors, and below them where the noise floor comes from."""
    head, source = ("", "relative force error"), comparison.floor.source
    return html_table(_title(comparison), head, _errors(comparison), note=source)


@shows("text")
def comparison_text(comparison: Comparison) -> str:
    """A line for each error."""
    lines = [f"  {name:<12} {error}" for name, error in _errors(comparison)]
    return "\n".join([_title(comparison), *lines]) + f"  ({comparison.floor.source})"


def _horizon_rows(comparison: SimulationComparison) -> list[tuple[str, ...]]:
    """Use, body and horizon; then deviation of position and velocity, absolute and in %."""
    rows: list[tuple[str, ...]] = []
    for e in comparison.errors:
        axis = comparison.model.body(e.at).axis
        rows.append(
            (
                e.use,
                e.at,
                "whole record" if np.isinf(e.horizon) else f"{e.horizon:g} s",
                f"{e.position:.3g} {unit_of('position', axis)}",
                percent(e.of_travel, ".3g"),
                f"{e.velocity:.3g} {unit_of('velocity', axis)}",
                percent(e.of_speed, ".3g"),
            )
        )
    return rows


def _forces(comparison: SimulationComparison) -> str:
    shown = [("fit", comparison.fit_error), ("check", comparison.check_error)]
    return "force error: " + ", ".join(f"{n} {100 * e:.2f} %" for n, e in shown if e == e)


@shows("table")
def simulation_table(comparison: SimulationComparison) -> str:
    """A row for each horizon, with the force errors below."""
    head = ("records", "at", "horizon", "position", "of travel", "velocity", "of speed")
    rows = _horizon_rows(comparison)
    return html_table(comparison.title, head, rows, note=_forces(comparison))


@shows("text")
def simulation_text(comparison: SimulationComparison) -> str:
    """A line for each horizon, and the force errors."""
    lines = [comparison.title, f"  {'':<22}{'horizon':>13}{'position rms':>24}{'velocity rms':>26}"]
    for use, at, horizon, position, of_travel, velocity, of_speed in _horizon_rows(comparison):
        lines.append(
            f"  {f'{use}, {at}':<22}{horizon:>13}{f'{position} ({of_travel})':>24}"
            f"{f'{velocity} ({of_speed})':>26}"
        )
    return "\n".join([*lines, f"  {_forces(comparison)}"])


@shows("figure")
def plot_comparison(comparison: Comparison, *, before: Comparison | None = None) -> Figure:
    """Measured and modelled force, and the residual over time, velocity and position.

    before: the figure shows this comparison beside another one, over the variable that carries the
        effect by which their models differ
    """
    if before is not None and not comparison.prepared.is_curve:
        return _plot_change(before, comparison)
    if comparison.prepared.is_curve:
        figure, axes = plt.subplots(1, 2, figsize=(7.16, 2.9))
        recording = DiagnosedRecording(stated=comparison.prepared.experiment)
        fit = recording.evaluate(comparison.model)
        draw_graph(curve_graph(comparison.prepared, {"model": fit}), axes[0])
        draw_by_direction(axes[1], comparison.data, "velocity")
        direction_legend(axes[1])
        return figure
    data = check_rows(comparison.data)
    figure, axes = plt.subplots(2, 2, figsize=(7.16, 4.6))
    draw_courses(axes[0, 0], axes[0, 1], {"model": data})
    draw_by_direction(axes[1, 0], data, "velocity")
    draw_by_direction(axes[1, 1], data, "position")
    direction_legend(axes[1, 0])
    return figure


def _plot_change(before: Comparison, after: Comparison) -> Figure:
    """Forces and residual over time, and over what carries the changed effect: before and after."""
    at = next(iter(after.model.bodies))
    bodies = [one.model.body(at) for one in (before, after)]
    carrier = carrier_of_change(*bodies)
    rows = [with_carrier(check_rows(one.data), carrier, bodies[1].axis) for one in (before, after)]
    figure, axes = plt.subplot_mosaic("ft;ba", figsize=(7.16, 4.6))
    words = ("before", "after")
    draw_courses(axes["f"], axes["t"], dict(zip(words, rows, strict=True)))
    draw_before_and_after((axes["b"], axes["a"]), rows, "carrier")
    direction_legend(axes["b"])
    for one, name in ((before, "b"), (after, "a")):
        errors = {"check error": one.check_error, "fit error": one.fit_error}
        word, error = next((w, e) for w, e in errors.items() if e == e)
        axes[name].set_title(f"{word} {100 * error:.2f} %", loc="left", fontsize=7, pad=3)
    return figure


@shows("figure")
def plot_simulation(comparison: SimulationComparison) -> Figure:
    """Position of the first body, measured and simulated, with the fit in %; and correlations.

    Correlations are those of the residual force with itself and with the command, with the band of
    99 %; an arm's figure has none.
    """
    alone = not comparison.prepared.joints
    layout = "mm;oc" if alone else "mm"
    figure, axes = plt.subplot_mosaic(layout, figsize=(TWO_COLUMNS, 4.2 if alone else 2.3))
    motion = simulated_motions(comparison, comparison.model.bodies)[0]
    draw_graph(motion.graph, axes["m"])
    if alone:
        (prepared,) = comparison.prepared.parts.values()
        _correlations(axes, residual_correlations(comparison.model, prepared, motion.body))
    return figure


def _correlations(axes: Any, known: ResidualCorrelations) -> None:
    pairs = (("o", known.itself, "itself"), ("c", known.command, "the command"))
    for name, values, words in pairs:
        ax = axes[name]
        ax.axhspan(-known.band, known.band, color="0.9", label="99 %")
        ax.vlines(1e3 * known.lag, 0.0, values, color=AFTER, lw=1.0)
        ax.axhline(0.0, color="k", lw=0.5)
        ax.set_ylim(-1.05, 1.05)
        ax.set_xlabel("lag of the residual force (ms)")
        ax.set_ylabel(f"correlation with {words} (1)")
        ax.legend(loc="lower right")
