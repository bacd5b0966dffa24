"""Velocity over time, and normalised force against velocity: one line for each case."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from teleopdesign.base.sentences import unit_at_axis
from teleopdesign.show.figures.style import ONE_COLUMN, house_style

if TYPE_CHECKING:
    import matplotlib.figure

    from teleopdesign.simulate import ForceVelocity

_LINES = (("#0072B2", "-"), ("#D55E00", (0, (5, 1.6))), ("#000000", (0, (4, 1.4, 1, 1.4))))


def plot_normalised_force(
    curves: ForceVelocity, *, level: Mapping[str, float]
) -> matplotlib.figure.Figure:
    """Velocity over time, and normalised force against velocity.

    level: case -> the force by which the forces of the case are divided
    """
    import matplotlib.pyplot as plt

    data = curves.data
    cases = [str(c) for c in data["case"].values]
    speed = unit_at_axis(data["velocity"].attrs["units"])
    with plt.style.context(house_style()):
        figure, (upper, lower) = plt.subplots(
            2, 1, figsize=(ONE_COLUMN, 4.2), height_ratios=(1.0, 2.0)
        )
        time = data["time"].values
        upper.plot(time - time[0], data["velocity"].sel(case=cases[0]).values, color="#000000")
        upper.axhline(0.0, color="#BFBFBF", linewidth=0.5, zorder=0)
        upper.set_xlim(0.0, float(time[-1] - time[0]))
        upper.set_xlabel("time (s)")
        upper.set_ylabel(f"velocity ({speed})")
        for one in (-1.0, 1.0):
            lower.axhline(one, color="#BFBFBF", linewidth=0.5, zorder=0)
        lower.axvline(0.0, color="#BFBFBF", linewidth=0.5, zorder=0)
        for case, (colour, line) in zip(cases, _LINES, strict=False):
            one_case = data.sel(case=case)
            lower.plot(
                one_case["velocity"].values,
                one_case["force"].values / level[case],
                color=colour,
                linestyle=line,
                label=case,
            )
        lower.set_xlabel(f"velocity ({speed})")
        lower.set_ylabel("force / Coulomb level (1)")
        lower.legend(loc="lower right")
        for letter, axis in zip("ab", (upper, lower), strict=True):
            axis.set_title(f"({letter})", loc="left", pad=3)
    return figure
