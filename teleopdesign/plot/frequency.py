"""Figures over frequency and amplitude: Bode, impedance, Nyquist. Nothing is computed.

One column is 3.5 in wide with magnitude above phase, two are 7.16 in with them side by side; fonts,
lines and colours are the same. A model is drawn as lines, what was measured as points.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

from .design import CASES, ONE_COLUMN, STYLE, TWO_COLUMNS, unit_text

if TYPE_CHECKING:
    import matplotlib.axes
    import matplotlib.figure
    import numpy as np
    import xarray

    from ..frequency import FrequencyResponse, ImpedanceMap

Columns = Literal[1, 2]
MEASURED = "#7F7F7F"
_WHICH = "points: simulated, lines: describing functions"


def look(case: str) -> dict[str, Any]:
    """Colour, line and label of a case, the same in every figure."""
    colour, line, label = CASES.get(case, (None, "-", case))
    return {"color": colour, "linestyle": line, "label": label}


def points(case: str, *, alone: bool) -> dict[str, Any]:
    """Look of what was measured: grey, or the colour of its case where there are several."""
    colour = MEASURED if alone or case not in CASES else CASES[case][0]
    return {
        "color": colour,
        "linestyle": "none",
        "marker": "o",
        "markersize": 2.6,
        "markerfacecolor": "none",
        "markeredgewidth": 0.7,
    }


def plot_bode(
    response: FrequencyResponse,
    *,
    measured: FrequencyResponse | None = None,
    columns: Columns = 1,
) -> matplotlib.figure.Figure:
    """Magnitude in dB and phase against frequency; measured: drawn as points beside it."""
    import matplotlib.pyplot as plt
    import numpy as np

    with plt.style.context(STYLE):
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
                upper.plot(f, 20 * np.log10(part["magnitude"]), **style)
                lower.plot(f, _beside(part["phase"], response, name), **style)
        unit = response.data["magnitude"].attrs["units"]
        upper.set_ylabel(
            "magnitude (dB)" if unit == "1" else f"magnitude (dB re 1 {unit_text(unit)})"
        )
        lower.set_ylabel("phase (deg)")
        _degrees(lower)
        ends = response.data["frequency"].values
        _against(upper, lower, "frequency (Hz)", (float(ends[0]), float(ends[-1])), columns)
        if measured is not None or len(response.data["case"]) > 1:
            upper.legend()
    return figure


def plot_impedance(
    result: ImpedanceMap,
    *,
    against: Literal["frequency", "amplitude"] = "frequency",
    model: ImpedanceMap | None = None,
    columns: Columns = 1,
) -> matplotlib.figure.Figure:
    """Size in dB and phase in 0 to 360 degrees, as figures 6 and 7 of Bernstein, Lawrence, Pao.

    Several values of the other variable are shades, from light to dark.
    model: drawn as lines, `result` then as points
    """
    import matplotlib.pyplot as plt

    with plt.style.context(STYLE):
        figure, (upper, lower) = panels(columns)
        for one in (result, model):
            if one is not None:
                dotted = one is result and model is not None
                _impedance_lines((upper, lower), one, against, dotted=dotted)
        x, label = _scale(result, against)
        unit = unit_text(result.decibel.attrs["units"])
        upper.set_ylabel(rf"$|\hat Z_M|$ ({unit})")
        lower.set_ylabel(r"phase of $\hat Z_M$ (deg)")
        lower.set_ylim(0, 360)
        _degrees(lower)
        _against(upper, lower, label, (float(x.min()), float(x.max())), columns)
        if len(result.data["case"]) > 1:
            # below 90 and above 270 degrees there is room
            lower.legend(loc="upper left", ncols=1 if columns == 2 else 2)
        texts = [_shade_text(result, _other(result, against)), _WHICH if model else ""]
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
    other = _other(result, against)
    shades = result.data[other].values if other else [None]
    for case in map(str, result.data["case"].values):
        for k, value in enumerate(shades):
            chosen = {"case": case} | ({other: value} if other else {})
            style = points(case, alone=False) if dotted else look(case)
            style["alpha"] = 1.0 - 0.75 * (len(shades) - 1 - k) / len(shades)
            if k < len(shades) - 1:
                style["label"] = "_"
            axes[0].plot(x, result.decibel.sel(chosen), **style)
            axes[1].plot(x, result.phase.sel(chosen), **style)


def plot_spread(
    result: ImpedanceMap, *, model: ImpedanceMap | None = None, columns: Columns = 1
) -> matplotlib.figure.Figure:
    """How far from linear: spread of size and phase over amplitude, against frequency.

    model: drawn as lines, `result` then as points
    """
    import matplotlib.pyplot as plt

    with plt.style.context(STYLE):
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
        _against(axes[0], axes[1], "frequency (Hz)", (float(f.min()), float(f.max())), columns)
        if len(result.data["case"]) > 1:
            axes[0].legend()
        axes[0].set_title(_WHICH if model else "", loc="left", pad=3)
    return figure


def plot_nyquist(
    response: FrequencyResponse,
    *,
    measured: FrequencyResponse | None = None,
    columns: Columns = 1,
) -> matplotlib.figure.Figure:
    """Imaginary against real part; a dot at each decade of frequency."""
    import matplotlib.pyplot as plt

    unit = response.data["magnitude"].attrs["units"]
    width = TWO_COLUMNS if columns == 2 else ONE_COLUMN
    with plt.style.context(STYLE):
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
        beside = "" if unit == "1" else f" ({unit_text(unit)})"
        axis.set_xlabel(f"real part{beside}")
        axis.set_ylabel(f"imaginary part{beside}")
        (left, right), (lowest, highest) = axis.get_xlim(), axis.get_ylim()
        # room for labels, and no emptier page than the curve's own shape
        height = 0.6 + (width - 0.6) * (highest - lowest) / (right - left)
        figure.set_size_inches(width, min(max(height, 1.6), 4.5))
        axis.set_aspect("equal", adjustable="box")
        axis.grid(True)
        if measured is not None or len(response.data["case"]) > 1:
            axis.legend()
    return figure


def panels(columns: Columns) -> tuple[matplotlib.figure.Figure, Any]:
    """Two panels that share their abscissa: above each other, or side by side in two columns."""
    import matplotlib.pyplot as plt

    if columns == 2:
        return plt.subplots(1, 2, sharex=True, figsize=(TWO_COLUMNS, 2.4))
    return plt.subplots(2, 1, sharex=True, figsize=(ONE_COLUMN, 3.6))


def _against(
    upper: matplotlib.axes.Axes,
    lower: matplotlib.axes.Axes,
    label: str,
    ends: tuple[float, float],
    columns: Columns,
) -> None:
    logarithmic(lower, *ends)
    for axis in (upper, lower):
        axis.grid(True)
        if columns == 2 or axis is lower:
            axis.set_xlabel(label)
    upper.figure.align_ylabels()


def logarithmic(axis: matplotlib.axes.Axes, low: float, high: float) -> None:
    """Logarithmic abscissa with plain numbers; 2 and 5 too where it spans under two decades."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axis.set_xscale("log")
    if low < high:
        axis.set_xlim(low, high)
    subs = (1.0, 2.0, 5.0) if high < 100 * low else (1.0,)
    axis.xaxis.set_major_locator(LogLocator(subs=subs))
    axis.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    axis.xaxis.set_minor_formatter(NullFormatter())


