"""The force that a model leaves unexplained along the measured motion, low-passed.

LP is the zero-phase low-pass at the comparison's bandwidth. What a record has of its own is found
for the model first, and taken out.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..blocks import Body
from ..effects import SIGNALS
from ..measurement.filtering import Array
from ..model import Model
from ..realise.along_motion import residual_along
from ..realise.traced import Probe
from .prepare import Stretch
from .record_offsets import along_offsets, offset_groups
from .shared_links import clear


def residuals(
    model: Model, stretches: Sequence[Stretch], wrt: Sequence[str | Probe] = ()
) -> list[tuple[Array, Array]]:
    """Low-passed residual force and its tangents (p, rows) on the rows that count, per stretch.

    wrt: full parameter names ("device.coulomb.level"), "device.record_shift", or probes
    """
    return [(r, d) for r, d, _, _ in _with_acting(model, stretches, wrt)]


def relative_residuals(
    model: Model, stretches: Sequence[Stretch], wrt: Sequence[str | Probe] = ()
) -> list[tuple[Array, Array]]:
    """Residuals relative to the force that acts by the model, at the scale of the measured force.

    A model whose actuator passes next to nothing leaves next to no residual force, nor does one
    whose friction takes up whatever acts; relative to what it lets act on each body, nothing is
    gained. Equal to `residuals` where nothing stands between command and force. What the links of
    an arm, which all its joints share, can make of a joint's is taken out (`shared_links.clear`).
    """
    parts = _with_acting(model, stretches, wrt)
    scaled = clear(model.links, stretches, [(r, d) for r, d, _, _ in parts])
    for place, body in model.bodies.items():
        mine = [i for i, s in enumerate(stretches) if s.motion.body == place]
        if not mine or not _takes_from_what_acts(body):
            continue
        whole = sum(stretches[i].measured for i in mine)
        acting = sum(stretches[i].weight * float(parts[i][2] @ parts[i][2]) for i in mine)
        acting = max(acting, 1e-12 * whole)
        slope = sum(
            (stretches[i].weight * (parts[i][3] @ parts[i][2]) for i in mine), np.zeros(len(wrt))
        )
        factor = float(np.sqrt(whole / acting))
        for i in mine:
            r, d = scaled[i]
            scaled[i] = factor * r, factor * (d - np.outer(slope / acting, r))
    return scaled


def _takes_from_what_acts(body: Body) -> bool:
    """Whether an actuator's stage, or friction under load, stands before what moves the body."""
    stages = any(e.role == "actuation" for e in body.effects)
    return stages or body.level().has(SIGNALS["acting_force"])


def _with_acting(
    model: Model, stretches: Sequence[Stretch], wrt: Sequence[str | Probe]
) -> list[tuple[Array, Array, Array, Array]]:
    """Residual and acting plus interaction force, low-passed, on the rows that count; tangents."""
    signals_of_stretches = []
    groups = offset_groups(model, stretches)
    for stretch, (body, there) in zip(
        stretches, along_offsets(model, stretches, groups), strict=True
    ):
        motion, rows = stretch.motion, stretch.keep
        located = [_located(model, name) for name in wrt]
        mine = [i for i, (place, _) in enumerate(located) if place == motion.body]
        parameters = [located[i][1] for i in mine]
        along = residual_along(body, there, parameters)
        signals = []
        for traced, offset in ((along.residual, 0.0), (along.moving, motion.interaction)):
            value = motion.lowpassed(traced.value + offset)[rows]
            tangent = np.zeros((len(wrt), len(rows)))
            moving = traced.tangent.any(axis=1)
            if moving.any():
                tangent[np.array(mine)[moving]] = motion.lowpassed(traced.tangent[moving])[:, rows]
            signals += [value, tangent]
        signals_of_stretches.append((signals[0], signals[1], signals[2], signals[3]))
    for group, offsets in groups:
        cleared = offsets.cleared([signals_of_stretches[i][:2] for i in group])
        for i, (residual, tangent) in zip(group, cleared, strict=True):
            signals_of_stretches[i] = (residual, tangent, *signals_of_stretches[i][2:])
    return signals_of_stretches


def _located(model: Model, name: str | Probe) -> tuple[str, str | Probe]:
    return (model.holder(name.at), name) if isinstance(name, Probe) else model.locate(name)
