"""A comparison by simulation: measured and simulated motion, and what is left in the residual."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...base.sentences import unit_at_axis
from ...base.units import unit_of
from ...diagnose.by_simulation import SimulationComparison
from ...diagnose.covariance import ResidualCorrelations, residual_correlations
from ..figures.style import AFTER, BEFORE, MEASURED, TWO_COLUMNS, house_style
from ..registry import shows

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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
    with plt.style.context(house_style()):
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
