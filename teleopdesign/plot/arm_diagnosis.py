"""The figure of an arm's diagnosis: a row for each joint, and the ladder of the whole arm."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..diagnose.comparison import residual_data
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
from .letters import house_style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..diagnose.arms.diagnosis import ArmDiagnosis

PANELS = ("force", "time", "velocity")
#: inches: of a joint's row, of what stands around all rows, of a rung of the ladder
ROW, AROUND, RUNG = 1.45, 1.1, 0.22


def plot_arm_diagnosis(diagnosis: ArmDiagnosis) -> Figure:
    """Of each joint forces, residual over time and over velocity; below, the ladder of the arm.

    Drawn from the check records' low-passed forces (fit records where there is no check record),
    by the models in which all joints agree on the links.
    """
    import matplotlib.pyplot as plt

    joints, changed = list(diagnosis.joints), len(diagnosis.rungs) > 1
    below = 0.35 + RUNG * len(diagnosis.rungs)
    with plt.style.context(house_style()):
        figure, axes = plt.subplot_mosaic(
            [[f"{j} {what}" for what in PANELS] for j in joints] + [["ladder"] * 3],
            figsize=(7.16, ROW * len(joints) + AROUND + below),
            height_ratios=[ROW] * len(joints) + [below],
            width_ratios=[1.25, 1.25, 1.0],
        )
        for joint in joints:
            row = [axes[f"{joint} {what}"] for what in PANELS]
            _joint(row, diagnosis, joint, changed=changed)
        first, last = joints[0], joints[-1]
        for what in ("force", "time"):
            axes[f"{first} {what}"].legend(
                loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1, ncols=3
            )
        direction_legend(axes[f"{first} velocity"])
        axes[f"{last} force"].set_xlabel("time (s)")
        axes[f"{last} time"].set_xlabel("time (s)")
        # anybody's text: no formula in it
        figure.suptitle(diagnosis.experiment.title, x=0.01, ha="left", parse_math=False)
        of = "the measured force, root of the mean square over joints"
        draw_ladder(axes["ladder"], diagnosis.rungs, diagnosis.floor, of=of)
    return figure


def _joint(row: list[Any], diagnosis: ArmDiagnosis, joint: str, *, changed: bool) -> None:
    """The three panels of a joint."""
    before, after = (
        check_rows(residual_data(fit.fits[joint].model, fit.prepared[joint]))
        for fit in (diagnosis.before, diagnosis.after)
    )
    force, time, velocity = row
    draw_over_time(force, before, "measured", MEASURED, "measured", 1.4)
    draw_over_time(force, after, "model", AFTER, "model", 0.6)
    unit = label_of(before, "measured").removeprefix("measured ")
    force.set_ylabel(f"{joint}\nforce {unit}")
    draw_over_time(time, before, "residual", BEFORE, "before", 0.6)
    if changed:
        draw_over_time(time, after, "residual", AFTER, "after", 0.6)
    time.set_ylabel(label_of(before, "residual"))
    draw_by_direction(velocity, after, "velocity")
    velocity.set_ylim(time.get_ylim())
    velocity.set_ylabel("")
    velocity.set_xlabel(label_of(after, "velocity"))
    ends = (diagnosis.before, diagnosis.after)[0 if changed else 1 :]
    errors = " to ".join(f"{100 * fit.check_errors[joint]:.2f} %" for fit in ends)
    time.set_title(errors, loc="left", fontsize="small", pad=2)
