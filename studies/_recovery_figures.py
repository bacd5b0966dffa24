"""Figures of a recovery campaign: which effect is taken for which, and what probabilities mean."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import matplotlib.pyplot as plt
import numpy as np
from _recovery_tables import Row
from _scoring import SINGLE, Calibration
from matplotlib.figure import Figure

from teleopdesign import EFFECTS

#: columns of the confusion figure beside the effects
OTHER = ("other place", "look-alikes", "undecided", "adequate", "no answer")
STYLE = "teleopdesign.show.figures.teleopdesign"
COLOURS = {"best candidate": "#0072B2", "all candidates": "#D55E00"}


def column_of(row: Row) -> str:
    """Column of the confusion figure: what was named first, or what was said instead."""
    if row.outcome in ("other place", "no answer"):
        return row.outcome
    if row.outcome in ("look-alike", "wide group"):
        return "look-alikes"
    if row.named:
        return row.named.partition("@")[0]
    return "adequate" if row.verdict == "model_adequate" else "undecided"


def hidden(row: Row) -> str:
    """Line of the confusion figure: the true effect, or "nothing"."""
    return row.true.partition("@")[0] or "nothing"


def _label(name: str) -> str:
    return name.replace("_", " ")


def plot_confusion(rows: Sequence[Row]) -> Figure:
    """True effect against what was said: number of cases, shaded by its share of the line."""
    rows = [r for r in rows if r.level in (*SINGLE, "null", "outside")]
    order = [*sorted(EFFECTS), "nothing"]
    effects = {hidden(r) for r in rows}
    lines = [n for n in order if n in effects] + sorted(effects - set(order))
    columns = [n for n in lines if n in EFFECTS]
    columns += sorted({column_of(r) for r in rows} - set(columns) - set(OTHER))
    columns += [n for n in OTHER if any(column_of(r) == n for r in rows)]
    count = np.zeros((len(lines), len(columns)), dtype=int)
    for r in rows:
        count[lines.index(hidden(r)), columns.index(column_of(r))] += 1
    return _draw_confusion(count, lines, columns)


def _draw_confusion(count: np.ndarray, lines: list[str], columns: list[str]) -> Figure:
    part = count / np.maximum(count.sum(axis=1, keepdims=True), 1)
    # the size follows the number of lines, so that a quick run's figure can be read too
    size = 1.9 + 0.17 * max(len(columns), 10), 1.5 + 0.15 * max(len(lines), 6)
    with plt.style.context(STYLE):
        figure, axes = plt.subplots(figsize=size)
        axes.imshow(part, cmap="Blues", vmin=0, vmax=1.4, aspect="auto")
        for i, j in zip(*np.nonzero(count), strict=True):
            axes.text(j, i, str(count[i, j]), ha="center", va="center", fontsize=6)
        names = [f"{_label(n)} ({k})" for n, k in zip(lines, count.sum(axis=1), strict=True)]
        axes.set_yticks(range(len(lines)), names, fontsize=6)
        axes.set_xticks(range(len(columns)), map(_label, columns), rotation=90, fontsize=6)
        axes.set(xlabel="named first, or said instead", ylabel="hidden (number of cases)")
        axes.tick_params(length=0)
    return figure


def plot_calibration(calibrations: Mapping[str, Calibration]) -> Figure:
    """Share that was true against the stated probability, with 95 % intervals."""
    with plt.style.context(STYLE):
        figure, axes = plt.subplots(figsize=(3.5, 3.0))
        axes.plot([0, 1], [0, 1], color="0.7", lw=0.8)
        # set a little apart, so that one interval does not hide the other
        for shift, (name, one) in zip((-0.006, 0.006), calibrations.items(), strict=True):
            value = np.array([s.value for s in one.true])
            bounds = np.array([s.interval for s in one.true]).reshape(-1, 2)
            axes.errorbar(
                one.stated + shift,
                value,
                yerr=np.abs(bounds.T - value),
                fmt="o",
                ms=3,
                lw=0.8,
                color=COLOURS[name],
                label=f"{name}: error {one.error:.3f}",
            )
        axes.set(xlabel="stated probability", ylabel="share of true names")
        axes.set(xlim=(-0.02, 1.02), ylim=(-0.02, 1.02))
        axes.legend(loc="lower right")
    return figure
