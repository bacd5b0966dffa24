"""Where a model fails, and a description of the residual that no candidate explains.

description = describe_residual(model, prepared)
description.findings    sentences, each with its numbers and its graph
description.parts       per body: views, tests, curves with bands, formulas
description.plot()      the views and the dependences
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..base.arguments import check_arguments
from ..base.by_value import ByValue
from ..base.finding import Finding
from ..diagnose.fit import Fit
from ..diagnose.noise_floor import NoiseFloor
from ..diagnose.stated_fit import estimate_stated
from ..measurement.experiment import Experiment
from ..measurement.prepare import Prepared, prepare
from ..model import Model
from .description import BodyResidual, DescribedDependence, describe_body, findings_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = [
    "BodyResidual",
    "DescribedDependence",
    "ResidualDescription",
    "describe",
    "describe_residual",
    "where_it_fails",
]


@dataclass(frozen=True, eq=False)
class ResidualDescription(ByValue):
    """Residual of a fitted model on every body, and the signals that it depends on.

    parts: one per body
    """

    model: Model
    prepared: Prepared
    parts: tuple[BodyResidual, ...]

    @property
    def findings(self) -> tuple[Finding, ...]:
        """The sentences, each with its numbers and its graph."""
        many = len(self.parts) > 1
        return tuple(f for p in self.parts for f in findings_of(p, name_body=many))

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
        from ..show.figures.unexplained import plot_unexplained

        return plot_unexplained(self)

    def as_data(self) -> dict[str, Any]:
        """The findings as plain data, SI units."""
        from .as_data import as_data

        return as_data(self)

    def __repr__(self) -> str:
        return "\n".join(str(f) for f in self.findings)


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


check_arguments(globals(), __all__)
