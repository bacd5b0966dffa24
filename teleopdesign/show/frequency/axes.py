"""The style of figures over frequency and amplitude: cases, points, panels, abscissa."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

from ..figures.style import CASES, ONE_COLUMN, TWO_COLUMNS

if TYPE_CHECKING:
    import matplotlib.axes
    import matplotlib.figure

PageColumns = Literal[1, 2]
MEASURED = "#7F7F7F"
#: inches that the longest entry of a legend takes
ENTRY = 1.7


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


def panels(columns: PageColumns) -> tuple[matplotlib.figure.Figure, Any]:
    """Two panels with a common abscissa: one above the other, or side by side for two columns."""
    import matplotlib.pyplot as plt

    if columns == 2:
        return plt.subplots(1, 2, sharex=True, figsize=(TWO_COLUMNS, 2.4))
    return plt.subplots(2, 1, sharex=True, figsize=(ONE_COLUMN, 3.6))


def share_abscissa(
    upper: matplotlib.axes.Axes,
    lower: matplotlib.axes.Axes,
    label: str,
    ends: tuple[float, float],
    columns: PageColumns,
) -> None:
    """A logarithmic abscissa for both panels, labelled below the lower panel or below the row."""
    logarithmic(lower, *ends)
    for axis in (upper, lower):
        axis.grid(True)
        if columns == 2 or axis is lower:
            axis.set_xlabel(label)
    upper.figure.align_ylabels()


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
    across = max(1, int(figure.get_figwidth() / ENTRY))
    figure.legend(handles, labels, loc="outside lower center", ncols=min(len(labels), across))
