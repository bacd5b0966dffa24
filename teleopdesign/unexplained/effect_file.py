"""A dependence as an effect file, in the form of `teleopdesign/effects`.

With a formula, its coefficients and numbers are the parameters to be estimated. Otherwise the form
of the curve is written as numbers, and only its size is estimated.
"""

from __future__ import annotations

import textwrap
from pathlib import Path

from ..base.errors import ModelError
from ..base.files import write_text
from ..base.sentences import span
from ..measurement.bandwidth import scales
from ..measurement.prepare import Prepared
from .effect_law import law_of_formula, law_of_points
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
#: carrier -> text of the factor of f in a law
FACTORS = {"damping": " * now.velocity", "mass": " * now.acceleration"}
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
    if shape.carrier == LATENESS or (variable is not None and variable.name not in SIGNALS):
        raise ModelError(
            f'describe: "{shape.name}" cannot be written as an effect file: a law knows no '
            f"{'earlier command' if shape.carrier == LATENESS else variable_words(shape)}; see "
            "`teleopdesign effects` for those with a memory, such as presliding"
        )
    unit = scales([s.motion for s in prepared.of("fit")], prepared.bandwidth)
    if variable is None or formula is None:
        law = law_of_points(described.dependence, part.axis, unit)
    else:
        law = law_of_formula(formula, part.axis, unit)
    share = f"{100 * described.dependence.explained:.0f} %"
    return _HEAD.format(
        title=_docstring_line(
            shape.name[0].upper() + shape.name[1:] + ", as described from a recording."
        ),
        equation=law.equation,
        where=_docstring_line(
            f"{capitalise(described.sentence)}. {_known_range(part, described)}".strip()
        ),
        source=_docstring_line(
            f'Described by `teleopdesign describe` from "{prepared.experiment.title}": it explains '
            f"{share} of what was left there."
        ),
        names=_names(law.text),
        law=_return_statement(shape, law.text),
        role=_role(shape),
        parameters="\n".join(law.parameters),
        absent=", ".join(f'"{s}": 0.0' for s in law.strengths),
    )


def capitalise(sentence: str) -> str:
    """The sentence with a capital letter."""
    return sentence[:1].upper() + sentence[1:]


def _known_range(part: BodyResidual, described: DescribedDependence) -> str:
    """A sentence on the range of the variable in the records; "" without a variable."""
    variable, x = described.dependence.shape.variable, described.curve.x
    if variable is None:
        return ""
    name = variable.name.replace("_", " ")
    ends = span(float(x[0]), float(x[-1]), variable.quantity, part.axis)
    return f"Known for {name} between {ends}."


def variable_words(shape: Shape) -> str:
    """The variable in words, for a message."""
    return "" if shape.variable is None else shape.variable.name.replace("_", " ")


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
    factor = FACTORS.get(shape.carrier.name, "")
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
