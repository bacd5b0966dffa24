"""Figure of a simulation that was fitted to measured signals. Nothing else is computed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...base.sentences import unit_at_axis
from .design import ONE_COLUMN, symbol
from .letters import house_style

if TYPE_CHECKING:
    import matplotlib.figure

    from ...tuning import SimulationFit

GREY, FITTED = "#9A9A9A", "#0072B2"


def plot_simulation_fit(fitted: SimulationFit) -> matplotlib.figure.Figure:
    """For each signal: measured points and the simulation as a line; below, their difference."""
    import matplotlib.pyplot as plt

    names = tuple(fitted.rms)
    time = fitted.data["time"].values
    with plt.style.context(house_style()):
        figure, axes = plt.subplots(
            2 * len(names),
            1,
            sharex=True,
            squeeze=False,
            figsize=(ONE_COLUMN, 0.6 + 2.1 * len(names)),
            height_ratios=[2, 1] * len(names),
            layout="constrained",
        )
        for k, name in enumerate(names):
            above, below = axes[2 * k, 0], axes[2 * k + 1, 0]
            measured = fitted.data[f"{name}_measured"]
            simulated = fitted.data[f"{name}_simulated"].values
            unit = unit_at_axis(measured.attrs["units"])
            above.plot(time, measured.values, ".", color=GREY, markersize=1.5, label="measured")
            above.plot(time, simulated, color=FITTED, label="simulated")
            above.set_ylabel(f"{symbol(name)} ({unit})")
            below.axhline(0.0, color="#BFBFBF", linewidth=0.5, zorder=0)
            below.plot(time, simulated - measured.values, color=FITTED, linewidth=0.6)
            below.set_ylabel(f"difference ({unit})")
        axes[0, 0].legend()
        axes[-1, 0].set_xlabel("time (s)")
        figure.align_ylabels()
    return figure