def _degrees(axis: matplotlib.axes.Axes) -> None:
    from matplotlib.ticker import MultipleLocator

    low, high = axis.get_ylim()
    if high - low > 90:
        axis.yaxis.set_major_locator(MultipleLocator(90 if high - low > 270 else 45))


def _name(one: FrequencyResponse, case: str) -> str:
    if not one.measured:
        return str(look(case)["label"])
    return "measured" if len(one.data["case"]) == 1 else "_"


def _beside(phase: xarray.DataArray, model: FrequencyResponse, case: str) -> np.ndarray:
    """Measured phase on the turn of the model's, which is unwrapped from another start."""
    import numpy as np

    known = [str(c) for c in model.data["case"].values]
    line = model.data["phase"].sel(case=case if case in known else known[0])
    f = np.log(line["frequency"].values)
    expected = np.interp(np.log(phase["frequency"].values), f, line.values)
    return np.asarray(phase.values + 360 * np.round(np.median(expected - phase.values) / 360))


def _scale(result: ImpedanceMap, name: str) -> tuple[np.ndarray, str]:
    values = result.data[name].values
    unit = result.data[name].attrs["units"]
    if name == "frequency":
        return values, "frequency (Hz)"
    return (1e3 * values, "amplitude (mm)") if unit == "m" else (values, f"amplitude ({unit})")


def _other(result: ImpedanceMap, against: str) -> str:
    """The variable that is not the abscissa; "" where there is none or one value of it."""
    other = "amplitude" if against == "frequency" else "frequency"
    return "" if result.on_profile else other


def _shade_text(result: ImpedanceMap, other: str) -> str:
    if not other or result.data.sizes[other] == 1:
        return ""
    values, label = _scale(result, other)
    name, _, unit = label.partition(" ")
    return f"{name} {', '.join(f'{v:.3g}' for v in values)} {unit.strip('()')}, light to dark"


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
