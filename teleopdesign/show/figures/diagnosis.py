"""Figures of diagnoses, and panels of residuals; they draw results and compute nothing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ...base.sentences import percent_on_page as percent
from ...base.sentences import unit_at_axis
from ...diagnose.comparison import residual_data
from ..diagnose.text import name_of_error
from ..registry import shows
from .carrier import CarryingVariable, carrier_of, with_carrier
from .friction_curve import curve_graph
from .graph import draw_graph
from .style import AFTER, BACKWARD, BEFORE, FORWARD, MEASURED, UNTOLD, plt

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ...diagnose.diagnosis import Diagnosis
    from ...measurement.prepare import Prepared
    from ...model import Model

#: inches: of a joint's row, of what stands around all rows; of the ladder, and each of its rungs
ROW, AROUND, LADDER, RUNG = 1.4, 0.6, 0.75, 0.4
#: most points drawn in a panel; more are not visible and make files large
POINTS = 6000


def check_rows(data: Any) -> Any:
    """Counted samples of the check records (of all records if there is none), of the first body.

    At most about 2 POINTS samples remain.
    """
    first = data["body"].values == data["body"].values[0]
    check = first & (data["use"].values == "check")
    chosen = data.isel(sample=(check if check.any() else first) & data["counts"].values)
    return chosen.isel(sample=slice(None, None, max(1, chosen.sizes["sample"] // POINTS)))


def label_of(data: Any, name: str) -> str:
    """Name and unit of a variable of residual data, for an axis."""
    shown = data[name].attrs
    return f"{shown.get('label', name)} ({unit_at_axis(shown['units'])})"


def draw_by_direction(ax: Axes, data: Any, over: str) -> None:
    """The residual over a variable of the data, a colour for each direction of motion."""
    for way, color, label in (
        (0, UNTOLD, "near rest"),
        (1, FORWARD, "forward"),
        (-1, BACKWARD, "backward"),
    ):
        chosen = data["direction"].values == way
        ax.plot(
            data[over].values[chosen],
            data["residual"].values[chosen],
            ".",
            ms=1.0,
            color=color,
            label=label,
            rasterized=True,
        )
    ax.axhline(0, color="k", lw=0.5)
    ax.locator_params(axis="x", nbins=5)  # two such axes side by side: labels of 0.00025 are long
    ax.set_xlabel(label_of(data, over))
    ax.set_ylabel(label_of(data, "residual"))


def draw_over_time(ax: Axes, data: Any, name: str, color: str, label: str, width: float) -> None:
    """A variable of the data over time; width: line width (points)."""
    # no line joins two segments
    edges = np.flatnonzero(np.diff(data["segment"].values)) + 1
    for i, run in enumerate(np.split(np.arange(data.sizes["sample"]), edges)):
        ax.plot(
            data["time"].values[run],
            data[name].values[run],
            color=color,
            lw=width,
            label=label if i == 0 else None,
        )


def direction_legend(ax: Axes) -> None:
    """A legend of the directions above the panel, so that it covers no points."""
    legend = ax.legend(
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        borderaxespad=0.1,
        ncols=3,
        columnspacing=0.8,
        handletextpad=0.1,
    )
    for handle in legend.get_lines():
        handle.set_markersize(6.0)


def draw_before_and_after(panels: Sequence[Axes], rows: Sequence[Any], over: str) -> None:
    """The residuals before and after over a variable, on one scale that shows all points."""
    for ax, data, word in zip(panels, rows, ("before", "after"), strict=False):
        draw_by_direction(ax, data, over)
        ax.set_ylabel(label_of(data, "residual").replace("residual", f"residual {word}"))
    low, high = zip(*(ax.get_ylim() for ax in panels), strict=True)
    for ax in panels:
        ax.set_ylim(min(low), max(high))


def draw_courses(force: Axes, residual: Axes, models: Mapping[str, Any]) -> None:
    """Measured and modelled force, and the residual, over time: a line for each model.

    models: name -> its data; the first of two is before, the second after
    """
    first = next(iter(models.values()))
    draw_over_time(force, first, "measured", MEASURED, "measured", 1.6)
    colours = (BEFORE, AFTER) if len(models) > 1 else (AFTER,)
    for (name, data), colour in zip(models.items(), colours, strict=True):
        draw_over_time(force, data, "model", colour, name, 0.6)
        draw_over_time(residual, data, "residual", colour, name, 0.7)
    force.set_ylabel(label_of(first, "measured").replace("measured", "force"))
    residual.set_ylabel(label_of(first, "residual"))
    for ax in (force, residual):
        ax.set_xlabel(label_of(first, "time"))
        ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1, ncols=3)


@shows("figure")
def plot_diagnosis(diagnosis: Diagnosis) -> Figure:
    """Forces and residual before and after, residual over velocity and position, the ladder.

    Of an arm: forces, residual over time and over velocity of each joint, and the ladder. The
    curves are low-passed forces of the check records (of the fit records if there is no check
    record).
    """
    if diagnosis.joints:
        return _plot_joints(diagnosis)
    if diagnosis.kind:
        return _plot_friction_curve(diagnosis)
    carrier = carrier_of(diagnosis, next(iter(diagnosis.model.bodies)))
    if carrier.name == "velocity":
        carrier = CarryingVariable("position")  # the velocity has panels of its own
    axis = next(iter(diagnosis.model.bodies.values())).axis
    before, after = (
        with_carrier(check_rows(residual_data(model, diagnosis.prepared)), carrier, axis)
        for model in (diagnosis.before.model, diagnosis.model)
    )
    changed = len(diagnosis.rungs) > 1
    figure, axes = plt.subplot_mosaic(
        [
            ["force", "force"],
            ["time", "time"],
            ["v0", "x0"],
            ["v1", "x1"],
            ["ladder", "ladder"],
        ],
        figsize=(7.16, 8.6),
        height_ratios=[1.1, 1.0, 1.1, 1.1, 0.4 + 0.4 * len(diagnosis.rungs)],
    )
    models = {"before": before, "after": after} if changed else {"your model": before}
    draw_courses(axes["force"], axes["time"], models)
    # anybody's text: no formula in it
    figure.suptitle(diagnosis.experiment.title, x=0.01, ha="left", parse_math=False)
    rows = (before, after)[: 1 + changed]
    for over, names in (("velocity", ("v0", "v1")), ("carrier", ("x0", "x1"))):
        draw_before_and_after([axes[n] for n in names[: len(rows)]], rows, over)
        for name in names[len(rows) :]:
            axes[name].set_axis_off()
    direction_legend(axes["v0"])
    _plot_ladder(axes["ladder"], diagnosis)
    return figure


def _plot_friction_curve(diagnosis: Diagnosis) -> Figure:
    """The points of a friction curve and the models' curves, the residual, and the ladder."""
    rows = [residual_data(r.model, diagnosis.prepared) for r in (diagnosis.before, diagnosis.after)]
    changed = len(diagnosis.rungs) > 1
    models = {"your model": diagnosis.fit(diagnosis.before.model)}
    models |= {"with what was missing": diagnosis.last_fit} if changed else {}
    figure, axes = plt.subplot_mosaic(
        [["curve", "curve"], ["v0", "v1"], ["ladder", "ladder"]],
        figsize=(7.16, 6.4),
        height_ratios=[1.7, 1.0, 0.4 + 0.4 * len(diagnosis.rungs)],
    )
    draw_graph(curve_graph(diagnosis.prepared, models), axes["curve"])
    figure.suptitle(diagnosis.experiment.title, x=0.01, ha="left", parse_math=False)
    panels = axes["v0"], axes["v1"]
    draw_before_and_after(panels, rows, "velocity")
    for points in (line for ax in panels for line in ax.lines):
        points.set_markersize(3.0)
    _plot_ladder(axes["ladder"], diagnosis)
    return figure


