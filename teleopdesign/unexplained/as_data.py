"""The description of a residual as plain data, for a JSON file."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..base.files import make_plain
from ..base.units import unit_of
from .description import BodyResidual, DescribedDependence
from .sentences import formula_text

if TYPE_CHECKING:
    from . import ResidualDescription


def as_data(description: ResidualDescription) -> dict[str, Any]:
    """Sentences, dependences with curves, and every test; SI units."""
    data = {
        "findings": [
            {
                "topic": f.topic,
                "concern": f.concern,
                "where": f.where,
                "sentence": f.sentence,
                "numbers": dict(f.numbers),
            }
            for f in description.findings
        ],
        "bodies": [_body(p) for p in description.parts],
    }
    content: dict[str, Any] = make_plain(data)
    return content


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
        "whiteness": {
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
