"""The ladder of a diagnosis as bars."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..diagnose.text import name_of_error
from .style import AFTER, BEFORE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ...diagnose.diagnosis import Diagnosis


def draw_ladder(ax: Axes, diagnosis: Diagnosis, *, of: str) -> None:
    """Check errors of the ladder as bars, with the noise floor.

    of: words for what the errors are relative to
    """
    rungs, floor = diagnosis.rungs, 100 * diagnosis.floor.value
    names = ["your model, re-estimated" if r.added is None else f"+ {r.title}" for r in rungs]
    errors = [100 * r.check_error for r in rungs]
    rows = np.arange(len(names))
    colors = [BEFORE] + [AFTER] * (len(names) - 1)
    ax.barh(rows, errors, height=0.62, color=colors)
    for y, error in zip(rows, errors, strict=True):
        # the label stands clear of the floor's line
        end = max(error, floor) if error > floor - 0.12 * max(errors) else error
        ax.annotate(
            f"{error:.2f} %", (end, y), xytext=(3, 0), textcoords="offset points", va="center"
        )
    ax.axvline(floor, color="k", lw=0.8, ls="--")
    ax.annotate(
        f"noise floor {floor:.2f} %",
        (floor, 1.0),
        xycoords=("data", "axes fraction"),
        xytext=(2, 2),
        textcoords="offset points",
        va="bottom",
    )
    ax.set_yticks(rows, names)
    ax.invert_yaxis()
    ax.set_xlim(0, 1.15 * max(*errors, floor))
    ax.set_xlabel(f"{name_of_error(diagnosis)} (% of {of})")
