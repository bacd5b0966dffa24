"""Draws the graph of a finding on axes; computes only which points are left out."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...base.finding import Array, Graph, Series
from .style import AFTER, BACKWARD, BEFORE, FORWARD, MEASURED

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis

INK = "k"
#: of two series of one kind the first is before, the second after, in the colours of every figure
PAIR = (BEFORE, AFTER, FORWARD, BACKWARD, "#E69F00", "#56B4E9")
#: colours of each kind, in the order of its series
COLOURS = {
    "measured": (MEASURED, *PAIR),
    "rest": PAIR,
    "model": PAIR,
    "trend": (INK, *PAIR),
    "limit": (INK, MEASURED),
    "course": (MEASURED, *PAIR),
}
POINTS = ("measured", "rest")
#: most points drawn of one series; more are not seen on a panel of a few inches
MOST = 6000
#: up to so many points are drawn large enough to be seen under a line; from so many on, small
FEW, MANY = 300, 1000
#: inches that an entry of a legend takes beside its words, and that a letter takes
ENTRY, LETTER = 0.35, 0.045


def draw_graph(
    graph: Graph,
    axes: Axes,
    *,
    colours: Mapping[str, str] | None = None,
    legend: bool = True,
) -> None:
    """Draw every series of a graph with labels and, for more than one series, a legend above.

    colours: name of a series -> its colour, if it differs from the colour of its kind

    A series of more than `MOST` points keeps its extremes (see `thin_series`).

    Texts are drawn without formulas; a name from a file may contain a dollar sign.
    """
    totals: Counter[str] = Counter(s.kind for s in graph.series)
    if graph.logarithmic:
        _logarithmic(graph, axes)
    drawn: Counter[str] = Counter()
    for series in graph.series:
        default = _colour(series.kind, drawn[series.kind], totals)
        _draw(thin_series(series, MOST), axes, (colours or {}).get(series.name, default))
        drawn[series.kind] += 1
    axes.set_xlabel(graph.x_label, parse_math=False)
    axes.set_ylabel(graph.y_label, parse_math=False)
    if legend and len(graph.series) > 1:
        _legend(axes)


def thin_series(series: Series, most: int) -> Series:
    """The series with at most `most` points: the lowest and highest of each group of neighbours.

    A cloud ("rest") keeps every k-th point: its extremes alone would leave the middle empty.
    """
    n = len(series.x)
    if n <= most:
        return series
    cloud = series.kind == "rest"
    kept = np.linspace(0, n - 1, most).astype(np.intp) if cloud else extremes(series.y, most // 2)
    cut = [None if b is None else b[kept] for b in (series.low, series.high)]
    return Series(series.name, series.x[kept], series.y[kept], series.kind, cut[0], cut[1])


def extremes(values: Array, buckets: int) -> NDArray[np.intp]:
    """Indices of the lowest and highest value in each of `buckets` equal parts, in order."""
    filled = np.where(np.isfinite(values), values, 0.0)
    edges = np.linspace(0, len(values), max(buckets, 1) + 1).astype(int)
    pairs = zip(edges[:-1], edges[1:], strict=True)
    places = [(a + f(filled[a:b])) for a, b in pairs if b > a for f in (np.argmin, np.argmax)]
    return np.unique(np.array(places, dtype=np.intp))


def _colour(kind: str, number: int, totals: Counter[str]) -> str:
    colours = COLOURS[kind]
    if kind == "model" and totals[kind] == 1:
        return AFTER
    return colours[number % len(colours)]


def _draw(series: Series, axes: Axes, colour: str) -> None:
    # one point has no line: it is drawn as a point, its band as a bar
    is_cloud, count = series.kind in POINTS or len(series.x) == 1, len(series.x)
    if series.low is not None and series.high is not None:
        draw_interval(axes, series.x, (series.low, series.high), colour, bars=is_cloud)
    style: dict[str, Any]
    if is_cloud:
        size = 4.5 if count <= FEW else 2.4 if count <= MANY else 1.0
        style = {"linestyle": "none", "marker": ".", "markersize": size}
        style["rasterized"] = count > FEW  # a vector each would be most of a page
    elif series.kind == "limit":
        style = {"linestyle": "--", "linewidth": 0.8}
    else:
        style = {"linestyle": "-", "linewidth": 2.6 if series.kind == "course" else 1.0}
    # matplotlib leaves labels with a leading underscore out of the legend
    label = f"\u200b{series.name}" if series.name.startswith("_") else series.name
    axes.plot(series.x, series.y, color=colour, label=label, **style)


def _logarithmic(graph: Graph, axes: Axes) -> None:
    """Logarithmic y; also x if it is positive and spans more than a decade, as frequencies do."""
    axes.set_yscale("log")
    x = np.concatenate([s.x for s in graph.series]) if graph.series else np.zeros(1)
    x = x[np.isfinite(x)]
    if x.size and x.min() > 0 and x.max() > 10 * x.min():
        axes.set_xscale("log")
    for axis in (axes.xaxis, axes.yaxis):
        if axis.get_scale() == "log":
            write_plain_numbers(axis)


def write_plain_numbers(axis: Axis) -> None:
    """Plain numbers at the major ticks of an axis: powers would be mathtext."""
    from matplotlib.ticker import FuncFormatter, NullFormatter

    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def draw_interval(
    axis: Axes,
    x: Array,
    ends: tuple[Array, Array],
    colour: Any,
    *,
    bars: bool = False,
    label: str = "_",
) -> None:
    """An interval as a band, or as a bar at each point."""
    if bars:
        axis.vlines(x, *ends, color=colour, lw=0.7)
    else:
        axis.fill_between(x, *ends, color=colour, alpha=0.22, lw=0, label=label)


def _legend(axes: Axes) -> None:
    names = [str(label) for label in axes.get_legend_handles_labels()[1]]
    wide = axes.get_position().width * axes.figure.bbox.width / axes.figure.dpi  # inches
    legend = axes.legend(
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        borderaxespad=0.1,
        ncols=max(1, int(wide / (ENTRY + LETTER * max(map(len, names))))),
        columnspacing=1.2,
        handletextpad=0.5,
        markerscale=2.5,
    )
    for text in legend.get_texts():
        text.set_parse_math(False)
