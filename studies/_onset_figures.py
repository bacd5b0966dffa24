"""Maps that show where an oscillation of a teleoperator starts to grow. Nothing is computed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teleopdesign.show.figures.style import (
    GREY,
    PROVED,
    REFUTED,
    THEORY,
    TWO_COLUMNS,
    hatch_region,
    house_style,
)

if TYPE_CHECKING:
    import matplotlib.figure
    import numpy as np
    import xarray
    from matplotlib.axes import Axes

GROWS = "#F6D5C0"


def plot_teleoperator_onset(data: xarray.Dataset) -> matplotlib.figure.Figure:
    """Simulated growth over damping and over contact stiffness, f_D/f_C upward, with two limits."""
    import matplotlib.pyplot as plt

    y = data["share"].values
    with plt.style.context(house_style()):
        figure, axes = plt.subplots(1, 2, sharey=True, figsize=(TWO_COLUMNS, 3.3))
        for axis, name, label, title in (
            (
                axes[0],
                "damping",
                "damping of the coupling, $D$ (N s/m)",
                f"(a) $k_e/P$ = {data.attrs['fixed_contact']:g}",
            ),
            (
                axes[1],
                "contact",
                "stiffness of environment over coupling, $k_e/P$ (1)",
                f"(b) $D$ = {data.attrs['fixed_damping']:g} N s/m",
            ),
        ):
            x = data[name].values
            _mark_growth(
                axis, x, y, data[f"growth_over_{name}"].values > 0, "simulated swing grows"
            )
            hatch_region(axis, x, y[0], 1.0, r"passive, proved: $f_D\leq f_C$")
            axis.axhline(
                data.attrs["cycles"],
                color=GREY,
                linestyle="--",
                label=r"cycles without damping: $1/(1-\tanh(u)/u)$ (P40)",
            )
            axis.plot(
                x, data[f"balance_over_{name}"].values, color=THEORY, label="with the dampers' loss"
            )
            axis.plot(
                x,
                data[f"onset_over_{name}"].values,
                "o",
                color="black",
                markersize=2.6,
                markerfacecolor="white",
                label="onset, simulated",
                zorder=3,
            )
            axis.set(xscale="log", xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))
            axis.xaxis.set_major_formatter("{x:g}")
            axis.set_xlabel(label)
            axis.set_title(title, loc="left", pad=3)
        axes[0].set_ylabel(r"cancelled over true friction, $f_D/f_C$ (1)")
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def _mark_growth(axis: Axes, x: np.ndarray, y: np.ndarray, grown: np.ndarray, label: str) -> None:
    import numpy as np
    from matplotlib.colors import ListedColormap

    shown = np.ma.masked_where(~grown, np.ones(grown.shape))
    axis.pcolormesh(x, y, shown, shading="nearest", cmap=ListedColormap([GROWS]))
    axis.plot([], [], "s", color=GROWS, label=label)


def _mark_onsets(axis: Axes, x: np.ndarray, onsets: xarray.DataArray) -> None:
    """Stiffnesses (N/m) above which a simulated swing grows, a marker for each kind of ends."""
    for ends, marker in zip(onsets["ends"].values, "^o", strict=True):
        axis.plot(
            x,
            onsets.sel(ends=ends).values,
            marker,
            color="black",
            markersize=4,
            markerfacecolor="white",
            zorder=3,
            label=f"onset of growth, simulated, {ends}",
        )


def _set_decades(axis: Axes, x: np.ndarray, stiffness: np.ndarray) -> None:
    """Logarithmic axes with limits around the points of a map."""
    axis.set(xscale="log", yscale="log", xlim=(0.9 * x[0], 1.1 * x[-1]))
    axis.set_ylim(0.8 * stiffness[0], 1.25 * stiffness[-1])


def plot_delay_and_stiffness(data: xarray.Dataset) -> matplotlib.figure.Figure:
    """Claims on couplings over delay and over sample period, and onsets of growth in simulation."""
    import matplotlib.pyplot as plt

    stiffness = data["stiffness"].values
    with plt.style.context(house_style()):
        figure, axes = plt.subplots(1, 2, sharey=True, figsize=(TWO_COLUMNS, 3.5))
        for axis, name, label, title in (
            (axes[0], "delay", "delay each way, $T_d$ (s)", r"(a) $b_mb_s\geq(PT_d)^2$"),
            (axes[1], "period", "sample period, $T$ (s)", r"(b) $b_mb_s/(b_m+b_s)\geq PT/2$"),
        ):
            x, limit = data[name].values, data[f"limit_over_{name}"].values
            hatch_region(axis, x, 0.8 * stiffness[0], limit, "the condition holds")
            axis.plot(x, limit, color=THEORY, label="limit of the theorem")
            _mark_status(axis, x, stiffness, data[f"status_over_{name}"].values)
            _mark_onsets(axis, data[f"{name}_simulated"].values, data[f"onset_over_{name}"])
            _set_decades(axis, x, stiffness)
            axis.set_xlabel(label)
            axis.set_title(title, loc="left", pad=3)
        axes[0].set_ylabel("stiffness of the coupling, $P$ (N/m)")
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def plot_period_and_stiffness(data: xarray.Dataset) -> matplotlib.figure.Figure:
    """Claims on late compensators over sample period and stiffness, and onsets of growth."""
    import matplotlib.pyplot as plt

    x, stiffness = data["period"].values, data["stiffness"].values
    with plt.style.context(house_style()):
        figure, axes = plt.subplots(1, 2, sharey=True, figsize=(TWO_COLUMNS, 3.5))
        for axis, letter, late in zip(axes, "ab", data["late"].values, strict=True):
            here = data.sel(late=late)
            limit = here["limit"].values
            hatch_region(axis, x, 0.8 * stiffness[0], limit, "both conditions hold")
            axis.plot(x, limit, color=THEORY, label="limit of the two conditions")
            _mark_status(axis, x, stiffness, here["status"].values)
            _mark_onsets(axis, data["period_simulated"].values, here["onset"])
            _set_decades(axis, x, stiffness)
            axis.set_xlabel("sample period, $T$ (s)")
            samples = f"{late} sample{'s' if late > 1 else ''} late"
            axis.set_title(f"({letter}) {samples}", loc="left", pad=3)
        axes[0].set_ylabel(r"stiffness of the compensator, $\sigma_D$ (N/m)")
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def _mark_status(axis: Axes, x: np.ndarray, y: np.ndarray, status: np.ndarray) -> None:
    """A marker at each point, by the status of the claim there."""
    import numpy as np

    across, up = np.meshgrid(x, y)
    size = 6 if len(x) < 30 else 1.5
    for kind, colour, marker, label in (
        ("proved", PROVED, "o", "claim proved"),
        ("refuted", REFUTED, "x", "claim refuted by a wave"),
        ("unknown", GREY, "s", "claim unknown"),
    ):
        shown = status == kind
        if shown.any():
            axis.scatter(
                across[shown],
                up[shown],
                s=size,
                color=colour,
                marker=marker,
                linewidths=0.6,
                label=label,
            )
