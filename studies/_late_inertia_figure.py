"""Figure of inertia that is cancelled late: damping given out, impedance felt, shares allowed."""

from __future__ import annotations

import matplotlib.figure
import matplotlib.pyplot as plt
import xarray
from _late_inertia import DAMPING
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, NullFormatter

from teleopdesign.show.figures.style import TWO_COLUMNS, house_style

BLACK, GREY = "#000000", "#999999"
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", BLACK)


def draw(data: xarray.Dataset) -> matplotlib.figure.Figure:
    """Four panels."""
    with plt.style.context(house_style()):
        figure, axes = plt.subplots(2, 2, figsize=(TWO_COLUMNS, 5.4))
        panels = (_given_out, _felt, _passive, _stable)
        for letter, axis, panel in zip("abcd", axes.flat, panels, strict=True):
            panel(axis, data)
            axis.set_title(f"({letter})", loc="left", pad=3)
            axis.grid(True)
            axis.legend(loc="best")
    return figure


def _given_out(axis: Axes, data: xarray.Dataset) -> None:
    texts = {"fast": "low-pass 1 kHz", "slow": "low-pass 30 Hz"}
    f = data["frequency"].values
    for name, colour in zip(data["filter"].values, (BLACK, *COLOURS), strict=False):
        one = data["released_energy"].sel(filter=name).values
        axis.plot(f, one, color=colour, label=texts.get(str(name), str(name)))
        if name in texts:
            points = data["given_out_simulated"].sel(simulated_filter=name)
            axis.plot(points["driven"].values, points.values, "o", color=colour, markersize=3.5)
    axis.axhline(DAMPING, color=GREY, linestyle="--", label="damping of the device")
    axis.set_xscale("log")
    axis.set_yscale("asinh", linear_width=0.3)
    axis.set(xlim=(f[0], f[-1]), ylim=(-500, 500))
    axis.set_yticks([-100, -10, -1, 0, 1, 10, 100])
    axis.set_xlabel("frequency (Hz)")
    axis.set_ylabel(r"negative damping given out (N$\,$s/m)")
    _plain(axis)


def _felt(axis: Axes, data: xarray.Dataset) -> None:
    f = data["felt_frequency"].values
    for name, colour in zip(data["case"].values, COLOURS, strict=False):
        one = data.sel(case=name)
        axis.plot(f, one["felt"].values, color=colour, label=str(name))
        axis.plot(f, one["apparent_mass"].values, ":", color=colour)
    axis.plot([], [], "-", color=BLACK, label="impedance")
    axis.plot([], [], ":", color=BLACK, label="mass alone")
    axis.axhline(1.0, color=GREY, linestyle="--", linewidth=0.8)
    axis.set(xscale="log", xlim=(f[0], f[-1]), ylim=(-0.2, 2.2))
    axis.set_xlabel("frequency (Hz)")
    axis.set_ylabel("felt, re no cancellation (1)")
    _plain(axis, y=False)


def _passive(axis: Axes, data: xarray.Dataset) -> None:
    shares = data["passive_share"]
    f = shares["bandwidth"].values
    lines = ("-", "-", "-", ":", "--")
    for name, colour, line in zip(shares["law"].values, COLOURS, lines, strict=True):
        axis.plot(f, shares.sel(law=name).values, line, color=colour, label=str(name))
    _trials(axis, data, "any", "trial_bandwidth")
    axis.set(xscale="log", yscale="log", xlim=(f[0], f[-1]), ylim=(1e-3, 4))
    axis.set_xlabel("bandwidth of the low-pass (Hz)")
    axis.set_ylabel("largest passive share of the inertia (1)")
    _plain(axis)


def _stable(axis: Axes, data: xarray.Dataset) -> None:
    shares = data["stable_share"]
    delay = 1e3 * shares["delay"].values
    for name, colour in zip(shares["known"].values, COLOURS, strict=False):
        axis.plot(delay, shares.sel(known=name).values, color=colour, label=str(name))
        _trials(axis, data, str(name), "trial_delay", colour=colour, factor=1e3, named=False)
    axis.set(xlim=(0, delay[-1]), ylim=(0, 3))
    axis.set_xlabel("delay (ms)")
    axis.set_ylabel("largest share stable with a known hand (1)")


def _trials(
    axis: Axes,
    data: xarray.Dataset,
    hand: str,
    place: str,
    *,
    colour: str = BLACK,
    factor: float = 1.0,
    named: bool = True,
) -> None:
    """Simulated free motion: filled where it decays, open where it grows."""
    chosen = data["rate"][(data["hand"] == hand).values]
    for grows, face in ((False, colour), (True, "w")):
        some = chosen[((chosen > 0) == grows).values]
        label = "simulated: grows" if grows else "simulated: decays"
        style = {"markerfacecolor": face, "markersize": 3.5, "zorder": 3, "color": colour}
        x, y = factor * some[place].values, some["share"].values
        axis.plot(x, y, "o", label=label if named else None, **style)


def _plain(axis: Axes, *, y: bool = True) -> None:
    """Numbers in place of powers of ten."""
    for one in (axis.xaxis, axis.yaxis)[: 1 + y]:
        one.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        one.set_minor_formatter(NullFormatter())
