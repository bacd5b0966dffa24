"""The best fit of a model with new effects, from many starting values.

Few survive each round: first one linear step is predicted from every start, and where none promises
a gain the search ends; then a few real steps are made from the best, then rough fits. A fine one is
made of what ranks first.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..effects import Effect
from ..measurement.filtering import Array
from ..model import Model
from .candidates import started
from .fit import FINE, ROUGH, Effort, Fit, estimate, fit_squares, free_parameters, solve
from .force_error import Prepared, referred
from .linear_start import linear_starts
from .scales import scales

#: gain in squares on the fit records from which a start is worth a step
WORTH = 0.01
#: starts kept after the prediction, and after the first steps
PREDICTED, STEPPED = 2, 1
FIRST_STEPS = Effort(1e-3, 4)


def estimate_from_starts(model: Model, prepared: Prepared, base: Fit | None = None) -> Fit:
    """The best fit of a model, from every starting value of the effects that are still absent.

    base: a fit of the model without them: then the best stays rough, to be ranked first
    """
    unit = scales([s.motion for s in prepared.of("fit")], prepared.bandwidth)
    models = started(model, unit)
    if base is not None:
        models = _promising(model, models, prepared, base, unit)
        if not models:
            return unchanged(model, base)
    elif len(models) == 1:
        return estimate(model, prepared)
    if len(models) > STEPPED + 1:
        models = _best_stepped(models, prepared)
    rough = [estimate(m, prepared, effort=ROUGH) for m in models]
    best = min(rough, key=fit_squares)
    return best if base is not None else estimate(best.model, prepared, effort=FINE)


def unchanged(model: Model, base: Fit) -> Fit:
    """The fit of a model whose new effects stay absent: what the base leaves, all of it."""
    return replace(base, model=model.with_values(dict(base.model.parameters)))


def _promising(
    model: Model, models: list[Model], prepared: Prepared, base: Fit, unit: dict[str, float]
) -> list[Model]:
    """The starts from which one linear step promises most; none where none promises a gain."""
    new = [n for n in free_parameters(model) if n not in base.free]
    effects = {model.body(place).effect(name): place for name, place in model.absent}
    if len(effects) == 1:
        ((effect, place),) = effects.items()
        if effect.strength is not None and f"{place}.{effect.name}.{effect.strength}" in new:
            return _by_strength(models, effect, place, prepared, base)
    promised = sorted((_promise(m, new, prepared, base, unit), i) for i, m in enumerate(models))
    if promised[0][0] > (1.0 - WORTH) * fit_squares(base):
        return []
    return [models[i] for _, i in promised[:PREDICTED]]


def _by_strength(
    models: list[Model], effect: Effect, at: str, prepared: Prepared, base: Fit
) -> list[Model]:
    """The best starts of an effect that is linear in its strength; none where none is worth it."""
    strength = f"{at}.{effect.name}.{effect.strength}"
    distinct: dict[tuple[float, ...], Model] = {}
    for model in models:
        others = {n: v.value for n, v in model.parameters.items() if n != strength}
        distinct.setdefault(tuple(others.values()), model)
    starts = linear_starts(list(distinct.values()), effect, at, prepared, base)
    if starts[0].promised > (1.0 - WORTH) * fit_squares(base):
        return []
    return [s.model for s in starts[:PREDICTED]]


def _promise(
    model: Model, new: list[str], prepared: Prepared, base: Fit, unit: dict[str, float]
) -> float:
    """Sum of squares after one linear step from this start, by all parameters."""
    stretches = prepared.of("fit")
    parts = referred(model, stretches, new)
    roots = [np.sqrt(s.weight) for s in stretches]
    residual = np.concatenate([w * r for w, (r, _) in zip(roots, parts, strict=True)])
    columns = np.concatenate([w * d.T for w, (_, d) in zip(roots, parts, strict=True)])
    columns = columns * np.array([unit[model.declared(n).quantity] for n in new])
    return _left(np.hstack([base.jacobian, columns]), residual)


def _left(columns: Array, residual: Array) -> float:
    """Squares of the residual that these columns cannot take away, by normal equations."""
    size = np.linalg.norm(columns, axis=0)
    columns = columns / np.where(size > 0, size, 1.0)
    normal = columns.T @ columns + 1e-9 * np.eye(columns.shape[1])
    gradient = columns.T @ residual
    return float(residual @ residual - gradient @ np.linalg.solve(normal, gradient))


def _best_stepped(models: list[Model], prepared: Prepared) -> list[Model]:
    """The starts that lie lowest after a few real steps, where these steps have led them."""
    stretches, found = prepared.of("fit"), []
    for i, model in enumerate(models):
        free = free_parameters(model)
        solution = solve(model, free, prepared, stretches, FIRST_STEPS)
        squares = float(solution.residual @ solution.residual)
        found.append((squares, i, dict(zip(free, solution.values.tolist(), strict=True))))
    found.sort(key=lambda f: f[:2])
    return [models[i].with_values(values) for _, i, values in found[:STEPPED]]
