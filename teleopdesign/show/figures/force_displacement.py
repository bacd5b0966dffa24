"""Figures of what a user feels: force over displacement, beside the curve of the environment."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .design import TWO_COLUMNS
from .letters import house_style

if TYPE_CHECKING:
    import matplotlib.figure

    from ...simulate import ForceDisplacement

#: colours (Okabe and Ito) and lines by case, in order
LINES = (("#000000", "-"), ("#0072B2", "-"), ("#D55E00", "-"), ("#009E73", "-"))
ENVIRONMENT = "#BFBFBF"


def plot_force_displacement(result: ForceDisplacement) -> matplotlib.figure.Figure:
    """Displacement of the hand over time, its force over time, and its force over displacement."""
    import matplotlib.pyplot as plt

    data = result.data
    cases = [str(c) for c in data["case"].values]
    time = data["time"].values - data["time"].values[0]
    touched = float(abs(data["environment_force"]).max()) > 0
    with plt.style.context(house_style()):
        figure, (left, middle, right) = plt.subplots(1, 3, figsize=(TWO_COLUMNS, 2.3))
        last = data.sel(case=cases[-1])
        if touched:
            right.plot(
                1e3 * last["environment_displacement"].values,
                last["environment_force"].values,
                color=ENVIRONMENT,
                linewidth=3.0,
                label="environment",
            )
        left.plot(time, 1e3 * last["displacement"].values, color="#000000", label="master")
        slave = 1e3 * last["environment_displacement"].values
        left.plot(time, slave, color="#D55E00", linestyle="--", label="slave")
        for (colour, line), case in zip(LINES, cases, strict=False):
            one = data.sel(case=case)
            style = {"color": colour, "linestyle": line}
            middle.plot(time, one["force"].values, **style)
            shown = 1e3 * one["displacement"].values
            right.plot(shown, one["force"].values, label=case, **style)
        left.set_ylabel("displacement (mm)")
        left.legend(loc="best")
        for axis in (left, middle):
            axis.set_xlabel("time (s)")
        for axis in (middle, right):
            axis.set_ylabel("force of the user (N)")
        right.set_xlabel("displacement (mm)")
        for letter, axis in zip("abc", (left, middle, right), strict=True):
            axis.set_title(f"({letter})", loc="left", pad=3)
            axis.grid(True)
        figure.legend(
            *right.get_legend_handles_labels(),
            loc="outside lower center",
            ncols=len(cases) + touched,
        )
    return figure
