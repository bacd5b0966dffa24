"""A dependence in one plain sentence, made from its numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ...base.sentences import amount, number, span
from ...unexplained.curve import Curve, SignRegion, goes_up_and_down, largest_regions, regions_of
from ...unexplained.dependence import Contrast
from ...unexplained.formula import Formula, formula_text
from ...unexplained.shapes import DAMPING, FORCE, FRICTION, LATENESS, LOST, MASS, Shape, Variable
from ..registry import shows

if TYPE_CHECKING:
    from ...unexplained.result import DescribedDependence

#: ratio of the sizes on two sides from which the text states a difference
UNLIKE = 1.5
#: words before a range, except for a plain "below 4 mm/s"
_PLACES = {
    "position": "at positions ",
    "acceleration": "at accelerations ",
    "actuator_force": "at commands ",
    "load": "where the command's size is ",
    "interaction_force": "at interaction forces ",
}
_AFTER = {
    "time": " of a record",
    "since_reversal": " after it sets off",
    "travel": " of travel after it sets off",
}


def place(region: SignRegion, variable: Variable, axis: str) -> str:
    """The range in words: "below 4 mm/s", "within 30 ms after it sets off"."""
    low, high = region.low, region.high
    if variable.signed:
        if region.backward:
            low, high = -high, -low
        way = "backward" if region.backward else "forward"
        inner = replace(region, low=low, high=high)
        return f"moving {way} {_range(inner, variable, axis)}".rstrip()
    if (after := _AFTER.get(variable.name)) is not None:
        first = "in the first" if variable.name == "time" else "within"
        words = f"between {{}}{after}", f"{first} {{}}{after}", f"from {{}}{after} on"
        return _range(region, variable, axis, words) or "throughout"
    over = _range(region, variable, axis)
    return _PLACES.get(variable.name, "") + over if over else "throughout"


def _range(
    region: SignRegion,
    variable: Variable,
    axis: str,
    words: tuple[str, str, str] = ("between {}", "below {}", "above {}"),
) -> str:
    """A range in words: those with both ends, with a high and with a low end; "": everywhere."""
    q = variable.quantity
    if math.isfinite(region.low) and math.isfinite(region.high):
        return words[0].format(span(region.low, region.high, q, axis))
    if math.isfinite(region.high):
        return words[1].format(amount(region.high, q, axis))
    return words[2].format(amount(region.low, q, axis)) if math.isfinite(region.low) else ""


def _size(value: float, shape: Shape, axis: str, *, backward: bool = False) -> str:
    """The difference in force, in the words of the carrier."""
    carrier = shape.carrier
    if backward:  # there, more is against the motion
        value = -value
    size = amount(abs(value), carrier.quantity, axis)
    more = "more" if value > 0 else "less"
    if carrier in (FORCE, FRICTION):
        return f"{size} {more}"
    if carrier == DAMPING:
        return f"{size} {more} damping"
    if carrier == MASS:
        return f"{size} {more} moving mass"
    if carrier == LOST:
        return f"{size} of the command {'fails to arrive' if value > 0 else 'arrives in excess'}"
    return f"{size} {'later' if value > 0 else 'earlier'}"


@shows("sentence")
def sentence_of(one: DescribedDependence) -> str:
    """The sentence, without its full stop."""
    shape, curve, formula = one.dependence.shape, one.curve, one.formula
    return sentence_for(shape, curve, formula, one.contrasts, one.axis)


def sentence_for(
    shape: Shape, curve: Curve, formula: Formula | None, contrasts: Sequence[Contrast], axis: str
) -> str:
    """The sentence on a dependence, without its full stop; "" where no range surely differs."""
    if shape.variable is None:
        return _constant(shape, float(curve.y[0]), axis)
    regions = regions_of(curve, signed=shape.variable.signed)
    wave = formula is not None and len(formula.terms) == 1 and formula.terms[0].kind == "wave"
    if shape.is_wave or (wave and len(largest_regions(regions)) > 2):
        assert formula is not None
        sentence = _wave(shape, formula, axis)
    elif goes_up_and_down(regions) and shape.variable.name in ("position", "time"):
        half = amount(0.5 * float(np.ptp(curve.y)), shape.carrier.quantity, axis)
        over = "along the travel" if shape.variable.name == "position" else "in time"
        sentence = f"{_subject(shape)} goes up and down {over}, by {half} to either side"
    elif regions:
        sentence = _ranges(shape, regions, axis)
    else:
        return ""
    following = "" if formula is None else f"; it follows {formula_text(formula, axis)}"
    return sentence + _qualify(shape, contrasts) + following


def _ranges(shape: Shape, regions: Sequence[SignRegion], axis: str) -> str:
    assert shape.variable is not None
    parts = []
    for i, region in enumerate(largest_regions(tuple(regions))):
        backward = shape.variable.signed and region.backward
        where = place(region, shape.variable, axis)
        size = _size(region.extreme, shape, axis, backward=backward)
        parts.append((where or "everywhere", size, i))
    if shape.carrier == LOST:
        return " and ".join(f"{where} up to {size}" for where, size, _ in parts)
    need = "the device needs" if shape.carrier != LATENESS else "the command acts"
    sentence = ""
    for where, size, i in parts:
        if i == 0:
            sentence = f"{where} {need} up to {size} than the model"
        else:
            sentence += f", {where} up to {size}"
    if shape.carrier == FORCE and not shape.variable.signed:
        sentence += " (counted in the positive direction)"
    return sentence


def _subject(shape: Shape) -> str:
    return {
        "force": "the force that the model lacks",
        "friction": "the friction that the model lacks",
        "damping": "the damping that the model lacks",
        "mass": "the moving mass that the model lacks",
        "lost command": "the part of the command that arrives",
        "lateness": "the lateness of the command",
    }[shape.carrier.name]


def _wave(shape: Shape, formula: Formula, axis: str) -> str:
    assert shape.variable is not None
    size = math.hypot(*formula.coefficients)
    half = amount(size, shape.carrier.quantity, axis)
    k = formula.terms[0].number
    if shape.variable.name == "time":
        every = f"at {k:.3g} Hz"
    else:
        every = f"every {amount(1.0 / k, shape.variable.quantity, axis)} of travel"
    return f"{_subject(shape)} goes up and down {every}, by {half} to either side"


def _constant(shape: Shape, value: float, axis: str) -> str:
    size = _size(value, shape, axis)
    if shape.carrier == FORCE:
        twice = amount(2 * abs(value), "force", axis)
        return (
            f"everywhere the device needs {size} than the model (counted in the positive "
            f"direction): a constant force, or friction that differs by {twice} between directions"
        )
    if shape.carrier == FRICTION:
        return f"at all speeds the device needs {size} than the model, in both directions"
    if shape.carrier == LOST:
        return f"everywhere {size}"
    if shape.carrier == LATENESS:
        return f"the command acts {size} than the model says"
    return f"everywhere the device needs {size} than the model"


def _qualify(shape: Shape, contrasts: Sequence[Contrast]) -> str:
    words = ""
    signed = shape.variable is not None and shape.variable.signed
    for contrast in contrasts:
        directions = "forward" in contrast.sides
        if directions and signed:  # the ranges say it
            continue
        if contrast.only:
            words += f", only {'moving ' if directions else ''}{contrast.only}"
        elif contrast.differs and min(contrast.sizes) > 0:
            strong = int(contrast.sizes[1] > contrast.sizes[0])
            ratio = contrast.sizes[strong] / contrast.sizes[1 - strong]
            if ratio > UNLIKE:
                words += f", {number(float(ratio))} times as much {contrast.sides[strong]}"
        elif directions and shape.carrier == FRICTION:
            words += ", in both directions"
    return words
