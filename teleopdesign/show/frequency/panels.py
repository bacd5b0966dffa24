"""Panels over frequency: columns of a page, abscissa, looks of cases, points and intervals.

A figure of one column is 3.5 in wide with magnitude above phase, a figure of two columns is 7.16 in
wide with both side by side; fonts, lines and colours are the same. A model is drawn as lines,
measurements as points, here and in figures over amplitude.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

from ..figures.style import CASES, ONE_COLUMN, TWO_COLUMNS

if TYPE_CHECKING:
    import matplotlib.axes
    import matplotlib.figure
    import numpy as np

PageColumns = Literal[1, 2]
MEASURED = "#7F7F7F"
#: inches that an entry of a legend takes beside its words, and that a letter takes
ENTRY, LETTER = 0.45, 0.05


def look(case: str) -> dict[str, Any]:
    """Colour, line style and label of a case, the same in every figure."""
    colour, line, label = CASES.get(case, (None, "-", case))
    return {"color": colour, "linestyle": line, "label": label}


def points(case: str, *, alone: bool) -> dict[str, Any]:
    """Style of measured points: grey, or the colour of the case if there are several cases."""
    colour = MEASURED if alone or case not in CASES else CASES[case][0]
    return {
        "color": colour,
        "linestyle": "none",
        "marker": "o",
        "markersize": 2.6,
        "markerfacecolor": "none",
        "markeredgewidth": 0.7,
    }


def panels(columns: PageColumns, count: int = 2) -> tuple[matplotlib.figure.Figure, Any]:
    """Panels with a common abscissa: one above the other, or side by side for two columns.

    A third panel is lower than the others.
    """
    import matplotlib.pyplot as plt

    if columns == 2:
        return plt.subplots(1, count, sharex=True, figsize=(TWO_COLUMNS, 2.4))
    heights = [1.0, 1.0, 0.55][:count]
    size = (ONE_COLUMN, 1.8 * sum(heights))
    return plt.subplots(count, 1, sharex=True, figsize=size, height_ratios=heights)


def share_abscissa(
    axes: Sequence[matplotlib.axes.Axes],
    label: str,
    ends: tuple[float, float],
    columns: PageColumns,
) -> None:
    """A logarithmic abscissa for all panels, labelled below the lowest or below each of a row."""
    logarithmic(axes[-1], *ends)
    for axis in axes:
        axis.grid(True)
        if columns == 2 or axis is axes[-1]:
            axis.set_xlabel(label)
    axes[0].figure.align_ylabels()


def logarithmic(axis: matplotlib.axes.Axes, low: float, high: float) -> None:
    """A logarithmic abscissa with plain numbers; also 2 and 5 on a range below two decades."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axis.set_xscale("log")
    if low < high:
        axis.set_xlim(low, high)
    subs = (1.0, 2.0, 5.0) if high < 100 * low else (1.0,)
    axis.xaxis.set_major_locator(LogLocator(subs=subs))
    axis.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    axis.xaxis.set_minor_formatter(NullFormatter())


def mark_degrees(axis: matplotlib.axes.Axes) -> None:
    """Ticks at every 45 or 90 degrees, if the range is wide enough."""
    from matplotlib.ticker import MultipleLocator

    low, high = axis.get_ylim()
    if high - low > 90:
        axis.yaxis.set_major_locator(MultipleLocator(90 if high - low > 270 else 45))


def legend_below(figure: matplotlib.figure.Figure, axis: matplotlib.axes.Axes) -> None:
    """The legend of one axis below the whole figure, where it covers no curve."""
    handles, labels = axis.get_legend_handles_labels()
    longest = max(len(str(label)) for label in labels)
    across = max(1, int(figure.get_figwidth() / (ENTRY + LETTER * longest)))
    figure.legend(handles, labels, loc="outside lower center", ncols=min(len(labels), across))


def draw_interval(
    axis: matplotlib.axes.Axes,
    x: np.ndarray,
    ends: tuple[np.ndarray, np.ndarray],
    colour: Any,
    *,
    bars: bool = False,
    label: str = "_",
) -> None:
    """An interval as a band, or as a bar at each point; `keep_scale` follows."""
    if bars:
        axis.vlines(x, *ends, color=colour, lw=0.6)
    else:
        axis.fill_between(x, *ends, color=colour, alpha=0.22, lw=0, label=label)


def keep_scale(axis: matplotlib.axes.Axes) -> None:
    """Let wide intervals leave the axis, so that curves and points keep at least a third of it."""
    import numpy as np

    lines = [np.asarray(one.get_ydata(), float) for one in axis.lines]
    drawn = np.concatenate([np.zeros(0), *lines])
    drawn = drawn[np.isfinite(drawn)]
    if not drawn.size:
        return
    low, high = float(drawn.min()), float(drawn.max())
    room = max(high - low, 1e-3 * max(abs(low), abs(high)), 1e-9)
    bottom, top = axis.get_ylim()
    axis.set_ylim(max(bottom, low - room), min(top, high + room))
