"""The figure of an arm's diagnosis: a row for each joint, and the ladder for the whole arm."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ...diagnose.comparison import residual_data
from ..registry import shows
from .diagnosis import (
    AFTER,
    BEFORE,
    MEASURED,
    check_rows,
    direction_legend,
    draw_by_direction,
    draw_ladder,
    draw_over_time,
    label_of,
)
from .style import house_style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ...diagnose.arms.diagnosis import ArmDiagnosis

#: inches: of a joint's row, of what stands around all rows; of the ladder, and each of its rungs
ROW, AROUND, LADDER, RUNG = 1.4, 0.6, 0.75, 0.22


@shows("figure")
def plot_arm_diagnosis(diagnosis: ArmDiagnosis) -> Figure:
    """For each joint: forces, residual over time and over velocity; below, the ladder of the arm.

    The curves are low-passed forces of the check records (of the fit records if there is no check
    record), from the models in which all joints agree on the links. The panels over time show the
    first of these records.
    """
    import matplotlib.pyplot as plt

    joints, changed = list(diagnosis.joints), len(diagnosis.rungs) > 1
    height, below = ROW * len(joints) + AROUND, LADDER + RUNG * len(diagnosis.rungs)
    with plt.style.context(house_style()):
        figure = plt.figure(figsize=(7.16, height + below), layout="constrained")
        # names of effects are long: they take no room from the joints
        parts: Any = figure.subfigures(2, 1, height_ratios=[height, below])
        upper, lower = parts
        axes = upper.subplots(len(joints), 3, squeeze=False, width_ratios=[1.25, 1.25, 1.0])
        for joint, row in zip(joints, axes, strict=True):
            _joint(list(row), diagnosis, joint, changed=changed)
        for ax in axes[0, :2]:
            ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.1), borderaxespad=0.1, ncols=3)
        direction_legend(axes[0, 2])
        for ax in axes[-1, :2]:
            ax.set_xlabel("time (s)")
        # anybody's text: no formula in it
        upper.suptitle(diagnosis.experiment.title, x=0.01, ha="left", parse_math=False)
        of = "the measured force, root of the mean square over joints"
        draw_ladder(lower.subplots(), diagnosis.rungs, diagnosis.floor, of=of)
    return figure


def _joint(row: list[Any], diagnosis: ArmDiagnosis, joint: str, *, changed: bool) -> None:
    """The three panels of a joint."""
    before, after = (
        check_rows(residual_data(fit.fits[joint].model, fit.prepared[joint]))
        for fit in (diagnosis.before, diagnosis.after)
    )
    force, time, velocity = row
    every, before, after = after, _first_record(before), _first_record(after)
    draw_over_time(force, before, "measured", MEASURED, "measured", 1.4)
    draw_over_time(force, after, "model", AFTER, "model", 0.6)
    unit = label_of(before, "measured").removeprefix("measured ")
    force.set_ylabel(f"{joint}\nforce {unit}")
    draw_over_time(time, before, "residual", BEFORE, "before", 0.6)
    if changed:
        draw_over_time(time, after, "residual", AFTER, "after", 0.6)
    time.set_ylabel(label_of(before, "residual"))
    draw_by_direction(velocity, every, "velocity")
    velocity.set_ylim(time.get_ylim())
    velocity.set_ylabel("")
    velocity.set_xlabel(label_of(every, "velocity"))
    ends = (diagnosis.before, diagnosis.after)[0 if changed else 1 :]
    errors = " to ".join(f"{100 * fit.check_errors[joint]:.2f} %" for fit in ends)
    time.set_title(errors, loc="left", fontsize="small", pad=2)


def _first_record(data: Any) -> Any:
    """The rows of the first record; over time, several records would lie on each other."""
    return data.isel(sample=data["record"].values == data["record"].values[0])
