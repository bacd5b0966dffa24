"""Texts of responses and loop gains, Bode and Nyquist figures."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...base.sentences import unit_at_axis
from ..figures.graph import draw_interval
from ..figures.style import ONE_COLUMN, TWO_COLUMNS, plt
from ..registry import shows
from .impedance import (
    PageColumns,
    keep_scale,
    legend_below,
    look,
    mark_degrees,
    panels,
    points,
    share_abscissa,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    import matplotlib.axes
    import matplotlib.figure
    import numpy as np

    from ...frequency import FrequencyResponse, LoopGain, MatrixResponse


@shows("text")
def response_text(response: FrequencyResponse) -> str:
    """Signals and range, and what each case leaves out."""
    f = response.frequency
    head = f"Frequency response {response.input} to {response.output}, {f[0]:g} to {f[-1]:g} Hz"
    if response.measured:
        return f"{head}, measured"
    at = f"speed {response.speed:g}" if not response.amplitude else f"{response.amplitude:g} of L"
    lines = [f"{head}, at {at}"]
    for case, gone in response.left_out.items():
        zero = "zero at every frequency, " if response.is_zero(case) else ""
        lines.append(f"  {case}: {zero}left out: {', '.join(gone) or 'nothing'}")
        if modes := response.unstable.get(case):
            lines.append(f"    UNSTABLE: a mode of the whole diagram grows, {modes}")
        if over := _left_over(response.left_over.get(case, ())):
            lines.append(f"    {over}: state speed= or amplitude=")
    if response.band is not None and response.band.undetermined:
        lines.append(f"  the band takes as known: {', '.join(response.band.undetermined)}")
    return "\n".join(lines)


def _left_over(names: Sequence[str]) -> str:
    """Words on cancellations whose friction is left out; "" for none."""
    if not names:
        return ""
    return f"friction is left out, its cancellation {', '.join(names)} is not"


@shows("text")
def matrix_response_text(response: MatrixResponse) -> str:
    """Numbers of outputs and inputs, the range, and what is left out."""
    shape = f"{len(response.data['output'])} outputs from {len(response.data['input'])} inputs"
    f = response.data["frequency"].values
    gone = f"; left out: {', '.join(response.left_out)}" if response.left_out else ""
    over = f"; {words}" if (words := _left_over(response.left_over)) else ""
    grows = f"; UNSTABLE: {response.unstable}" if response.unstable else ""
    return f"Response of {shape}, {f[0]:g} to {f[-1]:g} Hz{gone}{over}{grows}"


@shows("text")
def loop_text(loop: LoopGain) -> str:
    """The controller, and what is left out or sampled."""
    held = f"; sampled and held: {', '.join(loop.held)}" if loop.held else ""
    gone = ", ".join(loop.left_out) or "nothing"
    held += ", margins by an approximation" if loop.held and loop.sampled is None else ""
    held += f"; {words}" if (words := _left_over(loop.left_over)) else ""
    return f"Gain round the loop of {loop.controller}; left out: {gone}{held}"


@shows("figure")
def plot_bode(
    response: FrequencyResponse,
    *,
    measured: FrequencyResponse | None = None,
    columns: PageColumns = 1,
) -> matplotlib.figure.Figure:
    """Magnitude (dB) and phase (deg) against frequency (Hz); measured: drawn as points.

    A case that is zero at every frequency has no curve; the legend says that it is zero. Bands and
    bars are intervals of 95 %. A coherence has a panel of its own.
    """
    curves = [one for one in (response, measured) if one is not None]
    figure, axes = panels(columns, 3 if any(c.coherence is not None for c in curves) else 2)
    draw_bode(axes, curves, columns)
    ratio = f"{_symbol(response.output)}/{_symbol(response.input)}"
    unit = "" if response.unit == "1" else f" re 1 {unit_at_axis(response.unit)}"
    axes[0].set_ylabel(f"$|{ratio}|$ (dB{unit})")
    axes[1].set_ylabel(rf"$\angle\,{ratio}$ (deg)")
    _warn(axes[0], response)
    if len(axes[0].get_legend_handles_labels()[1]) > 1:
        legend_below(figure, axes[0])
    return figure


def draw_bode(
    axes: Sequence[matplotlib.axes.Axes],
    curves: Sequence[FrequencyResponse],
    columns: PageColumns = 1,
) -> None:
    """Magnitude (dB), phase (deg) and coherence of responses; the first one rules the phases."""
    for one in curves:
        for name in one.cases:
            _bode_lines(axes, one, curves[0], name)
    for axis in axes[:2]:
        keep_scale(axis)
    mark_degrees(axes[1])
    if len(axes) > 2:
        axes[2].set_ylabel("coherence (1)")
        axes[2].set_ylim(0.0, 1.05)
    ends = float(curves[0].frequency[0]), float(curves[0].frequency[-1])
    share_abscissa(axes, "frequency (Hz)", ends, columns)


def _bode_lines(
    axes: Sequence[matplotlib.axes.Axes],
    one: FrequencyResponse,
    model: FrequencyResponse,
    case: str,
) -> None:
    """Magnitude, phase and coherence of one case; model: of whose phase it lies beside."""
    import numpy as np

    style = points(case, alone=len(one.cases) == 1) if one.measured else look(case)
    style["label"] = _name(one, case)
    if one.is_zero(case):
        axes[0].plot([], [], **(style | {"label": f"{style['label']} (zero)"}))
        return
    k = one.row(case)
    size, phase = one.magnitude[k], _unwrap_beside(one, model, case)
    (line,) = axes[0].plot(one.frequency, 20 * np.log10(size), **style)
    axes[1].plot(one.frequency, phase, **style)
    if one.coherence is not None:
        axes[2].plot(one.frequency, one.coherence[k], **style)
    if one.band is None:
        return
    label = "_" if one.measured or k else "95 % interval"
    middles, halves = (20 * np.log10(size), phase), (one.band.decibel[k], one.band.degrees[k])
    for axis, middle, half in zip(axes, middles, halves, strict=False):
        draw_interval(
            axis,
            one.frequency,
            (middle - half, middle + half),
            line.get_color(),
            bars=one.measured,
            label=label,
        )


@shows("nyquist")
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
    unit = response.unit
    width = TWO_COLUMNS if columns == 2 else ONE_COLUMN
    figure, axis = plt.subplots(figsize=(width, 0.9 * ONE_COLUMN))
    axis.axhline(0.0, color="#BFBFBF", linewidth=0.5, zorder=0)
    axis.axvline(0.0, color="#BFBFBF", linewidth=0.5, zorder=0)
    for one in (response, measured):
        if one is None:
            continue
        for name in one.cases:
            z = one.values(name)
            style = points(name, alone=len(one.cases) == 1) if one.measured else look(name)
            axis.plot(z.real, z.imag, **(style | {"label": _name(one, name)}))
            if not one.measured:
                _decades(axis, one.frequency, z, style["color"])
    low, high = axis.get_xlim()
    if unit == "1" and low < -1 < high:
        axis.plot(-1, 0, "+", color="#000000", markersize=6)
    beside = "" if unit == "1" else f" ({unit_at_axis(unit)})"
    ratio = f"{_symbol(response.output)}/{_symbol(response.input)}"
    axis.set_xlabel(f"real part of ${ratio}${beside}")
    axis.set_ylabel(f"imaginary part of ${ratio}${beside}")
    (left, right), (lowest, highest) = axis.get_xlim(), axis.get_ylim()
    # room for labels, and no emptier page than the curve's shape
    height = 0.6 + (width - 0.6) * (highest - lowest) / (right - left)
    figure.set_size_inches(width, min(max(height, 1.6), 4.5))
    _warn(axis, response)
    axis.set_aspect("equal", adjustable="box")
    axis.grid(True)
    if measured is not None or len(response.cases) > 1:
        legend_below(figure, axis)
    return figure


def _warn(axis: matplotlib.axes.Axes, response: FrequencyResponse) -> None:
    """Above the figure: the cases that are unstable, and those that leave out only friction."""
    lines = []
    for words, cases in (
        ("unstable", response.unstable),
        ("friction left out", response.left_over),
    ):
        if names := [case for case in response.cases if cases.get(case)]:
            lines.append(f"{words}: {', '.join(names) if len(response.cases) > 1 else 'yes'}")
    if lines:
        axis.set_title("; ".join(lines), loc="left", fontsize=7, color="#B00000", pad=3)


def _symbol(signal: str) -> str:
    """The name of a signal as mathematics, with its last part as an index."""
    name, _, index = signal.partition("_")
    return rf"\mathrm{{{name}}}_{{\mathrm{{{index}}}}}" if index else rf"\mathrm{{{name}}}"


def _name(one: FrequencyResponse, case: str) -> str:
    if not one.measured:
        return str(look(case)["label"])
    return "measured" if len(one.cases) == 1 else "_"


def _unwrap_beside(one: FrequencyResponse, model: FrequencyResponse, case: str) -> np.ndarray:
    """Phase of a case, shifted by multiples of 360 degrees to lie beside the phase of the model."""
    import numpy as np

    phase, f = one.phase[one.row(case)], np.log(model.frequency)
    line = model.phase[model.row(case if case in model.cases else "")]
    expected = np.interp(np.log(one.frequency), f, line)
    return np.asarray(phase + 360 * np.round(np.nanmedian(expected - phase) / 360))


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
