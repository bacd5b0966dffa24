"""The figure of a residual: its views, and a curve for each dependence on a variable."""

from __future__ import annotations

import math
import textwrap
from typing import TYPE_CHECKING, Any

from ..figures.diagnosis import AFTER, BACKWARD, FORWARD, MEASURED
from ..figures.style import house_style
from ..registry import shows

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ...base.finding import Graph, Series
    from ...unexplained import BodyResidual, ResidualDescription

#: panels side by side; height of a row of them (in)
COLUMNS, HEIGHT = 3, 1.75
#: letters on a line above the panels: as many as fit into 7.16 in at 7 points
LETTERS = 150
#: colour of each named series
COLOURS = {
    "forward": FORWARD,
    "backward": BACKWARD,
    "mean forward": "#00513b",
    "mean backward": "#7b3f63",
    "measured force": MEASURED,
    "residual": AFTER,
    "check, means": "0.25",
    "smooth": AFTER,
}


@shows("figure")
def plot_unexplained(failure: ResidualDescription) -> Figure:
    """The sentences of all findings, and below them the graphs of each body, dependences first."""
    import matplotlib.pyplot as plt

    panels = [p for part in failure.parts for p in _panels(part, name=len(failure.parts) > 1)]
    lines = [
        line
        for finding in failure.findings
        for line in textwrap.wrap(
            _plain_text(_sentence_text(finding.where, finding.sentence)), LETTERS
        )
    ]
    rows = math.ceil(len(panels) / COLUMNS)
    title = 0.14 * (len(lines) + 1)
    with plt.style.context(house_style()):
        figure, axes = plt.subplots(
            rows, COLUMNS, figsize=(7.16, HEIGHT * rows + title), squeeze=False
        )
        for ax, (name, graph) in zip(axes.flat, panels, strict=False):
            _draw(ax, graph)
            ax.set_title(name, loc="left", fontsize=7)
        for ax in axes.flat[len(panels) :]:
            ax.set_axis_off()
        for ax, (_, graph) in zip(axes.flat, panels, strict=False):
            if not any(s.kind == "rest" for s in graph.series):
                ax.legend(markerscale=2, fontsize=6, loc="best")
            elif graph.x_label.startswith("time ("):  # points are everywhere: beside the title
                place = {"loc": "lower right", "bbox_to_anchor": (1.02, 0.98)}
                points = zip(*ax.get_legend_handles_labels(), strict=True)
                named = [(h, n) for h, n in points if n in ("forward", "backward")]
                ax.legend(
                    *zip(*named, strict=True),
                    markerscale=6,
                    fontsize=6,
                    ncols=2,
                    handletextpad=0.0,
                    columnspacing=0.6,
                    **place,
                )
        figure.suptitle("\n".join(lines), x=0.01, ha="left", fontsize=7, parse_math=False)
    return figure


def _sentence_text(where: str, sentence: str) -> str:
    return f"{where}: {sentence}" if where else sentence[:1].upper() + sentence[1:]


def _plain_text(text: str) -> str:
    return text.replace("$", r"\$")


def _panels(part: BodyResidual, *, name: bool) -> list[tuple[str, Graph]]:
    before = f"{part.body}, " if name else ""
    curves = [(before + d.dependence.shape.name, d.graph) for d in part.dependences]
    return curves + [(f"{before}residual over {n}", g) for n, g in part.views.items()]


def _draw(ax: Axes, graph: Graph) -> None:
    for series in graph.series:
        _series(ax, series)
    if graph.logarithmic:
        ax.set(xscale="log", yscale="log")
    else:
        ax.axhline(0, color="k", lw=0.5)
    ax.set(xlabel=graph.x_label, ylabel=graph.y_label)


def _series(ax: Axes, series: Series) -> None:
    colour = COLOURS.get(series.name, MEASURED)
    points: dict[str, Any] = {"color": colour, "label": series.name}
    if series.kind == "rest":
        ax.plot(series.x, series.y, ".", ms=1.0, rasterized=True, **points)
        return
    if series.kind == "measured" and series.low is not None and series.high is not None:
        half = [series.y - series.low, series.high - series.y]
        ax.errorbar(series.x, series.y, half, fmt=".", ms=3, lw=0.7, **points)
        return
    if series.low is not None and series.high is not None:
        ax.fill_between(series.x, series.low, series.high, color=colour, alpha=0.25, lw=0)
    style = "." if len(series.x) == 1 else "-"
    ax.plot(series.x, series.y, style, lw=1.0, **points)
