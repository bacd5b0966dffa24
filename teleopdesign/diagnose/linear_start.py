"""Start values of an effect: its least-squares strength, for each value of its other parameters.

An effect whose law is linear in its strength (an amplitude, a damping, an additional level) is
fitted at zero strength. Each combination of its other parameters needs one column of tangents, or
two where a phase turns a sine into a cosine. There are no iterations, so hundreds of combinations
can be fitted.

For any other effect: the squares that one linear step by all parameters promises from each start.

And further starts, where a missing effect has led the model before it astray.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from itertools import pairwise

import numpy as np
import sympy as sp

from ..effects import Effect
from ..measurement.filtering import Array
from ..measurement.prepare import Prepared
from ..model import Model
from ..realise.tangent_columns import Probe
from .fit import Fit
from .least_squares import (
    RIDGE,
    add_damping,
    column_sizes,
    reduce_to_triangle,
    span,
    sum_of_squares,
)
from .residual import weighted_residuals
from .search_plan import PLAN
from .solve import Solution, free_parameters, spans_decades

#: columns that pass through the friction balance in one call. The number is even, because a phase
#: takes two columns; with the residual and one more column they fill lanes of eight. With fewer,
#: the calls cost a millisecond each; with more, the columns of a record leave a processor's second
#: cache
AT_ONCE = 30


def linear_starts(
    models: list[Model], effect: Effect, at: str, prepared: Prepared, base: Fit
) -> list[tuple[float, Model]]:
    """Each model with its best strength (and phase) to first order, after the squares it promises.

    models: the same model with different values of the effect's other parameters
    base: the fit without the effect; its parameters and shifts of records change in the step too
    returns: smallest squares first, which the linear step leaves, relative as in `Fit`
    raises ValueError: the law of the effect is linear in no strength
    """
    if effect.strength is None:
        raise ValueError(f"{effect.name}: the law is not linear in a strength")
    phases = (0.0, math.pi / 2) if effect.phase else (0.0,)
    symbols = effect.symbols()
    probes = [
        Probe(at, symbols[effect.strength], _other_values(model, effect, at, symbols, phase))
        for model in models
        for phase in phases
    ]
    absent = (
        models[0]
        .with_values({f"{at}.{effect.name}.{effect.strength}": 0.0, **dict(base.model.parameters)})
        .with_record_shift(base.model.record_shift)
    )
    basis = span_of(base)
    left = base.fit_residual - basis @ (basis.T @ base.fit_residual)
    starts = []
    edges = list(range(0, len(probes), AT_ONCE)) + [len(probes)]
    for first, last in pairwise(edges):
        slopes = weighted_residuals(absent, prepared.of("fit"), probes[first:last])[1].T
        slopes = slopes - (slopes @ basis) @ basis.T
        for i in range(0, last - first, len(phases)):
            start = models[(first + i) // len(phases)]
            starts.append(_start(start, effect, at, left, slopes[i : i + len(phases)]))
    return sorted(starts, key=lambda start: start[0])


def span_of(base: Fit) -> Array:
    """Orthonormal columns (rows, p) that span what the parameters and shifts of a fit change."""
    return span(np.hstack([base.jacobian, base.by_shift]))


def _other_values(
    model: Model, effect: Effect, at: str, symbols: dict[str, sp.Symbol], phase: float
) -> dict[sp.Symbol, float]:
    known = model.parameters
    values = {symbols[n]: known[f"{at}.{effect.name}.{n}"].value for n in effect.parameters}
    if effect.phase:
        values[symbols[effect.phase]] = phase
    return values


def _start(
    model: Model, effect: Effect, at: str, left: Array, slopes: Array
) -> tuple[float, Model]:
    """The squares that are left with the strength, and phase, that removes most; the model so.

    left: (rows,) residual after the base's parameters
    slopes: (1 or 2, rows) derivatives of the residual by the strength at each phase
    """
    assert effect.strength is not None
    if not np.isfinite(slopes).all():  # no finite motion with these values
        return math.inf, model
    size = column_sizes(slopes.T)
    size[size == 0.0] = 1.0
    # of one or two rows: their multiples whose sum is nearest to what is left
    by = -np.linalg.lstsq((slopes / size[:, None]).T, left, rcond=1e-10)[0] / size
    values = {effect.strength: float(by[0])}
    if effect.phase:
        values = {
            effect.strength: float(np.hypot(*by)),
            effect.phase: float(np.arctan2(by[1], by[0])),
        }
    declared = effect.parameters[effect.strength]
    inside = float(np.clip(values[effect.strength], declared.lower, declared.upper))
    part = inside / values[effect.strength] if values[effect.strength] else 0.0
    values[effect.strength] = inside
    rest = left + part * (by @ slopes)
    full = {f"{at}.{effect.name}.{n}": v for n, v in values.items()}
    return float(rest @ rest), model.with_values(full)


class Promises:
    """Sums of squares after one linear step from starts of one model.

    base: the fit of the model without its new effects, on the same samples
    """

    def __init__(self, prepared: Prepared, base: Fit) -> None:
        self._base, self._scales, self._basis = base, prepared.scales, span_of(base)
        self._stretches = prepared.of("fit")

    def squares(self, model: Model) -> float:
        """Sum of squares after one step from this start, by all free parameters."""
        base, values, before = self._base, model.parameters, self._base.model.parameters
        same = all(values[n].value == before[n].value for n in base.free)
        wanted = [n for n in free_parameters(model) if not (same and n in base.free)]
        size = np.array([self._scales[model.declared(n).quantity] for n in wanted])
        residual, columns = weighted_residuals(model, self._stretches, wanted)
        columns = columns * size
        if not (np.isfinite(columns).all() and np.isfinite(residual).all()):
            return math.inf
        unit = column_sizes(columns)
        if same:  # the base's parameters remove their part, with the same columns at each start
            residual -= self._basis @ (self._basis.T @ residual)
            columns -= self._basis @ (self._basis.T @ columns)
        return _remaining_squares(columns, residual, unit)

    def squares_beside(self, model: Model) -> float:
        """Sum of squares that a model leaves with the base's parameters at their linear best.

        returns: inf where a motion grows beyond all numbers
        """
        residual, _ = weighted_residuals(model, self._stretches)
        if not np.isfinite(residual).all():
            return math.inf
        return sum_of_squares(residual - self._basis @ (self._basis.T @ residual))


def _remaining_squares(columns: Array, residual: Array, unit: Array) -> float:
    """Squares of the residual that no combination of these columns removes.

    unit: of each column: a column that is far smaller hardly differs from others, and stays out
    """
    size, triangle, target = reduce_to_triangle(columns, residual)
    if not np.isfinite(size).all():
        return math.inf
    of_unit = size / np.where(unit > 0.0, unit, 1.0)
    rows, right = add_damping(triangle * of_unit, target, RIDGE)
    step = np.linalg.lstsq(rows, right, rcond=None)[0]
    # least squares: the step is at right angles to what it leaves
    return sum_of_squares(residual) - float(right @ (rows @ step))


def starts_at_values_of_user(
    models: Sequence[Model], base: Fit, stated: Model | None
) -> list[Model]:
    """The starts at the user's values; none where the base lies within users' usual errors.

    While an effect is missing, other parameters move to values from which no search returns: a
    heavy tip behind a gap ends at 38 % of the force, from the user's values at 6 %.
    """
    if stated is None:
        return []
    here, there = base.model.parameters, stated.parameters
    pairs = [(here[n].value, there[n].value) for n in base.free if n in there]
    if all(abs(value - before) <= PLAN.moved * abs(before) for value, before in pairs):
        return []
    values = {n: v.value for n, v in there.items() if n in models[0].parameters}
    return [m.with_values(values) for m in models]


def without_endless(best: Solution, new: Collection[tuple[str, str]]) -> Model:
    """The model of a solution, with the effects absent whose search ran to the end of its range.

    There an effect is another one, or none: the Stribeck law at an endless speed is one more
    Coulomb level. No search returns from there, because no residual depends on the parameter.

    new: (effect, place) that have begun at all of their starting values
    returns: the model itself where there is no such effect
    """
    model = best.model
    values: dict[str, float] = {}
    for name, at_bound in zip(best.free, best.at_bound[: len(best.free)], strict=True):
        at, effect, _ = (*name.split("."), "")[:3]
        if not at_bound or not spans_decades(model, name) or (effect, at) in new:
            continue
        law = model.body(at).effect(effect)
        absent = {f"{at}.{effect}.{n}": law.default(n) for n in law.parameters}
        if not any(model.parameters[n].fixed for n in absent):
            values |= absent
    return model.with_values(values) if values else model


def with_what_they_need(model: Model, models: Sequence[Model], prepared: Prepared) -> list[Model]:
    """The same starts with strengths of the size of the force, where the new effects need others.

    Without the new effect, a fit may have taken the effect that it needs away: rigid friction does
    not describe a bristle in which most of the motion takes place, and its level falls to zero.
    """
    values: dict[str, float] = {}
    for name, at in model.absent:
        body = model.body(at)
        for needed in body.effect(name).needs:
            strength = body.effect(needed).strength if body.has(needed) else None
            full = f"{at}.{needed}.{strength}"
            # another effect of its role may stand in for it; a contact's needs no start
            value = model.parameters.get(full)
            if value is None or value.fixed:
                continue
            size = prepared.scales[model.declared(full).quantity]
            if value.value < PLAN.taken_away * size:
                values[full] = size
    return [m.with_values(values) for m in models] if values else []


def with_hidden_states_anew(model: Model) -> Model | None:
    """The model with effects absent, too, that its new ones need and that have hidden states.

    Without the new effect a fit leads such states elsewhere: the tip of a transmission stands in
    for the friction that holds it, and no search returns from there.
    returns: None where no new effect needs such a one
    """
    values: dict[str, float] = {}
    for name, at in model.absent:
        body = model.body(at)
        roles = {model.known[n].role for n in body.effect(name).needs if n in model.known}
        for needed in (e for e in body.effects if e.role in roles and e.states and e.absent):
            absent = {f"{at}.{needed.name}.{n}": needed.default(n) for n in needed.parameters}
            if not any(model.parameters[n].fixed for n in absent):
                values |= absent
    return model.with_values(values) if values else None
