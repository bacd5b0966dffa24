"""The least size of each effect that these records can show.

The effect is added to the fitted model at some strength. The change of the residual along the
measured motion is its mark. A fit can detect only the part of the mark that the model's parameters
cannot imitate, which is outside the span of their columns. The strength is then changed until this
part exceeds the noise floor by the factor that a diagnosis requires. Effects are known here by
their declared parameters only, so a user's effects are treated like all others.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from ..diagnose.candidates import Candidate
from ..diagnose.criteria import CRITERIA
from ..diagnose.error import weigh_residuals
from ..diagnose.fit import Fit
from ..diagnose.residual import relative_residuals
from ..measurement.filtering import Array
from ..measurement.prepare import Prepared, Stretch
from ..model import Model

#: most shapes of one effect (periods, speeds) that are evaluated
SHAPES = 4
#: factor on the first strength of an effect if this strength is not visible
STRONG = 30.0
#: most corrections of the strength; the strength is close enough between the threshold and CLOSE
#: times the threshold
CORRECTIONS, CLOSE = 6, 1.25
#: range of strengths that is searched, over the effect's starting value; longest step of a
#: correction, in the natural logarithm
WEAKEST, STRONGEST, FARTHEST = 1e-6, 1e4, 7.0


@dataclass(frozen=True)
class Visibility:
    """The smallest visible strength of one effect.

    size: force of the effect at the least visible strength, relative to the measured force (both
        rms, low-passed); inf where no strength is visible
    strength: parameter -> value (SI) at this strength
    unique_share: part of its mark that the model's parameters cannot imitate, 0 to 1
    imitated: the model's parameters that imitate the rest of it best
    mark: direction of that part, (rows,), length 1;  silent: whether the effect has no force at all
    """

    candidate: Candidate
    size: float
    strength: dict[str, float]
    unique_share: float
    imitated: tuple[str, ...]
    mark: Array
    silent: bool


@dataclass(frozen=True, eq=False)
class _Trial:
    """One strength of an effect.

    shaped: the model with the effect at its first strength;  factor: strength over the first one
    mark: (rows,) change of the residual;  rest: (rows,) the part of it outside the span of the
        model's parameters
    whole, part: sizes of mark and rest, over the root of the measured squares
    """

    shaped: Model
    model: Model
    factor: float
    mark: Array
    rest: Array
    whole: float
    part: float

    @property
    def unique_share(self) -> float:
        """Part of the mark that the model's parameters cannot imitate."""
        return self.part / self.whole if self.whole > 0.0 else 0.0

    @property
    def is_unique(self) -> bool:
        """Whether a fit can tell the effect from the model's parameters."""
        return self.unique_share >= CRITERIA.least_unique_share


@dataclass(frozen=True, eq=False)
class _Scene:
    """The fitted model, its records, and the threshold of visibility (all rows weighted).

    residual: (rows,);  span: (rows, k) orthonormal, of the model's parameters
    measured: root of the measured squares;  threshold: least visible part, relative to it
    """

    base: Fit
    stretches: Sequence[Stretch]
    residual: Array
    span: Array
    measured: float
    threshold: float

    def try_strength(self, candidate: Candidate, shaped: Model, factor: float) -> _Trial:
        """The effect at `factor` times its first strength, which is not that of absence."""
        values = {}
        for name, absent in candidate.effect.absent.items():
            full = f"{candidate.at}.{candidate.effect.name}.{name}"
            first = shaped.parameters[full].value
            if math.isinf(absent):
                values[full] = first / factor
            else:
                step = first - absent if first != absent else 0.1
                values[full] = absent + factor * step
        model = _keep_within_bounds(shaped, values)
        parts = relative_residuals(model, self.stretches)
        mark = weigh_residuals(self.stretches, [r for r, _ in parts]) - self.residual
        if not np.isfinite(mark).all():
            mark = np.zeros_like(mark)
        rest = mark - self.span @ (self.span.T @ mark)
        whole, part = (float(np.linalg.norm(y)) / self.measured for y in (mark, rest))
        return _Trial(shaped, model, factor, mark, rest, whole, part)

    def best_shape(self, candidate: Candidate, shapes: Sequence[Model], factor: float) -> _Trial:
        """The most visible shape at equal strength, one that is not imitated if there is any."""
        trials = [self.try_strength(candidate, shaped, factor) for shaped in shapes]
        return max(trials, key=lambda t: (t.is_unique, t.part))


