"""Figures of passivity: limits of compensation, regions of two parameters. Computes nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from teleopdesign.show.figures.style import (
    GREY,
    ONE_COLUMN,
    PROVED,
    REFUTED,
    THEORY,
    TWO_COLUMNS,
    house_style,
)

if TYPE_CHECKING:
    import matplotlib.figure
    import numpy as np
    import xarray
    from matplotlib.axes import Axes


def plot_largest_compensation(data: xarray.Dataset) -> matplotlib.figure.Figure:
    """Largest f_D/f_C without growth over u = sigma_D A/f_D: two limits and simulated points."""
    import matplotlib.pyplot as plt
    from matplotlib.ticker import FixedLocator, NullLocator

    u = data["u_curve"].values
    with plt.style.context(house_style()):
        figure, axis = plt.subplots(figsize=(ONE_COLUMN, 2.7))
        low, high = 0.95, 8.0
        axis.fill_between(
            u, low, data["closed_paths"].values, color=PROVED, alpha=0.18, linewidth=0
        )
        axis.plot(
            u,
            data["closed_paths"].values,
            color=PROVED,
            linestyle="--",
            label=r"closed paths within $\pm A$: $1/(1-e^{-2u})^2$, proved",
        )
        axis.plot(
            u, data["cycles"].values, color=THEORY, label=r"cycles: $1/(1-\tanh(u)/u)$, proved"
        )
        axis.plot(
            data["u"].values,
            data["simulated"].values,
            "o",
            color="black",
            markersize=3.2,
            markerfacecolor="white",
            label="onset of growth, simulated",
            zorder=3,
        )
        axis.axhline(1.0, color=GREY, linewidth=0.6)
        axis.set(xscale="log", yscale="log", xlim=(u[0], u[-1]), ylim=(low, high))
        for side, ticks in ((axis.xaxis, (0.5, 1, 2, 5, 10, 20, 40)), (axis.yaxis, (1, 2, 4, 8))):
            side.set_major_locator(FixedLocator(ticks))
            side.set_minor_locator(NullLocator())
            side.set_major_formatter("{x:g}")
        axis.set_xlabel(r"amplitude in bristle lengths, $u=\sigma_D A/f_D$ (1)")
        axis.set_ylabel(r"largest $f_D/f_C$ without growth (1)")
        axis.legend(loc="upper right")
    return figure


def plot_passive_region(data: xarray.Dataset) -> matplotlib.figure.Figure:
    """Map over sigma_D/sigma_p and f_D/f_C: the proved region hatched, with markers of a search."""
    import matplotlib.pyplot as plt
    import numpy as np

    x, y = np.meshgrid(data["softness"].values, data["share"].values)
    proved, has_motion = data["status"].values == "proved", data["found"].values == 1
    size = 5.0 if x.size > 500 else 16.0
    with plt.style.context(house_style()):
        figure, axis = plt.subplots(figsize=(ONE_COLUMN, 3.5))
        edge = np.linspace(0.0, 1.0, 200)
        axis.fill_between(
            edge,
            edge**2,
            1.0,
            facecolor="#EEF8F4",
            edgecolor="#8FCDB8",
            hatch="///",
            linewidth=0.0,
            label="passive: wedge",
        )
        axis.plot(
            [*edge, 0.0], [*edge**2, 1.0], color=THEORY, label="limit", solid_joinstyle="miter"
        )
        for shown, colour, marker, label in (
            (proved & ~has_motion, PROVED, "o", "proved, no motion found"),
            (~proved & has_motion, REFUTED, "x", "refuted, motion found"),
            (~proved & ~has_motion, GREY, "s", "refuted, search missed it"),
            (proved & has_motion, "black", "*", "contradiction"),
        ):
            if shown.any():
                axis.scatter(
                    x[shown],
                    y[shown],
                    s=size,
                    color=colour,
                    marker=marker,
                    linewidths=0.7,
                    label=label,
                )
        axis.set(xlim=(0, float(x.max()) + 0.03), ylim=(0, float(y.max()) + 0.03))
        axis.set_xlabel(r"stiffness of compensator over plant, $\sigma_D/\sigma_p$ (1)")
        axis.set_ylabel(r"level of compensator over plant, $f_D/f_C$ (1)")
        figure.legend(loc="outside lower center", ncols=2)
    return figure


def plot_forward_euler(data: xarray.Dataset) -> matplotlib.figure.Figure:
    """Force over samples for four values of q, exact and by forward Euler; largest force over q."""
    import matplotlib.pyplot as plt

    cases = data["q"].values
    with plt.style.context(house_style()):
        figure = plt.figure(figsize=(TWO_COLUMNS, 4.0))
        grid = figure.add_gridspec(2, len(cases), height_ratios=(1.0, 0.9))
        for k, q in enumerate(cases):
            axis = figure.add_subplot(grid[0, k])
            _one_case(axis, data.sel(q=q), q, "abcd"[k], last=k == len(cases) - 1)
            if k == 0:
                axis.set_ylabel(r"force $f/f_c$ (1)")
        axis = figure.add_subplot(grid[1, :])
        axis.axhspan(0, 1, color=PROVED, alpha=0.15, linewidth=0)
        x = data["q_sweep"].values
        exact = data["largest_exact"].values
        axis.plot(x, exact, color=THEORY, label="exact update", zorder=3)
        beyond = x >= 1
        axis.plot(
            x[beyond],
            data["first_step"].values[beyond],
            color=GREY,
            linestyle="--",
            label=r"first step after a reversal, $2q-1$",
        )
        axis.plot(
            x,
            data["largest_euler"].values,
            ".",
            color=REFUTED,
            markersize=3,
            label="forward Euler, largest of 60 samples",
        )
        for q, text in ((1.0, "bound lost"), (2.0, "diverges")):
            axis.axvline(q, color=GREY, linewidth=0.6, linestyle=":")
            axis.text(q - 0.012, 4.6, text, color=GREY, fontsize=7, ha="right")
        axis.set(xlim=(0, float(x.max())), ylim=(0, 5))
        axis.set_xlabel(r"$q = T\sigma|v|/f_c$ (1)")
        axis.set_ylabel(r"largest $|f|/f_c$ (1)")
        axis.set_title("(e) largest force after a reversal", loc="left", pad=3)
        axis.legend(loc="upper left", bbox_to_anchor=(0.0, 0.98))
    return figure


def _one_case(axis: Axes, one: xarray.Dataset, q: float, letter: str, *, last: bool) -> None:
    axis.axhspan(-1, 1, color=PROVED, alpha=0.15, linewidth=0)
    samples = one["sample"].values if "sample" in one.coords else range(one.sizes["sample"])
    axis.plot(samples, one["exact"].values, color=THEORY, label="exact")
    axis.plot(
        samples,
        one["euler"].values,
        ".-",
        color=REFUTED,
        linewidth=0.6,
        markersize=3,
        label="forward Euler",
    )
    largest = float(abs(one["euler"]).max())
    limit = 1.4 if largest <= 1.001 else 3.4 if largest < 4 else 1.1 * largest
    axis.set_ylim(-limit, limit)
    axis.set_xlabel("sample (1)")
    axis.set_title(f"({letter}) $q = {q:g}$", loc="left", pad=3)
    if last:
        axis.legend(loc="upper left", handlelength=1.2)


def plot_cable_limits(data: xarray.Dataset) -> matplotlib.figure.Figure:
    """Largest f_D/f_1 over sigma_D/k: proved limits, searched points and a map of presliding.

    The left panel has ideal contacts, the right panel has presliding at both contacts.
    """
    import matplotlib.pyplot as plt
    from matplotlib.colors import ListedColormap

    with plt.style.context(house_style()):
        figure, (left, right) = plt.subplots(
            1, 2, sharex=True, sharey=True, figsize=(TWO_COLUMNS, 3.7)
        )
        x = data["stiffness_curve"].values
        _floor(left, x)
        left.plot(x, data["plain"].values, color=THEORY, label="plain cycles, proved (P55)")
        for name, marker, colour, label in (
            ("cycles", "x", REFUTED, "above: a cycle with steps releases energy"),
            ("storage", "o", "black", "below: available storage settles"),
            ("capstan", "^", "#CC79A7", "the same, motor friction + 0.2 tension"),
        ):
            left.plot(
                data["stiffness"].values,
                data[name].values,
                marker,
                color=colour,
                markersize=4,
                markerfacecolor="none",
                label=label,
            )
        left.axhline(data.attrs["together"], color=GREY, linewidth=0.6, linestyle=":")
        left.text(x[-1], data.attrs["together"] + 0.04, "$f_1+f_2$", color=GREY, ha="right")
        left.set_title("(a) ideal contacts", loc="left", pad=3)
        left.set_ylabel(r"level of compensator over motor friction, $f_D/f_1$ (1)")
        out = data["presliding_gives_out"].values
        across, level = data["across"].values, data["level"].values
        right.pcolormesh(
            across, level, out, shading="nearest", cmap=ListedColormap(["white", "#F6D5C0"])
        )
        right.plot([], [], "s", color="#F6D5C0", label="a cycle releases energy")
        right.plot(x, data["plain"].values, color=THEORY, label="plain cycles, ideal contacts")
        right.plot(
            x,
            (x / data.attrs["motor_presliding"]) ** 2,
            color=PROVED,
            linestyle="--",
            label=r"$\sigma_D^2/f_D=\sigma_1^2/f_1$, motor contact alone",
        )
        right.set_title("(b) both contacts presliding", loc="left", pad=3)
        for axis in (left, right):
            axis.set(xscale="log", xlim=(0.93 * x[0], 1.07 * x[-1]), ylim=(0, 3.5))
            axis.set_xlabel(r"stiffness of compensator over cable, $\sigma_D/k$ (1)")
            axis.xaxis.set_major_formatter("{x:g}")
            axis.legend(loc="upper left", bbox_to_anchor=(0.0, -0.2))
    return figure


def _floor(axis: Axes, x: np.ndarray) -> None:
    axis.fill_between(
        x,
        0,
        1,
        facecolor="#EEF8F4",
        edgecolor="#8FCDB8",
        hatch="///",
        linewidth=0.0,
        label="any environment, proved (P53)",
    )


def plot_passive_walls(data: xarray.Dataset) -> matplotlib.figure.Figure:
    """Stiffness of passive walls over period and over damping, with two amounts of cancellation."""
    import matplotlib.pyplot as plt
    from matplotlib.colors import ListedColormap

    k = data["stiffness"].values
    colours = ("#CFE3F1", "#8FCDB8")
    with plt.style.context(house_style()):
        figure, axes = plt.subplots(1, 2, sharey=True, figsize=(TWO_COLUMNS, 3.1))
        for axis, name, limit, label in (
            (axes[0], "over_period", "limit_over_period", "sample period $T$ (s)"),
            (axes[1], "over_damping", "limit_over_damping", "damping $b$ (N s/m)"),
        ):
            x = data[data[limit].dims[-1]].values
            for force, colour in zip(data["cancelled"].values, colours, strict=True):
                status = data[name].sel(cancelled=force).values
                refuted = _mask_all_but(status == "proved")
                axis.pcolormesh(x, k, refuted, shading="nearest", cmap=ListedColormap([colour]))
                axis.plot([], [], "s", color=colour, label=_describe_cancellation(float(force)))
                axis.plot(x, data[limit].sel(cancelled=force).values, color=THEORY)
            axis.plot([], [], color=THEORY, label=r"$\min(2b/T,\ 2(f_C-f_D)/\Delta)$")
            axis.set(xscale="log", yscale="log", xlim=(x[0], x[-1]), ylim=(k[0], k[-1]))
            axis.set_xlabel(label)
        axes[0].set_title(f"(a) $b$ = {data.attrs['fixed_damping']:g} N s/m", loc="left", pad=3)
        axes[1].set_title(f"(b) $T$ = {1e3 * data.attrs['fixed_period']:g} ms", loc="left", pad=3)
        axes[0].set_ylabel("wall stiffness $K$ (N/m)")
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def _mask_all_but(shown: np.ndarray) -> np.ma.MaskedArray[tuple[int, ...], np.dtype[np.float64]]:
    """Ones where `shown` is true, masked elsewhere."""
    import numpy as np

    return np.ma.masked_where(~shown, np.ones(shown.shape))


def _describe_cancellation(force: float) -> str:
    about = f"{force:g} N of friction cancelled" if force else "no compensation"
    return f"proved, {about}"
