"""The figure of a proposed experiment; it draws what the proposal holds and computes nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...base.finding import Graph, Series
from ..registry import shows

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ...next_experiment import Proposal

TRUTH, OTHER, NOW = "0.55", "#D55E00", "#0072B2"


@shows("figure")
def plot_proposal(proposal: Proposal) -> Figure:
    """The proposed motion, the force that a wrong model would leave, and the separation of rivals.

    If no motion is proposed, the figure shows only the sentence of the proposal.
    """
    import matplotlib.pyplot as plt

    if proposal.reference is None:
        figure, ax = plt.subplots(figsize=(7.16, 1.2))
        ax.text(0.0, 0.5, proposal.sentence, wrap=True, va="center")
        ax.set_axis_off()
        return figure
    figure, axes = plt.subplots(
        3,
        1,
        figsize=(7.16, 4.2 + 0.34 * len(proposal.separations)),
        height_ratios=(1.6, 1.6, 0.4 + 0.34 * len(proposal.separations)),
    )
    graphs = [f.graph for f in proposal.findings() if f.graph is not None]
    _graph(axes[0], graphs[0])
    _plot_separation(axes[1], proposal)
    _separations(axes[2], proposal)
    return figure


def _graph(ax: Axes, graph: Graph) -> None:
    for series in graph.series:
        _line(ax, series, len(graph.series) > 1)
    ax.set(xlabel=graph.x_label, ylabel=graph.y_label)
    if len(graph.series) > 1:
        ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1, ncols=2)


def _line(ax: Axes, series: Series, named: bool) -> None:
    ax.plot(series.x, series.y, lw=0.9, label=series.name if named else None)


def _plot_separation(ax: Axes, proposal: Proposal) -> None:
    """Force left for the best separated pair: of the wrong model and of the right model."""
    widest = max(proposal.separations, key=lambda s: s.predicted)
    curves = proposal.curves[proposal.separations.index(widest)]
    ax.plot(curves.time, curves.left, lw=0.8, color=OTHER, label=f"{widest.other} (wrong)")
    ax.plot(curves.time, curves.noise, lw=0.8, color=TRUTH, label=f"{widest.truth} (right)")
    ax.set(xlabel="time (s)", ylabel=f"force left ({curves.unit})")
    ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1, ncols=2)


def _separations(ax: Axes, proposal: Proposal) -> None:
    rows = range(len(proposal.separations))
    ax.barh(
        [i - 0.18 for i in rows],
        [s.predicted for s in proposal.separations],
        height=0.34,
        color=OTHER,
        label="with the proposed records (predicted)",
    )
    ax.barh(
        [i + 0.18 for i in rows],
        [s.present for s in proposal.separations],
        height=0.34,
        color=NOW,
        label="on the present records",
    )
    ax.axvline(1.0, color="k", lw=0.6, ls="--")
    ax.set_yticks(rows, [f"{s.other}\nif {s.truth} is right" for s in proposal.separations])
    ax.invert_yaxis()
    ax.set_xscale("symlog", linthresh=1.0)
    ax.set_xlim(left=0.0)
    ax.set_xlabel("separation (noise floors)")
    ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1, ncols=2)
