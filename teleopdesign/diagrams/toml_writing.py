"""A diagram as a TOML file, from which `read_diagram` reads the same diagram.

Expressions of positions as the text that `read_expression` reads.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import sympy as sp
from sympy.printing.str import StrPrinter

from ..base.errors import ExperimentError, ModelError, quote
from ..base.files import write_text
from ..base.toml import inline_text, key_text, string_text
from ..blocks import Body, Value, with_block_effects
from ..controllers import CANCEL, CONTROLLERS, ControlLaw, Controller, Stage, cancelling_law
from ..effects import Effect
from .expressions import read_expression
from .junctions import Junction, Kinematics
from .parts import AnyBlock, Attached, Block, Control, Linked, Moving
from .short_form import kind_of
from .toml_matrices import MATRICES
from .toml_reading import ROLES_BY_NAME
from .wiring import Diagram


def write_diagram(
    diagram: Diagram,
    path: str | Path,
    *,
    effects: Mapping[str, Effect] | None = None,
    laws: Mapping[str, ControlLaw] | None = None,
) -> None:
    """Write a diagram as a TOML file, in SI units.

    If the package knows the wiring, the file states only the blocks.

    effects, laws: effects and control laws that the reader of the file will know, as in
        `read_diagram`
    raises ModelError: an effect of a body or a law differs from the known one of that name, an
        expression has functions that a file must not have

        >>> device = td.hand(mass=0.2, damping=2.0, stiffness=0.0)
        >>> td.write_diagram(td.haptic_interface(device), "interface.toml")
    """
    text = diagram_text(diagram, effects=effects, laws=laws)
    write_text(path, text)


def diagram_text(
    diagram: Diagram,
    *,
    effects: Mapping[str, Effect] | None = None,
    laws: Mapping[str, ControlLaw] | None = None,
) -> str:
    """The text of the file that `write_diagram` writes."""
    kind, known = kind_of(diagram), with_block_effects(effects)
    lines = ["[diagram]"]
    if kind is not None:
        lines += [f"kind = {string_text(kind)}"]
    else:
        lines += [f"name = {string_text(diagram.name)}"]
        lines += [f"measured = {_list(diagram.measured)}"]
        lines += _table("outside", diagram.outside)
    for block in diagram.blocks:
        lines += ["", f"[blocks.{key_text(block.name)}]"]
        lines += [] if kind is not None else _wiring_lines(block)
        if isinstance(block, Control):
            lines += ["analog = true"] if block.analog else []
            lines += _laws(block, CONTROLLERS if laws is None else laws, known)
        elif not isinstance(block, Linked):
            lines += _body(block.name, block.body, known)
    if kind is None:
        lines += _table("kinematics", {k.output: _where(k) for k in diagram.kinematics})
        lines += _table("junctions", {j.output: _terms(j) for j in diagram.junctions})
        lines += _table("pose", diagram.pose)
        lines += _table("texts", diagram.texts)
    return "\n".join(lines) + "\n"


def _terms(junction: Junction) -> dict[str, Any]:
    """Weights as numbers, or as texts of expressions."""
    return {
        signal: expression_text(weight, name=f"{junction.name}: {signal}")
        if isinstance(weight, sp.Expr)
        else weight
        for signal, weight in junction.terms.items()
    }


def _where(kinematics: Kinematics) -> Any:
    text = expression_text(sp.sympify(kinematics.expression, strict=True), name=kinematics.name)
    if kinematics.axis == "prismatic":
        return text
    return {"expression": text, "axis": kinematics.axis}


def _table(name: str, content: Mapping[str, Any]) -> list[str]:
    if not content:
        return []
    return ["", f"[{name}]", *(f"{key_text(k)} = {_value(v)}" for k, v in content.items())]


def _wiring_lines(block: Block) -> list[str]:
    if isinstance(block, Moving):
        keys: dict[str, Any] = {"kind": "moving", "motion": block.motion, "command": block.command}
        keys |= {"loads": block.loads, "driver": block.driver}
    elif isinstance(block, Attached):
        keys = {"kind": "attached", "motion": block.motion, "force": block.force}
        keys |= {"sign": block.sign}
    elif isinstance(block, Linked):
        keys = {"kind": "linked", "motions": block.motions, "forces": block.forces}
        keys |= {"sign": block.sign}
        matrices = {name: getattr(block.body, name) for name in MATRICES}
        keys |= {name: rows for name, rows in matrices.items() if any(map(any, rows))}
    else:
        assert isinstance(block, Control)
        keys = {"kind": "control", "input": block.input, "output": block.output}
        keys |= {"motion": block.motion} if block.motion else {}
        keys |= {"others": block.others} if block.others else {}
    keys |= {"role": block.role} if isinstance(block, Attached | Linked) and _states(block) else {}
    return [f"{k} = {_value(v)}" for k, v in keys.items()]


def _states(block: Attached | Linked) -> bool:
    """Whether a file must state the role: names that older files had for roles need it always."""
    return block.role != "part" or block.name in ROLES_BY_NAME


def _body(name: str, body: Body | AnyBlock, known: Mapping[str, Effect]) -> list[str]:
    if isinstance(body, AnyBlock):
        return []
    for effect in body.effects:
        if known.get(effect.name) is not effect:
            raise ModelError(f'{name}: effect "{effect.name}" is not the one known by that name')
    return body_lines(f"blocks.{key_text(name)}", body)


def body_lines(table: str, body: Body) -> list[str]:
    """The lines of a body below [table], in SI.

    table: name of the table: `model.device`, or `blocks.M` of a diagram
    """
    lines = [f"axis = {string_text(body.axis)}", f"inertia = {_value(body.parameters['inertia'])}"]
    for effect in body.effects:
        lines += [f"[{table}.effects.{key_text(effect.name)}]"]
        values = ((p, body.parameters[f"{effect.name}.{p}"]) for p in effect.parameters)
        lines += [f"{p} = {_value(value)}" for p, value in values]
    return lines


def _is_known(stage: Stage, laws: Mapping[str, ControlLaw], effects: Mapping[str, Effect]) -> bool:
    name = stage.law.name
    if name == CANCEL:
        return cancelling_law(tuple(stage.law.parameters), effects) is stage.law
    return laws.get(name) is stage.law


def _laws(
    block: Control, laws: Mapping[str, ControlLaw], effects: Mapping[str, Effect]
) -> Iterator[str]:
    if not isinstance(block.controller, Controller):
        return
    stages = block.controller.stages
    for stage in stages:
        if not _is_known(stage, laws, effects):
            raise ModelError(
                f'{block.name}: law "{stage.law.name}" is none of the package: name your file to '
                'writer and reader, laws=controllers.catalogue(["my_law.py"]); a system of '
                "python-control has no form in a file"
            )
        if len(stages) > 1:
            yield f"[[blocks.{key_text(block.name)}.series]]"
        yield f"law = {string_text(stage.law.name)}"
        free = {n: {"value": stage.values[n], "fixed": False} for n in stage.free}
        yield f"parameters = {_value({**stage.values, **free})}"


def _value(value: object) -> str:
    if isinstance(value, str):
        return string_text(value)
    if isinstance(value, Mapping):
        return inline_text({key_text(k): _value(v) for k, v in value.items()})
    if isinstance(value, Value):
        return _number_with_marks(value)
    if isinstance(value, tuple):
        return _list(value)
    if isinstance(value, bool):
        return str(value).lower()
    return repr(value) if isinstance(value, int) else repr(float(value))  # type: ignore[arg-type]


def _list(values: Iterable[object]) -> str:
    return f"[{', '.join(map(_value, values))}]"


def _number_with_marks(value: Value) -> str:
    if not value.fixed and math.isnan(value.stderr):
        return _value(value.value)
    parts = {"value": _value(value.value)}
    parts |= {"fixed": "true"} if value.fixed else {}
    parts |= {} if math.isnan(value.stderr) else {"stderr": _value(value.stderr)}
    return inline_text(parts)


class _Printer(StrPrinter):
    """Prints like sympy, but floats with all their digits."""

    def _print_Float(self, expr: sp.Float) -> str:
        return repr(float(expr))

    def _print_Abs(self, expr: sp.Abs) -> str:
        return f"abs({self._print(expr.args[0])})"

    def _print_Exp1(self, expr: sp.Expr) -> str:
        return "exp(1)"


def expression_text(expression: sp.Expr, *, name: str) -> str:
    """Text that `read_expression` reads as the same expression.

    name: of the part, for the message
    raises ModelError: there is no such text, because of other functions or unusual names
    """
    text = str(_Printer().doprint(expression))
    try:
        same = read_expression(text, where=name) == expression
    except ExperimentError as error:
        raise ModelError(f"{error}: it has no form in a file") from None
    if not same:
        raise ModelError(f"{name}: {quote(text)} has no form in a file: it reads as another")
    return text
