"""Panels over frequency, and text and figures of an impedance over frequency and amplitude.

A figure of one column is 3.5 in wide with magnitude above phase, a figure of two columns is 7.16 in
wide with both side by side; fonts, lines and colours are the same. A model is drawn as lines,
measurements as points, here and in figures over amplitude.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

from ...base.sentences import unit_at_axis
from ..figures.graph import draw_interval, write_plain_numbers
from ..figures.style import CASES, ONE_COLUMN, TWO_COLUMNS, in_house_style, plt
from ..registry import shows

if TYPE_CHECKING:
    import matplotlib.axes
    import matplotlib.figure
    import numpy as np

    from ...frequency import ImpedanceMap

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
    from matplotlib.ticker import LogLocator

    axis.set_xscale("log")
    if low < high:
        axis.set_xlim(low, high)
    subs = (1.0, 2.0, 5.0) if high < 100 * low else (1.0,)
    axis.xaxis.set_major_locator(LogLocator(subs=subs))
    write_plain_numbers(axis.xaxis)


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


_WHICH = "points: simulated, lines: describing functions"


@shows("text")
def impedance_text(result: ImpedanceMap) -> str:
    """Ranges of frequency and amplitude, and those of size and phase of each case."""
    f, a = result.data["frequency"].values, result.data["amplitude"].values
    unit = result.data["amplitude"].attrs["units"]
    how = "following frequency" if result.on_profile else f"{len(a)} of them at each"
    lines = [
        f"{'Measured' if result.measured else 'Quasi-linear'} impedance, {len(f)} frequencies "
        f"{f.min():g} to {f.max():g} Hz, amplitude {a.min():g} to {a.max():g} {unit}, {how}"
    ]
    for case in result.data["case"].values:
        z, p = result.decibel.sel(case=case), result.phase.sel(case=case)
        line = (
            f"  {case!s:<8} {float(z.min()):.1f} to {float(z.max()):.1f} {z.attrs['units']}, "
            f"{float(p.min()):.0f} to {float(p.max()):.0f} deg"
        )
        if result.measured:
            line += f", settled to {float(result.data['unsettled'].sel(case=case).max()):.1g}"
        lines.append(line)
    return "\n".join(lines)


@shows("figure")
def plot_impedance(
    result: ImpedanceMap,
    *,
    against: Literal["frequency", "amplitude"] = "frequency",
    model: ImpedanceMap | None = None,
    columns: PageColumns = 1,
) -> matplotlib.figure.Figure:
    """Size (dB) and phase (0 to 360 degrees), as in figures 6 and 7 of Bernstein, Lawrence, Pao.

    Several values of the other variable are drawn in shades, from light to dark. Bands are
    intervals of 95 %, at the darkest.

    model: drawn as lines; `result` is then drawn as points
    """

    figure, (upper, lower) = panels(columns)
    for one in (result, model):
        if one is not None:
            dotted = one is result and model is not None
            _impedance_lines((upper, lower), one, against, dotted=dotted)
    x, label = _scale(result, against)
    unit = unit_at_axis(result.decibel.attrs["units"])
    upper.set_ylabel(rf"$|\hat Z_M|$ ({unit})")
    lower.set_ylabel(r"phase of $\hat Z_M$ (deg)")
    keep_scale(upper)
    lower.set_ylim(0, 360)
    mark_degrees(lower)
    share_abscissa((upper, lower), label, (float(x.min()), float(x.max())), columns)
    if len(result.data["case"]) > 1:
        # below 90 and above 270 degrees there is room
        lower.legend(loc="upper left", ncols=1 if columns == 2 else 2)
    texts = [_shade_text(result, _other_variable(result, against)), _WHICH if model else ""]
    upper.set_title("; ".join(t for t in texts if t), loc="left", pad=3)
    return figure


def _impedance_lines(
    axes: tuple[matplotlib.axes.Axes, matplotlib.axes.Axes],
    result: ImpedanceMap,
    against: Literal["frequency", "amplitude"],
    *,
    dotted: bool,
) -> None:
    x, _ = _scale(result, against)
    other = _other_variable(result, against)
    shades, band = result.data[other].values if other else [None], result.band
    for case in map(str, result.data["case"].values):
        for k, value in enumerate(shades):
            chosen = {"case": case} | ({other: value} if other else {})
            style = points(case, alone=False) if dotted else look(case)
            style["alpha"] = 1.0 - 0.75 * (len(shades) - 1 - k) / len(shades)
            if k < len(shades) - 1:
                style["label"] = "_"
            halves = () if band is None else (band.decibel, band.degrees)
            for j, values in enumerate((result.decibel, result.phase)):
                y = values.sel(chosen).values
                (line,) = axes[j].plot(x, y, **style)
                if halves and k == len(shades) - 1:
                    half = values.copy(data=halves[j]).sel(chosen).values
                    draw_interval(axes[j], x, (y - half, y + half), line.get_color())


@in_house_style
def plot_spread(
    result: ImpedanceMap, *, model: ImpedanceMap | None = None, columns: PageColumns = 1
) -> matplotlib.figure.Figure:
    """Deviation from linearity: spread of size and phase over amplitude, against frequency.

    model: drawn as lines; `result` is then drawn as points
    """

    figure, axes = panels(columns)
    for one in (result, model):
        if one is None:
            continue
        spread, dotted = one.spread(), one is result and model is not None
        for case in map(str, one.data["case"].values):
            style = points(case, alone=False) if dotted else look(case)
            for axis, name in zip(axes, ("size", "phase"), strict=True):
                axis.plot(spread["frequency"], spread[name].sel(case=case), **style)
    axes[0].set_ylabel(r"spread of $|\hat Z_M|$ (dB)")
    axes[1].set_ylabel(r"spread of phase (deg)")
    for axis in axes:
        axis.set_ylim(bottom=0.0)
    f = result.data["frequency"].values
    share_abscissa(axes, "frequency (Hz)", (float(f.min()), float(f.max())), columns)
    if len(result.data["case"]) > 1:
        legend_below(figure, axes[0])
    axes[0].set_title(_WHICH if model else "", loc="left", pad=3)
    return figure


def _scale(result: ImpedanceMap, name: str) -> tuple[np.ndarray, str]:
    values = result.data[name].values
    unit = result.data[name].attrs["units"]
    if name == "frequency":
        return values, "frequency (Hz)"
    return (1e3 * values, "amplitude (mm)") if unit == "m" else (values, f"amplitude ({unit})")


def _other_variable(result: ImpedanceMap, against: str) -> str:
    """The variable that is not the abscissa; "" if the map lies on a profile of both."""
    other = "amplitude" if against == "frequency" else "frequency"
    return "" if result.on_profile else other


def _shade_text(result: ImpedanceMap, other: str) -> str:
    if not other or result.data.sizes[other] == 1:
        return ""
    values, label = _scale(result, other)
    name, _, unit = label.partition(" ")
    shown = ", ".join(f"{v:.3g}" for v in values)
    if len(values) > 5:
        shown = f"{values[0]:.3g} to {values[-1]:.3g}"
    return f"{name} {shown} {unit.strip('()')}, light to dark"
