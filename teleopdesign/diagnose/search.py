"""The best fit of a model with new effects, from many starting values.

Few survive each round: first one linear step is predicted from every start, and where none promises
a gain the search ends; then a few real steps are made from the best, then rough fits. A fine one is
made of what ranks first.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from ..effects import Effect
from ..measurement.filtering import Array
from ..model import Model
from .candidates import started
from .criteria import CRITERIA
from .effort import EFFORTS
from .fit import Fit, estimate, fit_squares, free_parameters, solve
from .linear_start import linear_starts
from .prepare import Prepared
from .residual import relative_residuals
from .scales import scales
from .search_plan import PLAN


def estimate_from_starts(
    model: Model,
    prepared: Prepared,
    base: Fit | None = None,
    stated: Model | None = None,
    *,
    worth: float = CRITERIA.worth,
) -> Fit:
    """The best fit of a model, from every starting value of the effects that are still absent.

    base: a fit of the model without them: then the best stays rough, to be ranked first
    stated: the model as its user gave it: what the base moved far from it starts there too
    worth: part of the base's squares that one linear step must promise to take away
    """
    unit = scales([s.motion for s in prepared.of("fit")], prepared.bandwidth)
    models = started(model, unit)
    absent = [model.body(at).effect(name) for name, at in model.absent]
    rugged = any(e.corrections() and not e.linear for e in absent)
    kept = PLAN.corrected_stepped if rugged else PLAN.curved_stepped
    if base is not None:
        curved = _with_strength(model, base) is None
        kept = kept if curved else PLAN.stepped
        if curved and stated is not None and _moved(base, stated):
            models += [at_stated(m, stated) for m in models]
        most = PLAN.corrected_predicted if rugged else PLAN.curved_predicted
        models = _promising(model, models, prepared, base, unit, most=most, worth=worth)
        if not models:
            return unchanged(model, base)
    elif len(models) == 1:
        return estimate(model, prepared)
    if len(models) > kept + 1:
        models = _best_stepped(models, prepared, kept, promised=base is not None)
    rough = [estimate(m, prepared, effort=EFFORTS.rough) for m in models]
    best = min(rough, key=fit_squares)
    if rugged and base is not None and fit_squares(best) < PLAN.jolted * fit_squares(base):
        best = _jolted(best, model.absent, prepared)
    return best if base is not None else estimate(best.model, prepared, effort=EFFORTS.fine)


def at_stated(model: Model, stated: Model) -> Model:
    """The model with its user's values: without an effect that is missing, others may have gone
    where no step leads back from.
    """
    there = model.parameters  # an effect of the user's may have given way to another
    return model.with_values({n: v.value for n, v in stated.parameters.items() if n in there})


def unchanged(model: Model, base: Fit) -> Fit:
    """The fit of a model whose new effects stay absent: the residual of the base."""
    there = model.with_values(dict(base.model.parameters))
    return replace(base, model=there.with_record_shift(base.model.record_shift))


def _promising(
    model: Model,
    models: list[Model],
    prepared: Prepared,
    base: Fit,
    unit: dict[str, float],
    *,
    most: int,
    worth: float,
) -> list[Model]:
    """The starts from which one linear step promises most; none where none promises a gain.

    most: how many, for an effect that has no strength
    """
    linear = _with_strength(model, base)
    if linear is not None:
        return _by_strength(models, *linear, prepared, base, worth)
    promised = sorted((_promise(m, prepared, base, unit), i) for i, m in enumerate(models))
    if promised[0][0] > (1.0 - worth) * fit_squares(base):
        return []
    return _varied(model, [models[i] for _, i in promised])[:most]


def _varied(model: Model, ordered: list[Model]) -> list[Model]:
    """The starts; first those at each value of parameters that the new effects need.

    A search that begins at a gap too narrow closes it, and never opens it again.
    """
    essential = [
        f"{at}.{name}.{n}"
        for name, at in model.absent
        for n, p in model.body(at).effect(name).parameters.items()
        if p.search.essential
    ]
    first: dict[tuple[float, ...], Model] = {}
    rest = []
    for start in ordered:
        value = tuple(start.parameters[n].value for n in essential)
        if first.setdefault(value, start) is not start:
            rest.append(start)
    return [*first.values(), *rest]


def _with_strength(model: Model, base: Fit) -> tuple[Effect, str] | None:
    """The one effect that is still absent, and its place, where it has a strength that is free."""
    absent = [(model.body(place).effect(name), place) for name, place in model.absent]
    if len(absent) != 1 or absent[0][0].strength is None:
        return None
    effect, place = absent[0]
    strength = f"{place}.{effect.name}.{effect.strength}"
    return absent[0] if not model.parameters[strength].fixed else None


def _moved(base: Fit, stated: Model) -> bool:
    """Whether the base moved a parameter further from the user's value than users usually err."""
    here, there = base.model.parameters, stated.parameters
    pairs = [(here[n].value, there[n].value) for n in base.free if n in there]
    return any(abs(value - before) > PLAN.moved * abs(before) for value, before in pairs)


