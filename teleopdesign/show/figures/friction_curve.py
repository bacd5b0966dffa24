"""The force-velocity curve of the papers: measured points, and the models as lines."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from ...base.finding import Finding, Graph, Series
from ...base.sentences import unit_on_page
from ...base.units import unit_of
from ...diagnose.covariance import friction_at
from ...measurement.filtering import Array

if TYPE_CHECKING:
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


def curve_graph(prepared: Prepared, models: Mapping[str, Fit]) -> Graph:
    """Force over speed: the points, and each fitted model with a band of two standard errors.

    models: name -> fit
    """
    named = {"fit": "measured", "check": "measured, not fitted"}
    series = [Series(name, *points_of(prepared, use)) for use, name in named.items()]
    sides = speeds_of(prepared)
    for name, fit in models.items():
        over = np.concatenate(sides)
        force, error = friction_at(fit, over)
        line = (over, force, force - BAND * error, force + BAND * error)
        # a gap between both directions, for a line jumps there
        x, y, low, high = (np.insert(values, len(sides[0]), np.nan) for values in line)
        series.append(Series(name, x, y, "model", low, high))
    axis = next(iter(prepared.experiment.bodies.values())).axis
    velocity, force_unit = (unit_on_page(unit_of(q, axis)) for q in ("velocity", "force"))
    shown = tuple(s for s in series if len(s.x))
    return Graph(f"velocity ({velocity})", f"force ({force_unit})", shown)


def curve_finding(diagnosis: Diagnosis) -> Finding:
    """The points and the curve of the final model, as a finding with its graph."""
    graph = curve_graph(diagnosis.prepared, {"model": diagnosis.last_fit})
    words = "the points, and the friction of the final model with two standard errors."
    return Finding("friction curve", "note", words, graph=graph)
