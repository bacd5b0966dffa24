"""A dependence as an effect file, in the form of `teleopdesign/effects`.

With a formula, its coefficients and numbers are the parameters to be estimated. Otherwise the form
of the curve is written as numbers, and only its size is estimated.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ..base.errors import ModelError
from ..base.files import write_text
from ..base.sentences import span
from ..base.units import unit_of
from ..measurement.bandwidth import scales
from ..measurement.filtering import Array
from ..measurement.prepare import Prepared
from .dependence import Dependence
from .formula import Formula, formula_text
from .library import FormulaTerm
from .result import BodyResidual, DescribedDependence
from .shapes import COMMAND, FRICTION, LATENESS, LOST, Shape

#: variable -> signal of a law; laws have no signal for other variables
SIGNALS = {
    "position": "now.position",
    "speed": "abs(now.velocity)",
    "velocity": "now.velocity",
    "acceleration": "now.acceleration",
    "actuator_force": "now.acting_force",
    "load": "abs(now.acting_force)",
    "interaction_force": "now.interaction_force",
    "time": "now.time",
}
#: largest deviation of the written line from f, relative to the largest f
EXACT = 0.01
#: text of f on u and p, lines of its parameters, names of those that are zero if absent, f in words
_Law = tuple[str, tuple[str, ...], tuple[str, ...], str]
_HEAD = '''"""{title}

    {equation}

{where}

{source}
"""

{names}from teleopdesign.effects import Effect, FitSearch, Parameter


def law(now, p):
    {law}


EFFECT = Effect(
    role="{role}",
    law=law,
    parameters={{
{parameters}
    }},
    absent={{{absent}}},
    source="described from a recording",
)
'''


def write_effect(
    path: str | Path, part: BodyResidual, described: DescribedDependence, prepared: Prepared
) -> None:
    """Write the effect file of a dependence; the file's name becomes the effect's name.

    raises ModelError: no law can express the dependence, or the name is no name of an effect
    """
    path = Path(path)
    if not path.stem.isidentifier() or path.suffix != ".py":
        raise ModelError(f'{path}: the file name "{path.name}" must be a name such as my_effect.py')
    text = effect_text(part, described, prepared)
    write_text(path, text)


def effect_text(part: BodyResidual, described: DescribedDependence, prepared: Prepared) -> str:
    """The effect file as text.

    raises ModelError: no law can express the dependence
    """
    shape, formula = described.dependence.shape, described.formula
    variable = shape.variable
    lacks = "earlier command" if shape.carrier == LATENESS else ""
    if variable is not None and variable.name not in SIGNALS:
        lacks = lacks or variable.name.replace("_", " ")
    if lacks:
        raise ModelError(
            f'describe: "{shape.name}" cannot be written as an effect file: a law knows no '
            f"{lacks}; see `teleopdesign effects` for those with a memory, such as presliding"
        )
    unit = scales([s.motion for s in prepared.of("fit")], prepared.bandwidth)
    if variable is None or formula is None:
        law = _law_of_points(described.dependence, part.axis, unit)
    else:
        law = _law_of_formula(formula, part.axis, unit)
    text, parameters, strengths, equation = law
    sentence = described.sentence
    share = f"{100 * described.dependence.explained:.0f} %"
    return _HEAD.format(
        title=_docstring_line(
            shape.name[0].upper() + shape.name[1:] + ", as described from a recording."
        ),
        equation=equation,
        where=_docstring_line(
            f"{sentence[:1].upper()}{sentence[1:]}. {_known_range(part, described)}".strip()
        ),
        source=_docstring_line(
            f'Described by `teleopdesign describe` from "{prepared.experiment.title}": it explains '
            f"{share} of what was left there."
        ),
        names=_names(text),
        law=_return_statement(shape, text),
        role=_role(shape),
        parameters="\n".join(parameters),
        absent=", ".join(f'"{s}": 0.0' for s in strengths),
    )


def _known_range(part: BodyResidual, described: DescribedDependence) -> str:
    """A sentence on the range of the variable in the records; "" without a variable."""
    variable, x = described.dependence.shape.variable, described.curve.x
    if variable is None:
        return ""
    name = variable.name.replace("_", " ")
    ends = span(float(x[0]), float(x[-1]), variable.quantity, part.axis)
    return f"Known for {name} between {ends}."


def _role(shape: Shape) -> str:
    if shape.of_command:
        return "actuation"
    # a branch for each direction opposes the motion, as friction does, also where it sticks
    signed = shape.variable is not None and shape.variable.signed
    return "friction_level" if shape.carrier == FRICTION or signed else "force"


def _return_statement(shape: Shape, law: str) -> str:
    variable = shape.variable
    assignment = f"u = {SIGNALS[variable.name]}\n    " if variable is not None else ""
    if shape.of_command and variable == COMMAND:
        assignment = "u = now.command\n    "
    factor = f" * now.{shape.carrier.signal}" if shape.carrier.signal else ""
    if shape.carrier == LOST:
        return f"{assignment}return now.command * (1 - ({law}))"
    if shape.of_command:
        return f"{assignment}return now.command - ({law})"
    return f"{assignment}return ({law}){factor}" if factor else f"{assignment}return {law}"


def _names(law: str) -> str:
    names = ("Max", "Min", "exp", "pi", "sin")
    used = [n for n in names if f"{n}(" in law or f"{n} *" in law]
    return f"from sympy import {', '.join(used)}\n\n" if used else ""


def _docstring_line(text: str) -> str:
    """The text in a form that is safe in a docstring: it cannot end it, or begin an escape.

    It contains titles and file names, which may hold any characters.
    """
    plain = "".join(c if c.isprintable() else " " for c in text)
    plain = plain.replace("\\", "/").replace('"', "'")
    return "\n".join(textwrap.wrap(plain, 96))


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


def _law_of_formula(formula: Formula, axis: str, unit: Mapping[str, float]) -> _Law:
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
    return " + ".join(texts), tuple(lines), tuple(strengths), formula_text(formula, axis)


def _reach(quantity: str, unit: Mapping[str, float]) -> float:
    """A round number of the record's scale: the strength is that of f at this value."""
    return 1.0 if quantity == "time" else float(f"{unit[quantity]:.1g}")


