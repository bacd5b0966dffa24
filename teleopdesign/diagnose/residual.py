"""The residual force of a model along the measured motion, low-passed.

LP is the zero-phase low-pass at the comparison's bandwidth. Offsets of single records are estimated
for the model first, and removed.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from ..blocks import Body
from ..effects import SIGNALS
from ..measurement.filtering import Array
from ..measurement.prepare import Stretch
from ..measurement.shared_links import clear
from ..model import Model
from ..realise.along_motion import residual_along
from ..realise.tangent_columns import Probe
from ..realise.traced import Traced, constant, filter_traced, in_rows
from .record_offsets import apply_record_offsets, offset_groups


def residuals(
    model: Model, stretches: Sequence[Stretch], wrt: Sequence[str | Probe] = ()
) -> list[tuple[Array, Array]]:
    """Low-passed residual force and its tangents (p, rows) on the rows that count, per stretch.

    wrt: full parameter names ("device.coulomb.level"), "device.record_shift", or probes
    """
    return [(r.value, r.tangent) for r, _ in _residual_along(model, stretches, wrt)]


def relative_residuals(
    model: Model,
    stretches: Sequence[Stretch],
    wrt: Sequence[str | Probe] = (),
    forces: Sequence[Array] | None = None,
) -> list[tuple[Array, Array]]:
    """Residuals relative to the force that acts in the model, scaled to the measured force.

    A model whose actuator transmits almost no force leaves almost no residual, nor does a model
    whose friction balances every force. Relative to the force that acts on each body in the model,
    such a model gains nothing. Equal to `residuals` where no effect lies between command and force.
    The link parameters that the joints of an arm share are taken into account
    (`shared_links.clear`).
    forces: per stretch, c forces (c, n) that act besides, each with an unknown factor
    returns: per stretch, residual (rows,) and tangents (p, rows) by `wrt`, as in `residuals`; below
        these the tangents by the factors of the forces
    """
    losing = _bodies_that_lose_force(model)
    parts = _residual_along(model, stretches, wrt, losing, forces)
    scaled = clear(model.links, stretches, [(r.value, r.tangent) for r, _ in parts])
    for place in losing:
        moving = {
            i: signal
            for i, (s, (_, signal)) in enumerate(zip(stretches, parts, strict=True))
            if signal is not None and s.motion.body == place
        }
        if moving:
            whole = sum(stretches[i].measured for i in moving)
            with np.errstate(over="ignore", invalid="ignore"):
                _scale(scaled, moving, [s.weight for s in stretches], whole)
    return scaled


def weighted_residuals(
    model: Model, stretches: Sequence[Stretch], names: Sequence[str | Probe] = ()
) -> tuple[Array, Array]:
    """`relative_residuals` of all stretches (rows,) and derivatives (rows, p), with all weights."""
    parts = relative_residuals(model, stretches, names)
    roots = [np.sqrt(s.weight) for s in stretches]
    residual = np.concatenate([w * r for w, (r, _) in zip(roots, parts, strict=True)])
    slopes = np.concatenate([w * d for w, (_, d) in zip(roots, parts, strict=True)], axis=1)
    return residual, slopes.T


def _scale(
    scaled: list[tuple[Array, Array]],
    moving: Mapping[int, Traced],
    weights: Sequence[float],
    whole: float,
) -> None:
    """Scale the residuals of one body, in place, from its acting to its measured force.

    moving: stretch -> its acting plus interaction force;  whole: squares of the measured force
    A hidden body that grew beyond all numbers leaves NaN, which every search rejects; else a model
    with an infinite acting force would leave nothing.
    """
    acting = sum(weights[i] * float(m.value @ m.value) for i, m in moving.items())
    acting = max(acting, 1e-12 * whole) if np.isfinite(acting) else np.nan
    slope = sum(weights[i] * (m.tangent @ m.value) for i, m in moving.items())
    factor = float(np.sqrt(whole / acting))
    for i in moving:
        r, d = scaled[i]
        scaled[i] = factor * r, factor * (d - np.outer(slope / acting, r))


def _bodies_that_lose_force(model: Model) -> set[str]:
    """Bodies on which an actuator effect, or friction under load, reduces the acting force."""
    return {place for place, body in model.bodies.items() if _takes_from_what_acts(body)}


def _takes_from_what_acts(body: Body) -> bool:
    """Whether an actuator effect, or friction under load, reduces the force on the body."""
    stages = any(e.role == "actuation" for e in body.effects)
    return stages or body.level().has(SIGNALS["acting_force"])


def _residual_along(
    model: Model,
    stretches: Sequence[Stretch],
    wrt: Sequence[str | Probe],
    taking: Collection[str] = (),
    forces: Sequence[Array] | None = None,
) -> list[tuple[Traced, Traced | None]]:
    """Residual per stretch, low-passed on the rows that count, with its tangents (p, rows).

    taking: bodies whose acting plus interaction force is returned too, low-passed likewise; None
        for the others
    forces: as in `relative_residuals`
    """
    located = [_place_of_probe(model, name) for name in wrt]
    groups = offset_groups(model, stretches)
    whole = len(wrt) + (len(forces[0]) if forces else 0)
    signals: list[tuple[Traced, Traced | None]] = []
    each = zip(stretches, apply_record_offsets(model, stretches, groups), strict=True)
    for k, (s, (body, motion)) in enumerate(each):
        places = [i for i, (place, _) in enumerate(located) if place == motion.body]
        along = residual_along(body, motion, [located[i][1] for i in places])
        residual = along.residual
        acting = along.moving + constant(s.motion.interaction, len(places))
        if forces is not None:  # further tangents, by the factors of the forces
            more = forces[k]
            residual = Traced(residual.value, np.vstack([residual.tangent, more]))
            acting = Traced(acting.value, np.vstack([acting.tangent, np.zeros_like(more)]))
            places += range(len(wrt), whole)

        def shown(traced: Traced, s: Stretch = s, places: list[int] = places) -> Traced:
            here = filter_traced(lambda y: s.motion.lowpassed(y, s.keep), traced)
            return in_rows(here.value, here.tangent, places, whole)

        signals.append((shown(residual), shown(acting) if s.motion.body in taking else None))
    for group, offsets in groups:
        bare = [(signals[i][0].value, signals[i][0].tangent) for i in group]
        for i, (left, tangent) in zip(group, offsets.cleared(bare), strict=True):
            signals[i] = (Traced(left, tangent), signals[i][1])
    return signals


def _place_of_probe(model: Model, name: str | Probe) -> tuple[str, str | Probe]:
    return (model.holder(name.at), name) if isinstance(name, Probe) else model.locate(name)