def _plot_joints(diagnosis: Diagnosis) -> Figure:
    """A row for each joint of an arm, and the ladder for the whole arm.

    The models are those in which all joints agree on the links. The panels over time show the first
    of the records.
    """
    joints = list(diagnosis.joints)
    ends = [dict(zip(joints, diagnosis.parts(row), strict=True)) for row in (0, -1)]
    height, below = ROW * len(joints) + AROUND, LADDER + RUNG * len(diagnosis.rungs)
    figure = plt.figure(figsize=(7.16, height + below))
    # names of effects are long: they take no room from the joints
    parts: Any = figure.subfigures(2, 1, height_ratios=[height, below])
    upper, lower = parts
    axes = upper.subplots(len(joints), 3, squeeze=False, width_ratios=[1.25, 1.25, 1.0])
    for joint, row in zip(joints, axes, strict=True):
        _plot_joint(list(row), diagnosis, joint, [parts[joint] for parts in ends])
    for ax in axes[1:, :2].flat:
        ax.get_legend().remove()
    for ax in axes[:-1, :2].flat:
        ax.set_xlabel("")
    direction_legend(axes[0, 2])
    # anybody's text: no formula in it
    upper.suptitle(diagnosis.experiment.title, x=0.01, ha="left", parse_math=False)
    of = "the measured force, root of the mean square over joints"
    _plot_ladder(lower.subplots(), diagnosis, of=of)
    return figure


