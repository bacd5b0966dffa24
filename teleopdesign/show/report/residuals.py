"""The residual of the model, step by step, over position, velocity and time of each body.

From the low-passed residuals of the check records (of the fit records without a check record), at
the samples that count in the force error. Units are SI; residual > 0: more force acts than the
model needs.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from ...base.finding import Array, Graph
from ...base.sentences import round_up
from ...diagnose import Diagnosis
from ...diagnose.comparison import residual_data
from ...diagnose.evidence import SAME
from ..figures.carrier import carrier_of
from .motion import BodySamples, Scaled, choose_prefix, excerpt, plot_over_carrier, size_of

#: cells of a map along the travel and along velocity, and fewest samples in a cell that is shown
CELLS, FEWEST = (40, 25), 3
_COLUMNS = ("time", "position", "velocity", "command", "measured")
#: intervals of a trace over time, each with its lowest and highest residual
BUCKETS = 220
#: least end of the colour scale, in rms of sensor noise, so that noise alone stays pale
OUTSIDE = 4.0


@dataclass(frozen=True)
class RungResidual:
    """One rung on one body: rms residual, its mean in cells of position and velocity, its trace.

    mean: (velocity cells, position cells), NaN in cells with too few samples
    low, high: (buckets,) of the residual over `BodyView.time`
    """

    name: str
    check_error: float
    rms: float
    mean: Array
    low: Array
    high: Array


@dataclass(frozen=True)
class BodyView:
    """The residual of one body on every rung that changed it, on one scale.

    position, velocity: edges of the cells;  limit: mean residual at the ends of the colour scale
    carrier: the variable that carries the effect, in words, of `over_carrier`
    noise: rms residual from sensor noise alone, of all bodies together
    time: s along the records shown, without gaps;  joints: times at which a new stretch begins
    """

    body: str
    position_scale: Scaled
    velocity_scale: Scaled
    force_scale: Scaled
    position: Array
    velocity: Array
    time: Array
    joints: tuple[float, ...]
    noise: float
    limit: float
    steps: tuple[RungResidual, ...]
    excerpt: Graph
    over_carrier: Graph
    carrier: str = "velocity"


def body_views(diagnosis: Diagnosis, names: tuple[str, ...]) -> tuple[BodyView, ...]:
    """The residual on every rung, for each body in the records shown.

    names: of the rungs
    """
    prepared = diagnosis.prepared
    shown = replace(prepared, stretches=prepared.of("check") or prepared.of("fit"))
    data = [residual_data(r.model, shown) for r in diagnosis.rungs]
    views = []
    for body in diagnosis.experiment.bodies:
        rows = _rows(data, body)
        rungs = _list_changed_rungs(rows.residual)
        errors = [diagnosis.rungs[i].check_error for i in rungs]
        steps = [(names[i], error) for i, error in zip(rungs, errors, strict=True)]
        views.append(_view(body, diagnosis, steps, rows.select_rungs(rungs)))
    return tuple(views)


def _list_changed_rungs(residual: tuple[Array, ...]) -> list[int]:
    """The first rung, and rungs that changed the residual of this body by more than rounding."""
    scale = float(np.sqrt(np.mean(residual[0] ** 2)))
    moved = [float(np.sqrt(np.mean((b - a) ** 2))) for a, b in pairwise(residual)]
    return [0, *(i for i, size in enumerate(moved, 1) if size > SAME * scale)]


def _rows(data: list[Any], body: str) -> BodySamples:
    chosen = (data[0]["body"].values == body) & data[0]["counts"].values
    one = {n: data[0][n].values[chosen] for n in _COLUMNS}
    stretch = np.unique(data[0]["segment"].values[chosen], return_inverse=True)[1]
    step = np.diff(one["time"], prepend=one["time"][:1])
    step[np.flatnonzero(np.diff(stretch, prepend=stretch[:1]))] = 0.0
    return BodySamples(
        time=np.cumsum(step),
        clock=one["time"],
        stretch=stretch,
        position=one["position"],
        velocity=one["velocity"],
        command=one["command"],
        direction=data[0]["direction"].values[chosen],
        measured=one["measured"],
        residual=tuple(d["residual"].values[chosen] for d in data),
    )


def _view(
    body: str, diagnosis: Diagnosis, names: list[tuple[str, float]], rows: BodySamples
) -> BodyView:
    axis = diagnosis.experiment.axis(body)
    position, velocity = _edges(rows.position, CELLS[0]), _edges(rows.velocity, CELLS[1])
    means = [_mean(rows, r, position, velocity) for r in rows.residual]
    known = [np.abs(m[np.isfinite(m)]) for m in means]
    largest = [float(np.quantile(m, 0.98)) for m in known if m.size]
    noise = _noise(diagnosis)
    limit = round_up(max([*largest, OUTSIDE * noise]), digits=1) or 1.0
    buckets = np.array_split(np.arange(len(rows.time)), min(BUCKETS, len(rows.time)))
    force = choose_prefix("force", axis, size_of(rows.residual[0]))
    carrier = carrier_of(diagnosis, body)
    steps = tuple(
        RungResidual(
            name=name,
            check_error=error,
            rms=float(np.sqrt(np.mean(r**2))),
            mean=mean,
            low=np.array([r[b].min() for b in buckets]),
            high=np.array([r[b].max() for b in buckets]),
        )
        for (name, error), r, mean in zip(names, rows.residual, means, strict=True)
    )
    joints = np.flatnonzero(np.diff(rows.stretch)) + 1
    return BodyView(
        body=body,
        position_scale=choose_prefix("position", axis, size_of(rows.position)),
        velocity_scale=choose_prefix("velocity", axis, size_of(rows.velocity)),
        force_scale=force,
        position=position,
        velocity=velocity,
        time=np.array([float(rows.time[b].mean()) for b in buckets]),
        joints=tuple(float(t) for t in rows.time[joints]),
        noise=noise,
        limit=limit,
        steps=steps,
        excerpt=excerpt(rows, axis, diagnosis.bandwidth),
        over_carrier=plot_over_carrier(rows, axis, force, carrier),
        carrier=carrier.words,
    )


def _noise(diagnosis: Diagnosis) -> float:
    """The noise floor as a force: the floor is relative to the rms of the measured force."""
    shown = diagnosis.prepared.of("check") or diagnosis.prepared.of("fit")
    rows = sum(s.weight * len(s.keep) for s in shown)
    return diagnosis.floor.value * float(np.sqrt(sum(s.measured for s in shown) / rows))


def _edges(values: Array, cells: int) -> Array:
    low, high = float(values.min()), float(values.max())
    middle, half = 0.5 * (low + high), 0.5 * (high - low) or 1e-9
    return np.linspace(middle - half, middle + half, cells + 1)


def _mean(rows: BodySamples, residual: Array, position: Array, velocity: Array) -> Array:
    edges = [velocity, position]
    count, *_ = np.histogram2d(rows.velocity, rows.position, bins=edges)
    total, *_ = np.histogram2d(rows.velocity, rows.position, bins=edges, weights=residual)
    return np.where(count >= FEWEST, total / np.maximum(count, 1), np.nan)
