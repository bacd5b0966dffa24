"""Figure of two measures against each other. Nothing is computed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...base.sentences import unit_at_axis
from .design import ONE_COLUMN
from .letters import house_style
from .study_data import words

if TYPE_CHECKING:
    import matplotlib.figure
    import numpy as np

    from ...tuning import ParetoFront

#: evaluated points that are further from the front than this many of its lengths are not drawn
_BESIDE = 1.5
GREY, BEST, BEFORE = "#BFBFBF", "#0072B2", "#D55E00"


def plot_pareto(front: ParetoFront) -> matplotlib.figure.Figure:
    """The front as steps; points that keep the limits in grey; the untuned diagram as a cross."""
    import matplotlib.pyplot as plt
    import numpy as np

    x, y = front.objectives.T
    with plt.style.context(house_style()):
        figure, axes = plt.subplots(figsize=(ONE_COLUMN, 0.8 * ONE_COLUMN), layout="constrained")
        axes.plot(*front.evaluated.T, ".", color=GREY, markersize=2.5, label="keeps the limits")
        axes.step(*front.evaluated_best.T, where="post", color=BEST, label="best found")
        axes.plot(x, y, "o", color=BEST, markersize=4, zorder=3, label="limits checked again")
        if np.isfinite(front.before).all():
            axes.plot(*front.before, "x", color=BEFORE, zorder=4, label="before")
        axes.set_xlim(right=min(axes.get_xlim()[1], _farthest(x)))
        axes.set_ylim(top=min(axes.get_ylim()[1], _farthest(y)))
        first, second = (
            f"{words(name)} ({unit_at_axis(unit or '1')})"
            for name, unit in zip(front.names, front.units, strict=True)
        )
        axes.set_xlabel(first)
        axes.set_ylabel(second)
        axes.legend()
    return figure


def _farthest(values: np.ndarray) -> float:
    """Limit of an axis: the largest value of the front and a margin beyond it."""
    return float(values.max() + _BESIDE * ((values.max() - values.min()) or abs(values.max()) or 1))
