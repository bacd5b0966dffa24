"""The law of a dependence as text, with the parameters that its file declares."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..base.units import unit_of
from ..measurement.filtering import Array
from .dependence import Dependence
from .formula import Formula, formula_text
from .library import FormulaTerm

#: largest deviation of the written line from f, relative to the largest f
EXACT = 0.01


@dataclass(frozen=True)
class LawText:
    """A law as text: f on u and p, with its parameters.

    parameters: lines of the file;  strengths: names of parameters that are zero if absent
    equation: f in words, for the docstring of the file
    """

    text: str
    parameters: tuple[str, ...]
    strengths: tuple[str, ...]
    equation: str


def _parameter(
    name: str, quantity: str, meaning: str, start: float, *, positive: bool = False
) -> str:
    lower = "" if positive else ' lower=-float("inf"),'
    return (
        f'        "{name}": Parameter(\n'
        f'            "{quantity}", "{meaning}",{lower}\n'
        f"            search=FitSearch(starts=({start:.7g},)),\n"
        f"        ),"
    )


def law_of_formula(formula: Formula, axis: str, unit: Mapping[str, float]) -> LawText:
    """The law of a formula, with its coefficients and numbers as parameters."""
    variable = formula.shape.variable
    assert variable is not None
    texts: list[str] = []
    lines: list[str] = []
    strengths: list[str] = []
    quantity = formula.shape.carrier.quantity
    for i, (term, value) in enumerate(formula.split()):
        mark = "" if i == 0 else "_2"
        strength = f"amplitude{mark}" if term.kind == "wave" else f"strength{mark}"
        strengths.append(strength)
        text, size, number_line = _term(term, value, strength, mark, variable.quantity, unit)
        texts.append(text)
        meaning = _meaning(term, _reach(variable.quantity, unit), variable.quantity, axis)
        lines.append(_parameter(strength, quantity, meaning, size / unit[quantity]))
        lines += number_line
    return LawText(" + ".join(texts), tuple(lines), tuple(strengths), formula_text(formula, axis))


def _reach(quantity: str, unit: Mapping[str, float]) -> float:
    """A round number of the record's scale: the strength is that of f at this value."""
    return 1.0 if quantity == "time" else float(f"{unit[quantity]:.1g}")


def _meaning(term: FormulaTerm, reach: float, quantity: str, axis: str) -> str:
    at = f"{reach:g} {unit_of(quantity, axis)}"
    words = {"power": f"size at u = {at}", "wave": "amplitude", "bell": "size at u = 0"}
    return words.get(term.kind, "size at u = 0" if term.kind == "decay" else f"size {at} further")


def _term(
    term: FormulaTerm,
    value: Array,
    strength: str,
    mark: str,
    quantity: str,
    unit: Mapping[str, float],
) -> tuple[str, float, list[str]]:
    """Text of a term, the value of its strength parameter, and lines of its other parameters."""
    n = term.number
    if term.kind == "power":
        return _power(term, float(value[0]), strength, quantity, unit)
    if term.kind == "wave":
        size, phase = math.hypot(*value), math.atan2(value[0], value[1])
        turns, kind = f"2 * pi * u / p.period{mark}", quantity
        name, start = f"period{mark}", 1.0 / n / unit[quantity]
        if quantity == "time":
            turns, kind = f"2 * pi * u * p.frequency{mark}", "frequency"
            name, start = f"frequency{mark}", n / unit["frequency"]
        lines = [
            _parameter(name, kind, "how often it repeats", start, positive=True),
            _parameter(f"phase{mark}", "angle", "phase at zero", phase),
        ]
        return f"p.{strength} * sin({turns} + p.phase{mark})", size, lines
    if term.kind in ("above", "below"):
        line = _parameter(f"start{mark}", quantity, "where it begins", n / unit[quantity])
        inside = f"u - p.start{mark}" if term.kind == "above" else f"p.start{mark} - u"
        reach = _reach(quantity, unit)
        return f"p.{strength} * Max(0, {inside}) / {reach:g}", float(value[0]) * reach, [line]
    if term.kind == "beyond":
        line = _parameter(
            f"limit{mark}", quantity, "size beyond which", n / unit[quantity], positive=True
        )
        reach = _reach(quantity, unit)
        inside = f"u - Max(-p.limit{mark}, Min(u, p.limit{mark}))"
        return f"p.{strength} * ({inside}) / {reach:g}", float(value[0]) * reach, [line]
    name = {"velocity": "speed", "time": "time_constant"}.get(quantity, "width") + mark
    line = _parameter(name, quantity, "over which it falls", n / unit[quantity], positive=True)
    power = " ** 2" if term.kind == "bell" else ""
    inside = f"(u / p.{name}){power}"
    return f"p.{strength} * exp(-{inside})", float(value[0]), [line]


def _power(
    term: FormulaTerm, value: float, strength: str, quantity: str, unit: Mapping[str, float]
) -> tuple[str, float, list[str]]:
    reach = _reach(quantity, unit)
    power = "" if term.number == 1 else f" ** {term.number:g}"
    return f"p.{strength} * (u / {reach:g}){power}", value * reach**term.number, []


def law_of_points(dependence: Dependence, axis: str, unit: Mapping[str, float]) -> LawText:
    """A law as a line between points, with its size as the only parameter; or a constant."""
    shape = dependence.shape
    quantity = shape.carrier.quantity
    values = dependence.coefficients
    largest = float(values[np.argmax(np.abs(values))])
    line = _parameter("strength", quantity, "where it is largest", largest / unit[quantity])
    if shape.variable is None:
        return LawText("p.strength", (line,), ("strength",), f"a constant {shape.carrier.name}")
    unit_x = unit_of(shape.variable.quantity, axis)
    form, knots = values / largest, dependence.knots
    equation = f"a line through {len(knots)} points over {shape.variable.name} ({unit_x})"
    if shape.variable.signed:
        half = len(knots)
        ahead, back = _line(knots, form[:half], "abs(u)"), _line(knots, -form[half:], "abs(u)")
        text = (
            f"p.strength * ((1 + now.direction) * ({ahead}) + (1 - now.direction) * ({back})) / 2"
        )
        return LawText(text, (line,), ("strength",), equation)
    if shape.of_command:
        form = form - np.interp(0.0, knots, form)
    return LawText(f"p.strength * ({_line(knots, form, 'u')})", (line,), ("strength",), equation)


def _line(knots: Array, values: Array, u: str) -> str:
    """Text of the line through these points, level beyond the outer ones."""
    kept = _select_points(knots, values)
    x, y = knots[kept], values[kept]
    slopes = np.concatenate([[0.0], np.diff(y) / np.diff(x), [0.0]])
    text = f"{y[0]:.5g}"
    for k, bend in zip(x, np.diff(slopes), strict=True):
        inside = f"{u} - {k:.6g}" if k >= 0 else f"{u} + {-k:.6g}"
        text += f"\n        {'+' if bend >= 0 else '-'} {abs(bend):.6g} * Max(0, {inside})"
    return text


def _select_points(knots: Array, values: Array) -> list[int]:
    """Indices of points through which a line deviates nowhere by more than `EXACT`."""
    kept, start = [0], 0
    for end in range(2, len(knots)):
        inner = slice(start + 1, end)
        line = np.interp(knots[inner], knots[[start, end]], values[[start, end]])
        if np.max(np.abs(line - values[inner])) > EXACT:
            start = end - 1
            kept.append(start)
    return [*kept, len(knots) - 1]
