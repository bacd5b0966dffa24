"""Text and figures of an impedance over frequency and amplitude."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from ...base.sentences import unit_at_axis
from ..figures.style import house_style
from ..registry import shows
from .panels import (
    PageColumns,
    draw_interval,
    keep_scale,
    legend_below,
    look,
    mark_degrees,
    panels,
    points,
    share_abscissa,
)

if TYPE_CHECKING:
    import matplotlib.axes
    import matplotlib.figure
    import numpy as np

    from ...frequency import ImpedanceMap

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


def plot_spread(
    result: ImpedanceMap, *, model: ImpedanceMap | None = None, columns: PageColumns = 1
) -> matplotlib.figure.Figure:
    """Deviation from linearity: spread of size and phase over amplitude, against frequency.

    model: drawn as lines; `result` is then drawn as points
    """
    import matplotlib.pyplot as plt

    with plt.style.context(house_style()):
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