def _plot_joint(
    row: list[Any], diagnosis: Diagnosis, joint: str, ends: list[tuple[Prepared, Model]]
) -> None:
    """The three panels of a joint; ends: its records and model before and after."""
    changed = len(diagnosis.rungs) > 1
    before, after = (check_rows(residual_data(model, prepared)) for prepared, model in ends)
    force, time, velocity = row
    every, before, after = after, _first_record(before), _first_record(after)
    models = {"before": before, "after": after} if changed else {"your model": after}
    draw_courses(force, time, models)
    force.set_ylabel(f"{joint}\n{force.get_ylabel()}")
    draw_by_direction(velocity, every, "velocity")
    velocity.set_ylim(time.get_ylim())
    velocity.set_ylabel("")
    velocity.set_xlabel(label_of(every, "velocity"))
    rows = (diagnosis.before, diagnosis.after)[0 if changed else 1 :]
    errors = " to ".join(f"{100 * r.joints[joint].check_error:.2f} %" for r in rows)
    time.set_title(errors, loc="left", fontsize="small", pad=2)


def _first_record(data: Any) -> Any:
    """The rows of the first record; over time, several records would lie on each other."""
    return data.isel(sample=data["record"].values == data["record"].values[0])


def _plot_ladder(ax: Axes, diagnosis: Diagnosis, *, of: str = "the measured force") -> None:
    """The ladder of a diagnosis;  of: words for what the errors are relative to."""
    rows = [
        ("your model, re-estimated" if r.added is None else r.title, r.check_error, r.fit_error)
        for r in diagnosis.rungs
    ]
    draw_ladder(ax, rows, diagnosis.floor.value)
    ax.set_xlabel(f"{name_of_error(diagnosis)}; rings: fit error (% of {of})")


def draw_ladder(ax: Axes, rows: Sequence[tuple[str, float, float]], floor: float) -> None:
    """Check errors of the ladder as bars, fit errors as rings, the noise floor as a line.

    rows: name, check error and fit error; a part that is no number is not drawn
    """
    sizes = np.nan_to_num([[check, fit] for _, check, fit in rows], posinf=0.0)
    line = floor if np.isfinite(floor) else 0.0
    for y, ((name, error, _), (check, fit)) in enumerate(zip(rows, sizes, strict=True)):
        ax.barh(y, 100 * check, height=0.42, color=AFTER if y else BEFORE)
        ax.plot(100 * fit, y, "o", ms=4.5, mfc="w", mec="k", mew=0.9)
        # on separate paper, for the line of the noise floor may cross it
        look: Any = {"bbox": {"facecolor": "w", "edgecolor": "none", "pad": 0.8}, "zorder": 3.5}
        text = f"+ {name}" if y else name
        ax.text(0, y - 0.29, text, va="bottom", ha="left", parse_math=False, **look)
        right = ax.get_yaxis_transform()
        ax.text(1, y, percent(error), transform=right, ha="right", va="center", weight="bold")
    ax.axvline(100 * line, color="k", lw=0.9, ls="--")
    ax.annotate(
        f"noise floor {percent(floor)}",
        (100 * line, 1.0),
        xycoords=("data", "axes fraction"),
        xytext=(2, 2),
        textcoords="offset points",
        va="bottom",
    )
    ax.set_ylim(len(rows) - 0.55, -0.62)
    # the figures stand to the right of the longest bar
    ax.set_xlim(0, 122 * (max(float(sizes.max()), line) or 1.0))
    ax.set_yticks([])
    ax.spines["left"].set_visible(False)
