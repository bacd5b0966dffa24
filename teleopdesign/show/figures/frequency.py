"""Bode and Nyquist figures. Nothing is computed.

A figure of one column is 3.5 in wide with magnitude above phase, a figure of two columns is 7.16 in
wide with both side by side; fonts, lines and colours are the same. A model is drawn as lines,
measurements as points.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...base.sentences import unit_at_axis
from .design import ONE_COLUMN, TWO_COLUMNS
from .frequency_axes import (
    PageColumns,
    legend_below,
    look,
    mark_degrees,
    panels,
    points,
    share_abscissa,
)
from .letters import house_style

if TYPE_CHECKING:
    import matplotlib.axes
    import matplotlib.figure
    import numpy as np
    import xarray

    from ...frequency import FrequencyResponse


def plot_bode(
    response: FrequencyResponse,
    *,
    measured: FrequencyResponse | None = None,
    columns: PageColumns = 1,
) -> matplotlib.figure.Figure:
    """Magnitude (dB) and phase (deg) against frequency (Hz); measured: drawn as points.

    A case that is zero at every frequency has no curve; the legend says that it is zero.
    """
    import matplotlib.pyplot as plt
    import numpy as np

    with plt.style.context(house_style()):
        figure, (upper, lower) = panels(columns)
        for one in (response, measured):
            if one is None:
                continue
            f = one.data["frequency"].values
            names = [str(case) for case in one.data["case"].values]
            for name in names:
                part = one.data.sel(case=name)
                style = points(name, alone=len(names) == 1) if one.measured else look(name)
                style["label"] = _name(one, name)
                if one.is_zero(name):
                    upper.plot([], [], **(style | {"label": f"{style['label']} (zero)"}))
                    continue
                upper.plot(f, 20 * np.log10(part["magnitude"]), **style)
                lower.plot(f, _unwrap_beside(part["phase"], response, name), **style)
        unit = response.data["magnitude"].attrs["units"]
        upper.set_ylabel(
            "magnitude (dB)" if unit == "1" else f"magnitude (dB re 1 {unit_at_axis(unit)})"
        )
        lower.set_ylabel("phase (deg)")
        mark_degrees(lower)
        ends = response.data["frequency"].values
        share_abscissa(upper, lower, "frequency (Hz)", (float(ends[0]), float(ends[-1])), columns)
        if measured is not None or len(response.data["case"]) > 1:
            legend_below(figure, upper)
    return figure


def plot_nyquist(
    response: FrequencyResponse,
    *,
    measured: FrequencyResponse | None = None,
    columns: PageColumns = 1,
) -> matplotlib.figure.Figure:
    """Imaginary part against real part, with a dot at each decade of frequency.

    response: drawn as lines, in its unit;  measured: drawn as points, of the same cases
    columns: width of the figure in columns of a page, 1 or 2
    """
    import matplotlib.pyplot as plt

    unit = response.data["magnitude"].attrs["units"]
    width = TWO_COLUMNS if columns == 2 else ONE_COLUMN
    with plt.style.context(house_style()):
        figure, axis = plt.subplots(figsize=(width, 0.9 * ONE_COLUMN))
        axis.axhline(0.0, color="#BFBFBF", linewidth=0.5, zorder=0)
        axis.axvline(0.0, color="#BFBFBF", linewidth=0.5, zorder=0)
        for one in (response, measured):
            if one is None:
                continue
            names = [str(case) for case in one.data["case"].values]
            for name in names:
                z = one.values(name)
                style = points(name, alone=len(names) == 1) if one.measured else look(name)
                axis.plot(z.real, z.imag, **(style | {"label": _name(one, name)}))
                if not one.measured:
                    _decades(axis, one.data["frequency"].values, z, style["color"])
        low, high = axis.get_xlim()
        if unit == "1" and low < -1 < high:
            axis.plot(-1, 0, "+", color="#000000", markersize=6)
        beside = "" if unit == "1" else f" ({unit_at_axis(unit)})"
        axis.set_xlabel(f"real part{beside}")
        axis.set_ylabel(f"imaginary part{beside}")
        (left, right), (lowest, highest) = axis.get_xlim(), axis.get_ylim()
        # room for labels, and no emptier page than the curve's shape
        height = 0.6 + (width - 0.6) * (highest - lowest) / (right - left)
        figure.set_size_inches(width, min(max(height, 1.6), 4.5))
        axis.set_aspect("equal", adjustable="box")
        axis.grid(True)
        if measured is not None or len(response.data["case"]) > 1:
            legend_below(figure, axis)
    return figure


def _name(one: FrequencyResponse, case: str) -> str:
    if not one.measured:
        return str(look(case)["label"])
    return "measured" if len(one.data["case"]) == 1 else "_"


def _unwrap_beside(phase: xarray.DataArray, model: FrequencyResponse, case: str) -> np.ndarray:
    """Measured phase, shifted by multiples of 360 degrees to lie beside the phase of the model."""
    import numpy as np

    known = [str(c) for c in model.data["case"].values]
    line = model.data["phase"].sel(case=case if case in known else known[0])
    f = np.log(line["frequency"].values)
    expected = np.interp(np.log(phase["frequency"].values), f, line.values)
    return np.asarray(phase.values + 360 * np.round(np.median(expected - phase.values) / 360))


def _decades(axis: matplotlib.axes.Axes, f: np.ndarray, z: np.ndarray, colour: str | None) -> None:
    import numpy as np

    tens = 10.0 ** np.arange(np.ceil(np.log10(f[0])), np.floor(np.log10(f[-1])) + 1)
    at = [int(np.argmin(np.abs(np.log(f / ten)))) for ten in tens]
    axis.plot(z[at].real, z[at].imag, ".", color=colour or "#000000", markersize=4)
    if axis.texts:
        return  # another case has the names
    apart = 0.1 * max(float(np.ptp(z.real)), float(np.ptp(z.imag)))
    named: list[complex] = []
    for ten, k in zip(tens, at, strict=True):
        if all(abs(z[k] - other) > apart for other in named):
            named.append(z[k])
            beside = (float(z[k].real), float(z[k].imag))
            axis.annotate(f"{ten:g} Hz", beside, (3, 3), textcoords="offset points", fontsize=6)
