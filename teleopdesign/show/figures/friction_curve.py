"""The force-velocity curve of the papers: measured points, and the models as lines."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from ...base.finding import Finding, Graph, Series
from ...base.sentences import unit_at_axis
from ...base.units import unit_of
from ...diagnose.covariance import friction_at
from ...measurement.filtering import Array
from .style import MEASURED

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ...diagnose.diagnosis import Diagnosis
    from ...diagnose.fit import Fit
    from ...measurement.prepare import Prepared

#: points of a line in one direction
POINTS = 300
#: standard errors on both sides of a line
BAND = 2.0


def speeds_of(prepared: Prepared) -> list[Array]:
    """Speeds for the lines of models in each direction of the points; dense near rest."""
    velocity = np.concatenate([s.motion.velocity for s in prepared.stretches])
    sides = [np.abs(velocity[np.sign(velocity) == way]) for way in (-1.0, 1.0)]
    return [
        way * np.linspace(np.sqrt(here.min()), np.sqrt(here.max()), POINTS) ** 2
        for way, here in zip((-1.0, 1.0), sides, strict=True)
        if len(here)
    ]


def points_of(prepared: Prepared, use: str) -> tuple[Array, Array]:
    """Speed and force (n,) of the points of one use."""
    motions = [s.motion for s in prepared.of(use)]
    if not motions:
        return np.zeros(0), np.zeros(0)
    return (
        np.concatenate([m.velocity for m in motions]),
        np.concatenate([m.command for m in motions]),
    )


def labels_of(prepared: Prepared) -> tuple[str, str]:
    """Labels of the axes, with their units."""
    axis = next(iter(prepared.experiment.bodies.values())).axis
    velocity, force = (unit_at_axis(unit_of(q, axis)) for q in ("velocity", "force"))
    return f"velocity ({velocity})", f"force ({force})"


def curve_finding(diagnosis: Diagnosis) -> Finding:
    """The points and the curve of the final model, as a finding with its graph."""
    prepared = diagnosis.prepared
    series = [Series("measured", *points_of(prepared, use)) for use in ("fit", "check")]
    for over in speeds_of(prepared):
        force, error = friction_at(diagnosis.last_fit, over)
        band = force - BAND * error, force + BAND * error
        series.append(Series("model", over, force, "model", *band))
    graph = Graph(*labels_of(prepared), tuple(s for s in series if len(s.x)))
    words = "the points, and the friction of the final model with two standard errors."
    return Finding("friction curve", "note", words, graph=graph)


def draw_friction_curve(
    ax: Axes, prepared: Prepared, curves: Mapping[str, tuple[Fit, str]]
) -> None:
    """Force over speed: points grey, each model as a line with its band of two standard errors.

    curves: name -> fitted model and its colour
    """
    for use, marker, label in (("fit", "o", "measured"), ("check", "x", "measured, not fitted")):
        velocity, force = points_of(prepared, use)
        if len(velocity):
            ax.plot(velocity, force, marker, ms=3.0, color=MEASURED, label=label)
    for number, over in enumerate(speeds_of(prepared)):
        for name, (fit, color) in curves.items():
            force, error = friction_at(fit, over)
            ax.plot(over, force, color=color, lw=1.0, label=name if number == 0 else None)
            band = force - BAND * error, force + BAND * error
            ax.fill_between(over, *band, color=color, alpha=0.2, lw=0)
    ax.axhline(0, color="k", lw=0.5)
    x_label, y_label = labels_of(prepared)
    ax.set(xlabel=x_label, ylabel=y_label)
    ax.legend(loc="lower right")
