"""Where a model fails, and a description of the residual that no candidate explains."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..base.files import make_plain
from ..base.finding import Finding
from ..base.frozen import ByValue
from ..base.shown import Shown, figure_of, look
from ..base.units import unit_of
from ..diagnose.fit import Fit
from ..diagnose.noise_floor import NoiseFloor
from ..diagnose.stated_fit import estimate_stated
from ..measurement.experiment import Experiment
from ..measurement.prepare import Prepared, prepare
from ..model import Model
from .description import BodyResidual, DescribedDependence, describe_body
from .formula import formula_text

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
