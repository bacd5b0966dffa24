"""A comparison along the measured motion: forces, and where the residual is; before and after."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...diagnose.comparison import Comparison
from ...diagnose.recording import DiagnosedRecording
from ..figures.carrier import carrier_of_change, with_carrier
from ..figures.diagnosis import (
    check_rows,
    direction_legend,
    draw_by_direction,
    draw_over_time,
    force_axes,
    label_of,
)
from ..figures.friction_curve import draw_friction_curve
from ..figures.style import AFTER, BEFORE, MEASURED, house_style
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
        with plt.style.context(house_style()):
            figure, axes = plt.subplots(1, 2, figsize=(7.16, 2.9))
            recording = DiagnosedRecording(stated=comparison.prepared.experiment)
            fit = recording.evaluate(comparison.model)
            draw_friction_curve(axes[0], comparison.prepared, {"model": (fit, AFTER)})
            draw_by_direction(axes[1], comparison.data, "velocity")
            direction_legend(axes[1])
        return figure
    data = check_rows(comparison.data)
    with plt.style.context(house_style()):
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
    with plt.style.context(house_style()):
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
        ends = [axes[name].get_ylim() for name in "ba"]
        direction_legend(axes["b"])
        for one, name in ((before, "b"), (after, "a")):
            errors = {"check error": one.check_error, "fit error": one.fit_error}
            word, error = next((w, e) for w, e in errors.items() if e == e)
            axes[name].set_ylim(min(e[0] for e in ends), max(e[1] for e in ends))
            axes[name].set_title(f"{word} {100 * error:.2f} %", loc="left", fontsize=7, pad=3)
    return figure
