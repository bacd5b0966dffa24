"""A comparison along the measured motion: forces, and where the residual is; before and after."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...base.sentences import unit_at_axis
from ...base.units import unit_of
from ...diagnose.by_simulation import SimulationComparison
from ...diagnose.comparison import Comparison
from ...diagnose.covariance import ResidualCorrelations, residual_correlations
from ...diagnose.recording import DiagnosedRecording
from ..figures.carrier import carrier_of_change, with_carrier
from ..figures.diagnosis import (
    check_rows,
    direction_legend,
    draw_by_direction,
    draw_over_time,
    force_axes,
    label_of,
    share_scale,
)
from ..figures.friction_curve import draw_friction_curve
from ..figures.style import AFTER, BEFORE, MEASURED, TWO_COLUMNS
from ..registry import shows

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@shows("figure")
def plot_comparison(comparison: Comparison, *, before: Comparison | None = None) -> Figure:
    """Measured and modelled force, and the residual over time, velocity and position.

    before: the figure shows this comparison beside another one, over the variable that carries the
        effect by which their models differ
    """
    import matplotlib.pyplot as plt

    if before is not None and not comparison.prepared.is_curve:
        return _plot_change(before, comparison)
    if comparison.prepared.is_curve:
        figure, axes = plt.subplots(1, 2, figsize=(7.16, 2.9))
        recording = DiagnosedRecording(stated=comparison.prepared.experiment)
        fit = recording.evaluate(comparison.model)
        draw_friction_curve(axes[0], comparison.prepared, {"model": (fit, AFTER)})
        draw_by_direction(axes[1], comparison.data, "velocity")
        direction_legend(axes[1])
        return figure
    data = check_rows(comparison.data)
    figure, axes = plt.subplots(2, 2, figsize=(7.16, 4.6))
    draw_over_time(axes[0, 0], data, "measured", MEASURED, "measured", 1.4)
    draw_over_time(axes[0, 0], data, "model", AFTER, "model", 0.7)
    force_axes(axes[0, 0], data)
    draw_over_time(axes[0, 1], data, "residual", AFTER, "residual", 0.7)
    axes[0, 1].set(xlabel=label_of(data, "time"), ylabel=label_of(data, "residual"))
    draw_by_direction(axes[1, 0], data, "velocity")
    draw_by_direction(axes[1, 1], data, "position")
    direction_legend(axes[1, 0])
    return figure


def _plot_change(before: Comparison, after: Comparison) -> Figure:
    """Forces and residual over time, and over what carries the changed effect: before and after."""
    import matplotlib.pyplot as plt

    at = next(iter(after.model.bodies))
    bodies = [one.model.body(at) for one in (before, after)]
    carrier = carrier_of_change(*bodies)
    rows = [with_carrier(check_rows(one.data), carrier, bodies[1].axis) for one in (before, after)]
    figure, axes = plt.subplot_mosaic("ft;ba", figsize=(7.16, 4.6))
    draw_over_time(axes["f"], rows[0], "measured", MEASURED, "measured", 2.0)
    for data, word, colour in zip(rows, ("before", "after"), (BEFORE, AFTER), strict=True):
        draw_over_time(axes["f"], data, "model", colour, word, 0.6)
        draw_over_time(axes["t"], data, "residual", colour, word, 0.7)
        panel = axes[word[0]]
        draw_by_direction(panel, data, "carrier")
        panel.set_ylabel(label_of(data, "residual").replace("residual", f"residual {word}"))
    force_axes(axes["f"], rows[0])
    axes["t"].set(xlabel=label_of(rows[0], "time"), ylabel=label_of(rows[0], "residual"))
    axes["t"].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1, ncols=2)
    share_scale(axes["b"], axes["a"])
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
    import matplotlib.pyplot as plt

    use = "check" if any(e.use == "check" for e in comparison.errors) else "fit"
    at = next(e.at for e in comparison.errors if e.use == use)
    axis = comparison.model.body(at).axis
    alone = not comparison.prepared.joints
    layout = "mm;oc" if alone else "mm"
    figure, axes = plt.subplot_mosaic(layout, figsize=(TWO_COLUMNS, 4.2 if alone else 2.3))
    _overlay(axes["m"], comparison, use, at)
    axes["m"].set_xlabel("time (s)")
    axes["m"].set_ylabel(f"position ({unit_at_axis(unit_of('position', axis))})")
    if alone:
        (prepared,) = comparison.prepared.parts.values()
        _correlations(axes, residual_correlations(comparison.model, prepared, at))
    return figure


def _overlay(ax: Any, comparison: SimulationComparison, use: str, at: str) -> None:
    """Measured motion grey and thick; the simulation of the whole record, and that of restarts."""
    drawn = [(h, c) for (u, a, h), c in comparison.courses.items() if (u, a) == (use, at)]
    low, high = np.inf, -np.inf
    for k, (horizon, courses) in enumerate(sorted(drawn, key=lambda one: -one[0])):
        whole = np.isinf(horizon)
        fit = comparison.error(horizon, use=use, at=at).fit
        name = "simulated" if whole else f"restarted each {horizon:g} s"
        for i, (time, measured, simulated) in enumerate(courses):
            if k == 0:
                label = "measured" if i == 0 else None
                ax.plot(time, measured, color=MEASURED, lw=2.4, label=label)
                low, high = min(low, measured.min()), max(high, measured.max())
            label = f"{name}: fit {fit:.1f} %" if i == 0 else None
            ax.plot(time, simulated, color=BEFORE if whole else AFTER, lw=0.8, label=label)
    room = 0.5 * (high - low)
    bottom, top = ax.get_ylim()
    # a model that drifts away must not press the measured motion to a line
    ax.set_ylim(max(bottom, low - room), min(top, high + room))
    ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1, ncols=3)


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