def _meaning(term: FormulaTerm, reach: float, quantity: str, axis: str) -> str:
    at = f"{reach:g} {unit_of(quantity, axis)}"
    words = {"power": f"size at u = {at}", "wave": "amplitude", "bell": "size at u = 0"}
    return words.get(term.kind, "size at u = 0" if term.kind == "decay" else f"size {at} further")


#: kind of a term that grows beyond its number -> the number's name and meaning, and the growth
_RAMPS = {
    "above": ("start", "where it begins", "u - p.{0}"),
    "below": ("start", "where it begins", "p.{0} - u"),
    "beyond": ("limit", "size beyond which", "u - Max(-p.{0}, Min(u, p.{0}))"),
}


def _term(
    term: FormulaTerm,
    value: Array,
    strength: str,
    mark: str,
    quantity: str,
    unit: Mapping[str, float],
) -> tuple[str, float, list[str]]:
    """Text of a term, the value of its strength parameter, and lines of its other parameters."""
    n, reach = term.number, _reach(quantity, unit)
    if term.kind == "power":
        power = "" if n == 1 else f" ** {n:g}"
        return f"p.{strength} * (u / {reach:g}){power}", float(value[0]) * reach**n, []
    if term.kind == "wave":
        size, phase = math.hypot(*value), math.atan2(value[0], value[1])
        name, kind, start = f"period{mark}", quantity, 1.0 / n / unit[quantity]
        turns = f"2 * pi * u / p.{name}"
        if quantity == "time":
            name, kind, start = f"frequency{mark}", "frequency", n / unit["frequency"]
            turns = f"2 * pi * u * p.{name}"
        lines = [
            _parameter(name, kind, "how often it repeats", start, positive=True),
            _parameter(f"phase{mark}", "angle", "phase at zero", phase),
        ]
        return f"p.{strength} * sin({turns} + p.phase{mark})", size, lines
    if term.kind in _RAMPS:
        name, meaning, growth = _RAMPS[term.kind]
        is_size = term.kind == "beyond"
        line = _parameter(f"{name}{mark}", quantity, meaning, n / unit[quantity], positive=is_size)
        inside = growth.format(f"{name}{mark}")
        inside = f"({inside})" if is_size else f"Max(0, {inside})"
        return f"p.{strength} * {inside} / {reach:g}", float(value[0]) * reach, [line]
    name = {"velocity": "speed", "time": "time_constant"}.get(quantity, "width") + mark
    line = _parameter(name, quantity, "over which it falls", n / unit[quantity], positive=True)
    power = " ** 2" if term.kind == "bell" else ""
    return f"p.{strength} * exp(-(u / p.{name}){power})", float(value[0]), [line]


def _law_of_points(dependence: Dependence, axis: str, unit: Mapping[str, float]) -> _Law:
    """A law as a line between points, with its size as the only parameter; or a constant."""
    shape = dependence.shape
    quantity = shape.carrier.quantity
    values = dependence.coefficients
    largest = float(values[np.argmax(np.abs(values))])
    line = _parameter("strength", quantity, "where it is largest", largest / unit[quantity])
    if shape.variable is None:
        return "p.strength", (line,), ("strength",), f"a constant {shape.carrier.name}"
    unit_x = unit_of(shape.variable.quantity, axis)
    form, knots = values / largest, dependence.knots
    equation = f"a line through {len(knots)} points over {shape.variable.name} ({unit_x})"
    if shape.variable.signed:
        half = len(knots)
        ahead, back = _line(knots, form[:half], "abs(u)"), _line(knots, -form[half:], "abs(u)")
        text = (
            f"p.strength * ((1 + now.direction) * ({ahead}) + (1 - now.direction) * ({back})) / 2"
        )
        return text, (line,), ("strength",), equation
    if shape.of_command:
        form = form - np.interp(0.0, knots, form)
    return (f"p.strength * ({_line(knots, form, 'u')})", (line,), ("strength",), equation)


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
