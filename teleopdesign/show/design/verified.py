"""A second recording against the design: a line, and the force error before and after."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...base.sentences import unit_at_axis
from ...base.units import unit_of
from ..figures.style import CASES, TWO_COLUMNS, plt
from ..registry import shows

if TYPE_CHECKING:
    import matplotlib.figure

    from ...design.verify import Verification

MEASURED = "#A6A6A6"


@shows("text")
def verification_text(verified: Verification) -> str:
    """The measured force error beside the predicted interval, and without compensation."""
    unit = unit_of("force", verified.axis)
    where = "within" if verified.holds else "outside"
    lines = [
        f"force error with {CASES[verified.case][2]}: measured {verified.measured:.3g} {unit} rms, "
        f"{where} the predicted {verified.low:.3g} to {verified.high:.3g} {unit} (95 %)",
        f"without compensation {verified.without:.3g} {unit} are predicted along this motion",
        "assumed: no desired force, the compensation as designed",
    ]
    if not (verified.holds or verified.deviations):
        more = "more" if verified.measured > verified.high else "less"
        lines.append(f"{more} force is left than predicted: no number of the design explains it")
    for group in verified.deviations:
        lines.append("differs: " + "; or ".join(map(str, group)))
    if any(len({one.at for one in group}) > 1 for group in verified.deviations):
        lines.append(
            "to tell these apart: log the command with C in it, or state a recording of the same "
            "day without compensation"
        )
    return "\n".join(lines)


@shows("figure")
def plot_verification(verified: Verification) -> matplotlib.figure.Figure:
    """Force error over velocity, without and with compensation, on one scale."""
    rows, force = verified.rows, unit_at_axis(unit_of("force", verified.axis))
    figure, (left, right) = plt.subplots(1, 2, figsize=(TWO_COLUMNS, 2.6), sharey=True)
    colour = CASES[verified.case][0]
    left.plot(rows["velocity"], rows["without"], color="#000000", lw=0.7, label="model")
    right.plot(rows["velocity"], rows["measured"], color=MEASURED, lw=2.0, label="measured")
    right.plot(rows["velocity"], rows["predicted"], color=colour, lw=0.7, label="predicted")
    for axis, title in ((left, "(a) before"), (right, f"(b) with {CASES[verified.case][2]}")):
        axis.set_title(title, loc="left", pad=4)
        axis.set_xlabel(f"velocity ({unit_at_axis(unit_of('velocity', verified.axis))})")
        axis.grid(True)
        axis.legend(loc="lower right")
    left.set_ylabel(rf"force error $R_D - R_M$ ({force})")
    return figure
