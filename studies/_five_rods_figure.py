"""Figure of the five rods: singular values, simulated errors, friction in a plane of the hand."""

from __future__ import annotations

import matplotlib.figure
import matplotlib.pyplot as plt
import xarray
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, NullFormatter

from teleopdesign.show.figures.style import CASES, TWO_COLUMNS, house_style

BLACK, GREY, BLUE, ORANGE, GREEN = "#000000", "#999999", "#0072B2", "#D55E00", "#009E73"
BANDS = {"no compensation": BLACK, "force feedback": ORANGE}
COMPENSATIONS = {
    "none": "no compensation",
    "FF": "force feedback",
    "hybrid": "force feedback, cancellation",
}


def draw(data: xarray.Dataset, felt: dict[str, tuple[float, float]]) -> matplotlib.figure.Figure:
    """Three panels; felt: smallest and largest friction in any direction, N."""
    with plt.style.context(house_style()):
        figure, (left, middle, right) = plt.subplots(
            1, 3, figsize=(TWO_COLUMNS, 3.0), width_ratios=(1.15, 1.15, 1)
        )
        _bands(left, data["singular_value"])
        _errors(middle, data["error"])
        _friction(right, data, felt)
        for letter, axis in zip("abc", (left, middle, right), strict=True):
            axis.set_title(f"({letter})", loc="left", pad=3)
            axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2))
    return figure


def _bands(axis: Axes, values: xarray.DataArray) -> None:
    f = values["frequency"].values
    for name, colour in BANDS.items():
        one = values.sel(response=name).values
        axis.fill_between(f, one[:, -1], one[:, 0], color=colour, alpha=0.18, linewidth=0)
        for k in (0, -1):
            axis.plot(f, one[:, k], color=colour, label=name if k else None)
    others = [r for r in values["response"].values if "hand" in str(r)]
    both = values.sel(response=others)
    low, high = both.min(("response", "order")).values, both.max(("response", "order")).values
    axis.fill_between(f, low, high, color=BLUE, alpha=0.15, linewidth=0)
    label = "with inverse, for hands half or twice as firm"
    for edge in (low, high):
        axis.plot(f, edge, ":", color=BLUE, label=label if edge is high else None)
    axis.plot(f, values.sel(response="inverse").values[:, 0], color=BLUE, label="with inverse")
    axis.set(xscale="log", yscale="log", xlim=(f[0], f[-1]), ylim=(0.05, 4))
    axis.set_xlabel("frequency (Hz)")
    axis.set_ylabel(r"singular values of $F_{\mathrm{want}} \to G^T R_M$ (1)")
    _plain(axis)
    axis.grid(True)


def _errors(axis: Axes, errors: xarray.DataArray) -> None:
    f = errors["driven"].values
    for compensation, text in COMPENSATIONS.items():
        for inverse, line in ((False, "-"), (True, "--")):
            worst = errors.sel(compensation=compensation, inverse=inverse).max("coordinate").values
            label = f"{text}, inverse" if inverse else text
            colour = CASES[compensation][0]
            style = {"color": colour, "linestyle": line, "marker": "o", "markersize": 2.5}
            axis.plot(f, worst, label=label, markerfacecolor="w" if inverse else colour, **style)
    size = errors.attrs["wanted"]
    axis.axhline(size, color=GREY, linewidth=0.8)
    axis.text(f[0], 1.06 * size, "wanted force", color=GREY, fontsize=7)
    axis.set(xscale="log", yscale="log")
    axis.set_xlabel("frequency of the wanted force (Hz)")
    axis.set_ylabel("rms force error, worst coordinate (N)")
    _plain(axis)
    axis.grid(True)


def _friction(axis: Axes, data: xarray.Dataset, felt: dict[str, tuple[float, float]]) -> None:
    colours = {"before": GREY, "after": GREEN}
    texts = {"before": "no cancellation", "after": "90 % cancelled"}
    for case, colour in colours.items():
        edge = data["outline"].sel(case=case).values
        points = data["friction"].sel(case=case).values
        least, most = felt[case]
        label = f"{texts[case]}: over all\ndirections {least:.2f} to {most:.2f} N"
        axis.fill(*edge.T, facecolor=colour, alpha=0.25, linewidth=0)
        axis.plot(*edge.T, color=colour, label=label)
        label = "simulated" if case == "after" else None
        axis.plot(*points.T, ".", color=BLACK, markersize=1.2, label=label)
    axis.set_aspect("equal", adjustable="datalim")
    x, y = (str(name) for name in data["axis"].values)
    axis.set_xlabel(f"friction along {x} (N)")
    axis.set_ylabel(f"friction along {y} (N)")
    axis.grid(True)


def _plain(axis: Axes) -> None:
    """Numbers in place of powers of ten."""
    for one in (axis.xaxis, axis.yaxis):
        one.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        one.set_minor_formatter(NullFormatter())
