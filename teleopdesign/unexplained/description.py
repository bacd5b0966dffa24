"""The description of one body: its rows, the dependences of its residual, and the sentences."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ..base.finding import Graph
from ..base.shown import look
from ..diagnose.criteria import CRITERIA
from ..diagnose.noise_floor import noise_floor
from ..measurement.prepare import Prepared
from ..model import Model
from .curve import Curve, curve_of, regions_of, without_columns
from .dependence import Contrast, Dependence, contrasts, dependences, model_columns
from .formula import Formula, formula_for
from .rows import Rows, rows_of
from .shapes import Shape
from .views import Whiteness, curve_graph, views_of, whiteness_of


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
