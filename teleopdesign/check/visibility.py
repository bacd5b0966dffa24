"""The least size of each effect that these records can show.

The effect is added to the fitted model at some strength. The change of the residual along the
measured motion is its mark. A fit can detect only the part of the mark that the model's parameters
cannot imitate, which is outside the span of their columns. The strength is then changed until this
part exceeds the noise floor by the factor that a diagnosis requires. Effects are known here by
their declared parameters only, so a user's effects are treated like all others.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from ..diagnose.candidates import Candidate
from ..diagnose.criteria import CRITERIA
from ..diagnose.fit import Fit, weigh_residuals
from ..diagnose.residual import relative_residuals
from ..measurement.filtering import Array
from ..measurement.prepare import Prepared, Stretch
from ..measurement.scales import scales
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
    strength: parameter -> value (SI) at this strength;  shape: the same for its other parameters
    unique_share: part of its mark that the model's parameters cannot imitate, 0 to 1
    imitated: the model's parameters that imitate the rest of it best
    mark: direction of that part, (rows,), length 1;  silent: whether the effect has no force at all
    """

    candidate: Candidate
    size: float
    strength: dict[str, float]
    shape: dict[str, float]
    unique_share: float
    imitated: tuple[str, ...]
    mark: Array
    silent: bool


@dataclass(frozen=True)
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


@dataclass(frozen=True)
class _Trial:
    """One strength: its whole mark and the part outside the span, rms over the measured force.

    factor: strength over the first one;  whole, part: sizes of mark (rows,) and rest (rows,)
    """

    model: Model
    factor: float
    whole: float
    part: float
    mark: Array
    rest: Array

    @property
    def unique_share(self) -> float:
        """Part of the mark that the model's parameters cannot imitate."""
        return self.part / self.whole if self.whole > 0.0 else 0.0


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
    kept = span[0][:, span[1] > 1e-8 * span[1].max(initial=0.0)]
    scene = _Scene(
        base,
        stretches,
        residual,
        kept,
        math.sqrt(sum(s.measured for s in stretches)),
        # an error of `adequate` floors is where a model stops being adequate
        # (and no floor, of a record that repeats without noise, is that of rounding)
        max(floor * math.sqrt(CRITERIA.adequate**2 - 1.0), float(np.finfo(float).eps)),
    )
    unit = scales([s.motion for s in stretches], prepared.bandwidth)
    return [_visibility(c, scene, unit) for c in candidates]


def _visibility(candidate: Candidate, scene: _Scene, unit: dict[str, float]) -> Visibility:
    shapes = _shapes(candidate, scene.base.model, unit)
    best, shaped = _find_best(candidate, shapes, 1.0, scene)
    if best.unique_share < CRITERIA.least_unique_share:
        best, shaped = _find_best(candidate, shapes, STRONG, scene)
    if best.unique_share >= CRITERIA.least_unique_share:
        best = _strength_at_threshold(candidate, best, shaped, scene)
    shows = best.unique_share >= CRITERIA.least_unique_share and best.part >= scene.threshold
    strength, shape = _values(candidate, best.model)
    return Visibility(
        candidate,
        best.whole if shows else math.inf,
        strength,
        shape,
        best.unique_share,
        _list_imitators(best, scene),
        best.rest / max(float(np.linalg.norm(best.rest)), 1e-300),
        best.whole < 1e-9,
    )


def _find_best(
    candidate: Candidate, shapes: Sequence[Model], factor: float, scene: _Scene
) -> tuple[_Trial, Model]:
    """The most visible shape at equal strength, with shapes that are not imitated preferred."""
    trials = [(_trial(candidate, m, factor, scene), m) for m in shapes]
    return max(trials, key=lambda t: (t[0].unique_share >= CRITERIA.least_unique_share, t[0].part))


def _shapes(candidate: Candidate, model: Model, unit: dict[str, float]) -> list[Model]:
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


def _trial(candidate: Candidate, shaped: Model, factor: float, scene: _Scene) -> _Trial:
    """The effect at `factor` times its first strength, which is not that of absence."""
    effect, place = candidate.effect, candidate.at
    values = {}
    for name, absent in effect.absent.items():
        full = f"{place}.{effect.name}.{name}"
        first = shaped.parameters[full].value
        if math.isinf(absent):
            values[full] = first / factor
        else:
            step = first - absent if first != absent else 0.1
            values[full] = absent + factor * step
    model = _keep_within_bounds(shaped, values)
    parts = relative_residuals(model, scene.stretches)
    mark = weigh_residuals(scene.stretches, [r for r, _ in parts]) - scene.residual
    if not np.isfinite(mark).all():
        mark = np.zeros_like(mark)
    rest = mark - scene.span @ (scene.span.T @ mark)
    whole, part = (float(np.linalg.norm(y)) / scene.measured for y in (mark, rest))
    return _Trial(model, factor, whole, part, mark, rest)


def _strength_at_threshold(
    candidate: Candidate, first: _Trial, shaped: Model, scene: _Scene
) -> _Trial:
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
        trials.append(_trial(candidate, shaped, factor, scene))
        slope = _slope(here, trials[-1], slope)
    shown = [t for t in trials if t.part >= scene.threshold]
    return min(shown, key=lambda t: t.factor) if shown else max(trials, key=lambda t: t.part)


def _slope(one: _Trial, two: _Trial, before: float) -> float:
    """Exponent by which the visible part grows with the strength; `before` if not known."""
    if min(one.part, two.part) <= 0.0 or one.factor == two.factor or one.part == two.part:
        return before
    exponent = math.log(two.part / one.part) / math.log(two.factor / one.factor)
    return min(max(exponent, 0.3), 5.0)


def _values(candidate: Candidate, model: Model) -> tuple[dict[str, float], dict[str, float]]:
    effect = candidate.effect
    prefix = f"{candidate.at}.{effect.name}."
    values = {n: model.parameters[prefix + n].value for n in effect.parameters}
    strength = {n: v for n, v in values.items() if n in effect.absent}
    return strength, {n: v for n, v in values.items() if n not in effect.absent}


def _list_imitators(trial: _Trial, scene: _Scene) -> tuple[str, ...]:
    """At most two free parameters of the model that imitate a third of a mark or more."""
    columns, names = scene.base.jacobian, scene.base.free
    size = np.linalg.norm(columns, axis=0)
    size[size == 0.0] = 1.0
    if not len(names) or trial.whole == 0.0:
        return ()
    shares = np.abs(np.linalg.lstsq(columns / size, trial.mark, rcond=1e-9)[0])
    order = np.argsort(-shares)
    whole = float(np.linalg.norm(trial.mark))
    return tuple(names[i] for i in order[:2] if shares[i] > whole / 3)