def _by_strength(
    models: list[Model], effect: Effect, at: str, prepared: Prepared, base: Fit, worth: float
) -> list[Model]:
    """The best starts of an effect that is linear in its strength; none if no gain is expected."""
    strength = f"{at}.{effect.name}.{effect.strength}"
    distinct: dict[tuple[float, ...], Model] = {}
    for model in models:
        others = {n: v.value for n, v in model.parameters.items() if n != strength}
        distinct.setdefault(tuple(others.values()), model)
    starts = linear_starts(list(distinct.values()), effect, at, prepared, base)
    if starts[0].promised > (1.0 - worth) * fit_squares(base):
        return []
    return [s.model for s in starts[: PLAN.predicted]]


def _promise(model: Model, prepared: Prepared, base: Fit, unit: dict[str, float]) -> float:
    """Sum of squares after one linear step from this start, by all parameters."""
    stretches = prepared.of("fit")
    values, before = model.parameters, base.model.parameters
    same = all(values[n].value == before[n].value for n in base.free)
    wanted = [n for n in free_parameters(model) if not (same and n in base.free)]
    parts = relative_residuals(model, stretches, wanted)
    roots = [np.sqrt(s.weight) for s in stretches]
    residual = np.concatenate([w * r for w, (r, _) in zip(roots, parts, strict=True)])
    columns = np.concatenate([w * d.T for w, (_, d) in zip(roots, parts, strict=True)])
    columns = columns * np.array([unit[model.declared(n).quantity] for n in wanted])
    whole = np.hstack([base.jacobian, base.by_shift, columns]) if same else columns
    return _left(whole, residual) if np.isfinite(whole).all() else math.inf


def _left(columns: Array, residual: Array) -> float:
    """Squares of the residual that these columns cannot take away, by normal equations."""
    size = np.linalg.norm(columns, axis=0)
    columns = columns / np.where(size > 0, size, 1.0)
    normal = columns.T @ columns + 1e-9 * np.eye(columns.shape[1])
    gradient = columns.T @ residual
    return float(residual @ residual - gradient @ np.linalg.solve(normal, gradient))


def _best_stepped(
    models: list[Model], prepared: Prepared, kept: int, *, promised: bool
) -> list[Model]:
    """The best starts after a few steps of the fit, at the values that these steps reached.

    promised: whether the first is the one that promised most: it is kept too, for steps that begin
        far from an optimum may lie above those that never leave the base
    """
    stretches, solutions = prepared.of("fit"), []
    for i, model in enumerate(models):
        free = free_parameters(model)
        solution = solve(model, free, prepared, stretches, EFFORTS.first_steps)
        squares = float(solution.residual @ solution.residual)
        solutions.append((squares, i, solution.model))
    solutions.sort(key=lambda f: f[:2])
    best = solutions[:kept] + [f for f in solutions[kept:] if promised and f[1] == 0]
    return [there for _, _, there in best]


def _jolted(fit: Fit, new: Sequence[tuple[str, str]], prepared: Prepared) -> Fit:
    """The best fit near by: a rugged sum of squares has many shallow minima.

    new: (effect, place) whose parameters are jolted, one at a time
    """
    stretches, free = prepared.of("fit"), free_parameters(fit.model)
    names = [n for effect, at in new for n in free if n.startswith(f"{at}.{effect}.")]
    model, least = fit.model, fit_squares(fit)
    for _ in range(PLAN.sweeps):
        before = least
        for name, factor in product(names, PLAN.jolts):
            jolted = model.with_values({name: model.parameters[name].value * factor})
            solution = solve(jolted, free, prepared, stretches, EFFORTS.first_steps)
            squares = float(solution.residual @ solution.residual)
            if squares < least:
                least, model = squares, solution.model
        if least > (1.0 - PLAN.onward) * before:
            break
    return fit if model is fit.model else estimate(model, prepared, effort=EFFORTS.rough)
