"""The figure of a design: force error, friction left in slow motion, T. Nothing is computed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...base.sentences import unit_at_axis
from ...base.units import unit_of
from ..figures.style import CASES, TWO_COLUMNS, house_style
from ..registry import shows

if TYPE_CHECKING:
    import matplotlib.figure
    from matplotlib.axes import Axes

    from ...design import Design


@shows("figure")
def plot_design(design: Design) -> matplotlib.figure.Figure:
    """Three panels that compare the designed cases with no compensation, a line for each case."""
    import matplotlib.pyplot as plt

    with plt.style.context(house_style()):
        figure, axes = plt.subplots(1, 3, figsize=(TWO_COLUMNS, 2.7))
        _force_error(axes[0], design)
        _residual(axes[1], design)
        _transparency(axes[2], design)
        for letter, title, axis in zip(
            "abc",
            ("simulated motion", "slow steady motion", "linear theory, with load"),
            axes,
            strict=True,
        ):
            axis.set_title(f"({letter}) {title}", loc="left", pad=4)
        handles, labels = axes[1].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=4)
    return figure


def _force_error(axis: Axes, design: Design) -> None:
    data = design.prediction.curves.data
    axis.axhline(0.0, color="#BFBFBF", linewidth=0.5, zorder=0)
    axis.axvline(0.0, color="#BFBFBF", linewidth=0.5, zorder=0)
    for case in map(str, data["case"].values):
        colour, line, _ = CASES[case]
        one = data.sel(case=case)
        axis.plot(one["velocity"].values, one["force"].values, color=colour, linestyle=line, lw=0.8)
    force, speed = (unit_at_axis(data[n].attrs["units"]) for n in ("force", "velocity"))
    axis.set_xlabel(f"velocity ({speed})")
    axis.set_ylabel(rf"force error $R_D - R_M$ ({force})")


def _residual(axis: Axes, design: Design) -> None:
    unit = unit_at_axis(unit_of("force", design.body.axis))
    for case, row in design.residual.rows.items():
        colour, line, label = CASES[case]
        axis.semilogx(design.residual.speeds, row, color=colour, linestyle=line, label=label)
    axis.set_ylim(bottom=min(0.0, *(float(r.min()) for r in design.residual.rows.values())))
    axis.set_xlabel(f"speed ({unit_at_axis(unit_of('velocity', design.body.axis))})")
    axis.set_ylabel(f"friction left ({unit})")
    axis.grid(True)


def _transparency(axis: Axes, design: Design) -> None:
    response = design.transparency
    for case, size in zip(response.cases, response.magnitude, strict=True):
        colour, line, _ = CASES[case]
        axis.semilogx(response.frequency, size, color=colour, linestyle=line)
    axis.axhline(1.0, color="#BFBFBF", linewidth=0.5, zorder=0)
    axis.set_ylim(bottom=0.0)
    axis.set_xlim(float(response.frequency[0]), float(response.frequency[-1]))
    axis.set_xlabel("frequency (Hz)")
    axis.set_ylabel(r"$|R_M/R_D|$ (1)")
    axis.grid(True)
