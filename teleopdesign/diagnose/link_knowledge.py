"""What the records of one joint tell about the base parameters of an arm's links, for the others.

Each joint's information holds when its other parameters are free. Its observations count relative
to its measured force. If they counted by what its model leaves, the joint that lacks an effect
could fit the links to the effect, and only other joints would show an error.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from functools import reduce
from operator import add

import numpy as np

from ..measurement.filtering import Array
from ..measurement.prepare import Prepared, Stretch
from ..measurement.shared_links import Knowledge, share, weighted_columns
from ..model import Model
from ..realise.along_motion import residual_along
from ..realise.tangent_columns import LinkParameter
from .fit import block_numbers, standard_errors
from .least_squares import span
from .parts import PreparedParts, remove_links
from .record_offsets import apply_record_offsets
from .record_shift import record_shifts
from .residual import weighted_residuals
from .solve import BLOCK, free_parameters


def joint_knowledge(
    models: Mapping[str, Model], records: Mapping[str, Prepared], prepared: PreparedParts
) -> dict[str, Knowledge]:
    """Joint -> its information on the base parameters; models, records: of each joint."""
    sizes = prepared.size
    return {j: _knowledge(models[j], p.of("fit"), sizes[j]) for j, p in records.items()}


def common_links(known: Collection[Knowledge]) -> tuple[float, ...]:
    """The base parameters (b,) by the information of all joints."""
    return tuple(float(x) for x in reduce(add, known).best())


def with_others(
    prepared: Prepared, known: Mapping[str, Knowledge], size: float, model: Model
) -> Prepared:
    """Records of a joint with the information of the other joints on the links.

    known: joint -> its information;  size: scale of this joint's observations
    model: of this joint
    """
    (joint,) = model.bodies
    mine = known[joint]
    nothing = Knowledge(np.zeros_like(mine.matrix), np.zeros_like(mine.vector))
    others = reduce(add, (k for j, k in known.items() if j != joint), nothing)
    fit = iter(share(add_links(model, prepared.of("fit")), others, size))
    stretches = tuple(next(fit) if s.use == "fit" else s for s in prepared.stretches)
    return replace(prepared, stretches=stretches)


def link_errors(
    models: Mapping[str, Model], records: Mapping[str, Prepared], prepared: PreparedParts
) -> Array:
    """Standard errors (b,) of the base parameters; NaN where no residual depends on one.

    models, records: of each joint
    """
    sizes = prepared.size
    rows, left, blocks, first = [], [], [], 0
    for j, model in models.items():
        columns, residual, slopes, plain = _linear(model, records[j].of("fit"))
        basis, n = span(slopes), len(residual)
        numbers = block_numbers(plain)
        numbers = np.append(numbers, np.full(n - len(numbers), numbers.max() + 1))
        rows.append((columns - basis @ (basis.T @ columns)) / sizes[j])
        left.append((residual - basis @ (basis.T @ residual)) / sizes[j])
        blocks.append(numbers + first)
        first = int(blocks[-1].max()) + 1
    return standard_errors(np.vstack(rows), np.concatenate(left), np.concatenate(blocks))


def _knowledge(model: Model, stretches: tuple[Stretch, ...], size: float) -> Knowledge:
    """Information of one joint on the base parameters, when its other parameters are free.

    size: root of the squares that count as one observation
    """
    columns, residual, slopes, _ = _linear(model, stretches, is_held=True)
    basis = span(slopes)
    columns, residual = (x - basis @ (basis.T @ x) for x in (columns, residual))
    # residual at b: residual - columns (b - links)
    target = residual + columns @ np.asarray(model.links)
    return Knowledge(columns.T @ columns / size**2, columns.T @ target / size**2)


def _linear(
    model: Model, stretches: tuple[Stretch, ...], *, is_held: bool = False
) -> tuple[Array, Array, Array, tuple[Stretch, ...]]:
    """Linear problem of a joint, with the priors of its shifts as additional rows.

    is_held: whether shifts that are held, or at a bound, cannot change: else the links would be
        those of a shift that the joint does not have
    returns: columns of the links (rows, b), residual (rows,), columns of the joint's parameters and
        shifts, and the stretches
    """
    plain, free = remove_links(add_links(model, stretches)), _list_inner_parameters(model)
    lasts = sum(s.counted_time for s in plain)
    shifts = record_shifts(plain, round(lasts / BLOCK), model)
    residual, slopes = weighted_residuals(model, plain, (*free, *shifts.names))
    slopes = slopes * np.append(np.ones(len(free)), shifts.row)
    samples = shifts.start(model)
    known, slope = shifts.prior(samples, residual, slopes)
    if is_held:
        stays = shifts.held | shifts.at_bound(samples)
        for part in (slopes, slope):
            part[:, len(free) :][:, stays] = 0.0
    columns = np.vstack([weighted_columns(s) for s in plain])
    nothing = np.zeros((len(known), columns.shape[1]))
    return (
        np.vstack([columns, nothing]),
        np.append(residual, known),
        np.vstack([slopes, slope]),
        plain,
    )


def _list_inner_parameters(model: Model) -> tuple[str, ...]:
    """Free parameters of present effects, and the strengths of absent effects."""
    absent = {f"{at}.{name}" for name, at in model.absent}
    first = {f"{at}.{n}.{model.body(at).effect(n).strength}" for n, at in model.absent}
    free = free_parameters(model)
    return tuple(n for n in free if n.rpartition(".")[0] not in absent or n in first)


def add_links(model: Model, stretches: tuple[Stretch, ...]) -> tuple[Stretch, ...]:
    """Stretches with the force of the links at a joint; at rest, friction balances this force.

    Otherwise rows at rest would confirm the base parameters of the model.
    """
    made = []
    for s, (body, motion) in zip(stretches, apply_record_offsets(model, stretches), strict=True):
        assert s.motion.links is not None
        wrt = [LinkParameter(motion.body, k) for k in range(len(model.links))]
        slopes = residual_along(body, motion, wrt).residual.tangent
        links = replace(s.motion.links, smooth=-s.motion.lowpassed(slopes))
        made.append(replace(s, motion=replace(s.motion, links=links)))
    return tuple(made)
