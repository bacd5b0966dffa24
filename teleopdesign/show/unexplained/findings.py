"""Where a model fails: sentences on each body, each with its numbers and its graph."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...base.finding import Finding
from ...base.sentences import number, percent
from ...diagnose.criteria import CRITERIA
from ...unexplained.dependence import ALARM
from ...unexplained.shapes import SHAPES
from ..registry import shows

if TYPE_CHECKING:
    from ...unexplained import BodyResidual, DescribedDependence, ResidualDescription

#: part of the residual that may remain undescribed without a remark: a description to first order,
#: with f as lines between knots, leaves a few percent anyway
UNDESCRIBED = 0.1
#: if at least this part of the residual lies where no motion is certain, the description says so
MOSTLY = 0.5


@shows("text")
def description_text(description: ResidualDescription) -> str:
    """A line for each finding."""
    return "\n".join(map(str, description.findings))


@shows("findings")
def findings_of(description: ResidualDescription) -> tuple[Finding, ...]:
    """The sentences on all bodies."""
    many = len(description.parts) > 1
    return tuple(f for p in description.parts for f in _findings_on(p, name_body=many))


def _findings_on(part: BodyResidual, *, name_body: bool) -> tuple[Finding, ...]:
    """The sentences about one body, each with its numbers and its graph."""
    where = part.body if name_body else ""
    numbers = {"error": part.error, "noise floor": part.floor, "noise floors": part.floors}
    error, floors = percent(part.error, ".2g"), number(part.floors)
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
    share = percent(d.explained, ".0f")
    sentence = f"{one.sentence}. That is {share} of what is left{alike}."
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
        share = percent(part.at_rest, ".0f")
        sentence = f"{share} of the residual lies where no motion can be seen."
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