def visibilities(
    base: Fit, prepared: Prepared, candidates: Sequence[Candidate], floor: float
) -> list[Visibility]:
    """The smallest visible strength of each candidate on the fit records.

    floor: noise floor of these records, a relative force error
    """
    stretches = prepared.of("fit")
    residual = weigh_residuals(stretches, [r for r, _ in relative_residuals(base.model, stretches)])
    columns = np.hstack([base.jacobian, base.by_shift])
    columns = columns[:, np.linalg.norm(columns, axis=0) > 0]
    span = np.linalg.svd(columns / np.linalg.norm(columns, axis=0), full_matrices=False)
    scene = _Scene(
        base,
        stretches,
        residual,
        span[0][:, span[1] > 1e-8 * span[1].max(initial=0.0)],
        math.sqrt(sum(s.measured for s in stretches)),
        # an error of `adequate` floors is where a model stops being adequate
        # (and no floor, of a record that repeats without noise, is that of rounding)
        max(floor * math.sqrt(CRITERIA.adequate**2 - 1.0), float(np.finfo(float).eps)),
    )
    return [_visibility(c, scene, prepared.scales) for c in candidates]


def _visibility(candidate: Candidate, scene: _Scene, unit: Mapping[str, float]) -> Visibility:
    shapes = _shapes(candidate, scene.base.model, unit)
    best = scene.best_shape(candidate, shapes, 1.0)
    if not best.is_unique:
        best = scene.best_shape(candidate, shapes, STRONG)
    if best.is_unique:
        best = _strength_at_threshold(candidate, best, scene)
    effect, place = candidate.effect, f"{candidate.at}.{candidate.effect.name}"
    return Visibility(
        candidate,
        best.whole if best.is_unique and best.part >= scene.threshold else math.inf,
        {n: best.model.parameters[f"{place}.{n}"].value for n in effect.absent},
        best.unique_share,
        _list_imitators(best, scene.base),
        best.rest / max(float(np.linalg.norm(best.rest)), 1e-300),
        best.whole < 1e-9,
    )


def _shapes(candidate: Candidate, model: Model, unit: Mapping[str, float]) -> list[Model]:
    """The model with the effect at its first strength, for a few values of its other parameters.

    Only one phase is used, because visibility hardly depends on it.
    """
    effect, place = candidate.effect, candidate.at
    added = model.with_effect(effect, at=place)
    names = [f"{place}.{effect.name}.{n}" for n in effect.parameters]
    grids = []
    for full, (name, p) in zip(names, effect.parameters.items(), strict=True):
        one = name in effect.absent or p.search.chosen or p.quantity == "angle"
        scaled = [x * unit[p.scale] for x in (p.search.starts[:1] if one else p.search.starts)]
        grids.append([added.parameters[full].value] if p.optional else scaled)
    every = list(product(*grids))
    some = every[:: max(1, math.ceil(len(every) / SHAPES))]
    return [_keep_within_bounds(added, dict(zip(names, values, strict=True))) for values in some]


def _keep_within_bounds(model: Model, values: dict[str, float]) -> Model:
    bounds = {n: model.declared(n) for n in values}
    inside = {n: min(max(v, bounds[n].lower), bounds[n].upper) for n, v in values.items()}
    return model.with_values(inside)


def _strength_at_threshold(candidate: Candidate, first: _Trial, scene: _Scene) -> _Trial:
    """The least visible strength; the most visible one where none reaches the threshold.

    By secants of the logarithms, and bisection between a visible and an invisible factor, for
    effects such as a limit that appear suddenly.
    """
    trials, slope = [first], 1.0
    for _ in range(CORRECTIONS):
        here = trials[-1]
        if 1.0 <= here.part / scene.threshold < CLOSE:
            break
        low = max((t.factor for t in trials if t.part < scene.threshold), default=WEAKEST)
        high = min((t.factor for t in trials if t.part >= scene.threshold), default=STRONGEST)
        factor = math.sqrt(low * high)
        if here.part > 0.0:
            aim = scene.threshold * math.sqrt(CLOSE) / here.part
            step = min(max(math.log(aim) / slope, -FARTHEST), FARTHEST)
            secant = here.factor * math.exp(step)
            factor = secant if low < secant < high else factor
        trials.append(scene.try_strength(candidate, first.shaped, factor))
        slope = _slope(here, trials[-1], slope)
    shown = [t for t in trials if t.part >= scene.threshold]
    return min(shown, key=lambda t: t.factor) if shown else max(trials, key=lambda t: t.part)


def _slope(one: _Trial, two: _Trial, before: float) -> float:
    """Exponent by which the visible part grows with the strength; `before` if not known."""
    if min(one.part, two.part) <= 0.0 or one.factor == two.factor or one.part == two.part:
        return before
    exponent = math.log(two.part / one.part) / math.log(two.factor / one.factor)
    return min(max(exponent, 0.3), 5.0)


def _list_imitators(trial: _Trial, base: Fit) -> tuple[str, ...]:
    """At most two free parameters of the model that imitate a third of a mark or more."""
    size = np.linalg.norm(base.jacobian, axis=0)
    size[size == 0.0] = 1.0
    if not len(base.free) or trial.whole == 0.0:
        return ()
    shares = np.abs(np.linalg.lstsq(base.jacobian / size, trial.mark, rcond=1e-9)[0])
    best, whole = np.argsort(-shares)[:2], float(np.linalg.norm(trial.mark))
    return tuple(base.free[i] for i in best if shares[i] > whole / 3)
