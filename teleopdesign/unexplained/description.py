"""The description of one body: its rows, the dependences of its residual, and the sentences."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ..base.finding import Finding, Graph
from ..diagnose.criteria import CRITERIA
from ..diagnose.noise_floor import noise_floor
from ..measurement.prepare import Prepared
from ..model import Model
from .amounts import number
from .curve import Curve, curve_of, without_columns
from .dependence import ALARM, Dependence, dependences, model_columns
from .formula import Formula, formula_for
from .qualifiers import Contrast, contrasts
from .rows import Rows, rows_of
from .sentences import sentence_for
from .shapes import SHAPES
from .views import curve_graph, views_of
from .whiteness import Whiteness, whiteness_of

#: part of the residual that may remain undescribed without a remark: a description to first order,
#: with f as lines between knots, leaves a few percent anyway
UNDESCRIBED = 0.1
#: if at least this part of the residual lies where no motion is certain, the description says so
MOSTLY = 0.5


@dataclass(frozen=True)
class DescribedDependence:
    """One dependence with its curve, formula and sentence.

    curve: as in the residual;  formula: None where none with few terms holds
    contrasts: sizes in both directions, and after a rest or a reversal
    sentence: without its full stop;  graph: the figure of the sentence
    """

    dependence: Dependence
    curve: Curve
    formula: Formula | None
    contrasts: tuple[Contrast, ...]
    sentence: str
    graph: Graph


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
    """

    body: str
    axis: str
    error: float
    floor: float
    after: float
    at_rest: float
    dependences: tuple[DescribedDependence, ...]
    tests: tuple[Dependence, ...]
    whiteness: Whiteness
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
    whiteness = whiteness_of(rows)
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
        sentence = sentence_for(dependence.shape, curve, formula, sides, rows.axis)
        if not sentence:
            break
        graph = curve_graph(dependence.shape, curve, rows.axis)
        descriptions.append(
            DescribedDependence(without_columns(dependence), curve, formula, sides, sentence, graph)
        )
        beside = beside.beside(dependence.columns)
    return tuple(descriptions)


def findings_of(part: BodyResidual, *, name_body: bool) -> tuple[Finding, ...]:
    """The sentences about one body, each with its numbers and its graph."""
    where = part.body if name_body else ""
    numbers = {"error": part.error, "noise floor": part.floor, "noise floors": part.floors}
    error, floors = f"{100 * part.error:.2g} %", number(part.floors)
    time = part.views["time"]
    if part.is_adequate:
        sentence = f"the model leaves {error} of the force, no more than sensor noise would leave"
        return (Finding("what is left", "fine", f"{sentence}.", numbers, where, time),)
    sentence = (
        f"the model leaves {error} of the force, {floors} times what sensor noise would leave"
    )
    findings = [Finding("what is left", "warning", f"{sentence}.", numbers, where, time)]
    for one in part.dependences:
        findings.append(_finding(one, where))
    if part.floors > CRITERIA.adequate:
        findings += _rest(part, where)
    return tuple(findings)


def _finding(one: DescribedDependence, where: str) -> Finding:
    d = one.dependence
    numbers = {
        "explained": d.explained,
        "score": d.score,
        "probability of chance": d.probability,
        "largest": float(one.curve.y.max()),
        "smallest": float(one.curve.y.min()),
    }
    alike = ""
    if d.alike:
        listed = ", ".join(d.alike[:3]) + (", ..." if len(d.alike) > 3 else "")
        alike = f" (no better: {listed})"
    sentence = f"{one.sentence}. That is {100 * d.explained:.0f} % of what is left{alike}."
    topic = f"dependence: {d.shape.name}"
    return Finding(topic, "warning", sentence[0].upper() + sentence[1:], numbers, where, one.graph)


def _rest(part: BodyResidual, where: str) -> list[Finding]:
    """Findings on the remaining residual: its frequencies, correlation in time, and size."""
    low, high = part.whiteness.band
    numbers = {"low": low, "high": high, "probability of chance": part.whiteness.probability}
    sentence = f"Half of what is left lies between {number(low)} and {number(high)} Hz"
    if low < 1.0:  # the first band
        sentence = f"Three quarters of what is left lies below {number(max(high, 1.0))} Hz"
    if part.whiteness.probability < ALARM:
        largest = int(np.argmax(np.abs(part.whiteness.correlation) / part.whiteness.noise))
        lag, r = part.whiteness.lag[largest], part.whiteness.correlation[largest]
        numbers |= {"lag": float(lag), "correlation": float(r)}
        sentence += f"; its autocorrelation at {number(1e3 * lag)} ms is {r:.2f}"
        sentence += ", unlike sensor noise"
    findings = [
        Finding("frequency", "note", f"{sentence}.", numbers, where, part.views["frequency"])
    ]
    if part.at_rest > MOSTLY:
        sentence = f"{100 * part.at_rest:.0f} % of the residual lies where no motion can be seen."
        velocity = part.views["velocity"]
        findings.append(Finding("rest", "note", sentence, {"share": part.at_rest}, where, velocity))
    floors = part.after / part.floor if part.floor else float("inf")
    if floors > CRITERIA.adequate and part.after**2 > UNDESCRIBED * part.error**2:
        what = "Beside that" if part.dependences else f"None of {len(SHAPES)} dependences is sure:"
        verb = f"{number(floors)} times the sensors' noise"
        sentence = (
            f"{what}, {verb} stays undescribed."
            if part.dependences
            else f"{what} {verb} stay undescribed."
        )
        findings.append(
            Finding(
                "undescribed", "note", sentence, {"noise floors": floors}, where, part.views["time"]
            )
        )
    return findings
