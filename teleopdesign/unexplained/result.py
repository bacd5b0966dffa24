"""Where a model fails, and a description of the residual that no candidate explains.

A description of one body has its rows, the dependences of its residual, and the sentences.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.files import make_plain
from ..base.finding import Finding, Graph
from ..base.frozen import ByValue
from ..base.shown import Shown, figure_of, look
from ..base.units import unit_of
from ..diagnose.criteria import CRITERIA
from ..diagnose.fit import Fit
from ..diagnose.noise_floor import NoiseFloor, noise_floor
from ..diagnose.stated_fit import estimate_stated
from ..measurement.experiment import Experiment
from ..measurement.prepare import Prepared, prepare
from ..model import Model
from .curve import Curve, curve_of, regions_of, without_columns
from .dependence import Contrast, Dependence, contrasts, dependences, model_columns
from .formula import Formula, formula_for, formula_text
from .rows import Rows, rows_of
from .shapes import Shape
from .views import Whiteness, curve_graph, views_of, whiteness_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class ResidualDescription(Shown, ByValue):
    """Residual of a fitted model on every body, and the signals that it depends on.

    parts: one per body
    """

    model: Model
    prepared: Prepared
    parts: tuple[BodyResidual, ...]

    @property
    def findings(self) -> tuple[Finding, ...]:
        """The sentences, each with its numbers and its graph."""
        return tuple(look(self, "findings"))

    @property
    def largest(self) -> tuple[BodyResidual, DescribedDependence] | None:
        """The body and the dependence that explain most of the residual; None: no dependence."""
        first_of_body = [(p, p.dependences[0]) for p in self.parts if p.dependences]
        return max(
            first_of_body,
            key=lambda pd: pd[0].error ** 2 * pd[1].dependence.explained,
            default=None,
        )

    def plot(self) -> Figure:
        """The views of each body, and the curve of each dependence."""
        return figure_of(self)

    def as_data(self) -> dict[str, Any]:
        """The findings, dependences with curves, and every test as plain data; SI units."""
        data = {
            "findings": [
                {
                    "topic": f.topic,
                    "concern": f.concern,
                    "where": f.where,
                    "sentence": f.sentence,
                    "numbers": dict(f.numbers),
                }
                for f in self.findings
            ],
            "bodies": [_body(p) for p in self.parts],
        }
        content: dict[str, Any] = make_plain(data)
        return content


def describe_residual(
    model: Model | Fit, prepared: Prepared, floor: NoiseFloor | None = None, *, seed: int = 0
) -> ResidualDescription:
    """Describe the force residual of a fitted model on each body.

    model: with its free parameters estimated on the fit records (here they change too, to first
        order)
    floor: noise floor of a diagnosis that ended with this model; the same part of each body's floor
        counts; None: the whole floor
    seed: of the random numbers for the noise floor
    """
    chosen = model.model if isinstance(model, Fit) else model
    bodies = [b for b in chosen.bodies if any(s.motion.body == b for s in prepared.of("fit"))]
    counted = 1.0 if floor is None else floor.counted
    parts = tuple(describe_body(chosen, prepared, b, counted=counted, seed=seed) for b in bodies)
    return ResidualDescription(chosen, prepared, parts)


def where_it_fails(
    model: Model | Fit, prepared: Prepared, floor: NoiseFloor | None = None
) -> tuple[Finding, ...]:
    """Plain sentences on where a fitted model fails, each with the numbers behind the sentence.

    model, prepared, floor: as for `describe_residual`
    """
    return describe_residual(model, prepared, floor).findings


def describe(model: Model, experiment: Experiment, *, seed: int = 0) -> ResidualDescription:
    """Estimate the model again, then describe where it fails and what its residual depends on.

    model: its values are start values
    experiment: dependences are estimated on its fit records and tested on its check records
    seed: of the random numbers for the noise floor
    """
    prepared = prepare(experiment)
    return describe_residual(estimate_stated(model, prepared), prepared, seed=seed)


def _body(part: BodyResidual) -> dict[str, Any]:
    return {
        "body": part.body,
        "check_error": part.error,
        "noise_floor": part.floor,
        "check_error_described": part.after,
        "dependences": [_dependence(d, part.axis) for d in part.dependences],
        "tests": [
            {
                "dependence": t.shape.name,
                "score": t.score,
                "probability_of_chance": t.probability,
                "explained": t.explained,
            }
            for t in part.tests
        ],
        "whiteness": None
        if part.whiteness is None
        else {
            "probability_of_chance": part.whiteness.probability,
            "half_between_hertz": list(part.whiteness.band),
        },
    }


def _dependence(one: DescribedDependence, axis: str) -> dict[str, Any]:
    shape, curve = one.dependence.shape, one.curve
    return {
        "dependence": shape.name,
        "sentence": one.sentence,
        "explained": one.dependence.explained,
        "score": one.dependence.score,
        "formula": None if one.formula is None else formula_text(one.formula, axis),
        "curve": {
            "x": curve.x.tolist(),
            "x_unit": "" if shape.variable is None else unit_of(shape.variable.quantity, axis),
            "y": curve.y.tolist(),
            "low": curve.low.tolist(),
            "high": curve.high.tolist(),
            "y_unit": unit_of(shape.carrier.quantity, axis),
        },
    }


@dataclass(frozen=True)
class DescribedDependence:
    """One dependence with its curve, formula and sentence.

    curve: as in the residual;  formula: None where none with few terms holds
    contrasts: sizes in both directions, and after a rest or a reversal
    graph: the figure of the sentence;  axis: of the body
    """

    dependence: Dependence
    curve: Curve
    formula: Formula | None
    contrasts: tuple[Contrast, ...]
    graph: Graph
    axis: str

    @property
    def sentence(self) -> str:
        """The dependence in words, without a full stop."""
        return str(look(self, "sentence"))


@dataclass(frozen=True)
class BodyResidual:
    """Residual of the model on one body, described.

    error: relative force error on the check records (or blocks of the fit records, without these)
    floor: the error that sensors alone would leave
    after: error without the explained part, on rows where the body slides; `error` without
        dependences
    at_rest: part of the residual's squares on rows where no motion is certain
    dependences: dependences of the residual, largest first
    tests: of every dependence, best first;  views: name -> graph of the residual
    whiteness: None for a friction curve, whose points have no time
    """

    body: str
    axis: str
    error: float
    floor: float
    after: float
    at_rest: float
    dependences: tuple[DescribedDependence, ...]
    tests: tuple[Dependence, ...]
    whiteness: Whiteness | None
    views: Mapping[str, Graph]

    @property
    def floors(self) -> float:
        """Error as a multiple of the noise floor."""
        return self.error / self.floor if self.floor else float("inf")

    @property
    def is_adequate(self) -> bool:
        """Whether the residual is no larger than sensor noise."""
        return not self.dependences and self.floors <= CRITERIA.adequate


def describe_body(
    model: Model, prepared: Prepared, body: str, *, counted: float = 1.0, seed: int = 0
) -> BodyResidual:
    """Describe the force residual of a fitted model on one body.

    counted: part of the noise floor that counts, 0 to 1
    seed: of the random numbers for the noise floor
    """
    stretches = tuple(s for s in prepared.stretches if s.motion.body == body)
    of_body = replace(prepared, stretches=stretches)
    rows = rows_of(model, of_body, body)
    floor = counted * noise_floor(model, of_body, np.random.default_rng(seed)).value
    used = rows.checked
    weight = np.concatenate([np.full(len(a.stretch.keep), a.stretch.weight) for a in rows.alongs])
    whole = float(np.sum((weight * rows.measured**2)[used]))
    squares = float(np.sum((weight * rows.residual**2)[used]))
    resting = float(np.sum((weight * rows.residual**2)[used & (rows.root == 0)]))
    chosen, tests = dependences(rows, floor**2 * whole)
    whiteness = None if rows.is_curve else whiteness_of(rows)
    descriptions = _describe_dependences(rows, chosen)
    after = descriptions[-1].dependence.squares if descriptions else squares
    return BodyResidual(
        body=body,
        axis=rows.axis,
        error=float(np.sqrt(squares / whole)),
        floor=floor,
        after=float(np.sqrt(after / whole)),
        at_rest=resting / max(squares, 1e-300),
        dependences=descriptions,
        tests=tuple(without_columns(t) for t in tests),
        whiteness=whiteness,
        views=views_of(rows, whiteness),
    )


def _describe_dependences(
    rows: Rows, chosen: tuple[Dependence, ...]
) -> tuple[DescribedDependence, ...]:
    descriptions = []
    beside = model_columns(rows)
    target = rows.residual * rows.root
    for i, dependence in enumerate(chosen):
        curve = curve_of(rows, dependence, chosen[:i])
        formula = formula_for(rows, beside, dependence)
        left = target - beside.values @ beside.solve(target, rows.learnt)
        sides = contrasts(rows, dependence, left)
        if not _is_certain(dependence.shape, curve):
            break
        graph, axis = curve_graph(dependence.shape, curve, rows.axis), rows.axis
        descriptions.append(
            DescribedDependence(without_columns(dependence), curve, formula, sides, graph, axis)
        )
        beside = beside.beside(dependence.columns)
    return tuple(descriptions)


def _is_certain(shape: Shape, curve: Curve) -> bool:
    """Whether a dependence differs from zero by more than its band anywhere."""
    if shape.variable is None or shape.is_wave:
        return True
    return bool(regions_of(curve, signed=shape.variable.signed))
