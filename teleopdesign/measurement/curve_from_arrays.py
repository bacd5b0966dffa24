"""A friction curve from arrays in memory, in one call."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..base.arguments import check_types
from ..base.errors import ExperimentError
from ..base.toml import Table
from ..base.units import unit_of
from .experiment import Experiment
from .friction_curve import CURVE, bodies_and_channels, curve_record
from .tables import LogColumns


@check_types
def friction_curve(
    velocity: Any,
    force: Any,
    *,
    axis: str,
    check: Sequence[Any] | None = None,
    units: Mapping[str, str] | None = None,
    noise: float | None = None,
    effects: Sequence[str] = ("coulomb", "viscous"),
    title: str = CURVE,
) -> Experiment:
    """A friction curve: points of constant speed and the force that holds it, without time.

    velocity, force: (n,) each, with their signs; several points may have one speed
    axis: "prismatic" (m/s, N) or "revolute" (rad/s, N*m)
    check: (velocity, force) of points that are not fitted; None: every fourth speed is held out in
        turn
    units: {"velocity": "rpm", "force": "mN*m"}; default: SI
    noise: rms of the force, in its unit; None: read from the points
    effects: those of the model: friction of the speed, and "bias"
    raises ExperimentError: arrays of different lengths, an unknown unit, too few points
    """
    where = "friction_curve"
    stated = dict(units or {})
    names = {"velocity": "velocity", "actuator_force": "force"}
    if strangers := set(stated) - set(names.values()):
        raise ExperimentError(f"{where}: units: found {min(strangers)!r}, expected velocity, force")
    channels: dict[str, Any] = {
        channel: {
            "column": channel,
            "unit": stated.get(name, unit_of(name, axis if axis == "revolute" else "prismatic")),
        }
        for channel, name in names.items()
    }
    if noise is not None:
        channels["actuator_force"]["noise"] = noise
    body = {"axis": axis, "effects": {name: {} for name in effects}}
    content = Table({"channels": channels, "model": {"device": body}}, where)
    bodies, read = bodies_and_channels(content)
    records = []
    for use, points in (("fit", (velocity, force)), *([("check", check)] if check else [])):
        values = [np.asarray(x, dtype=float).ravel() for x in points]
        if len(values) != 2 or len(values[0]) != len(values[1]):
            raise ExperimentError(
                f"{where}: {use}: found {' and '.join(str(len(v)) for v in values)} values, "
                "expected as many speeds as forces"
            )
        columns = LogColumns(dict(zip(names, values, strict=True)))
        records.append(curve_record(columns, use, use, read, bodies))
    return Experiment(Path(title), title, bodies, None, read, None, tuple(records), kind=CURVE)
