"""A diagram as a TOML file that `read_diagram` reads back as the same diagram."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from ..blocks import Body, Value
from ..controllers import Controller
from ..effects import EFFECTS
from ..errors import ModelError
from .parts import AnyBlock, Attached, Block, Control, Linked, Moving
from .short_form import kind_of
from .wiring import Diagram


def write_diagram(diagram: Diagram, path: str | Path) -> None:
    """Write a diagram, in SI; with its blocks only where the wiring is one of the package's own.

    raises ModelError: an effect of a body is another than the catalogue's of that name
    """
    Path(path).write_text(diagram_text(diagram), encoding="utf-8", newline="\n")


def diagram_text(diagram: Diagram) -> str:
    """The content of the file."""
    joined = [b.name for b in diagram.blocks if isinstance(b, Linked)]
    joined += [k.name for k in diagram.kinematics]
    joined += [j.name for j in diagram.junctions if j.arms]
    if joined:
        raise ModelError(f"{diagram.name}: {joined[0]} has no form in a file")
    kind = kind_of(diagram)
    lines = ["[diagram]"]
    if kind is not None:
        lines += [f"kind = {_text(kind)}"]
    else:
        lines += [f"name = {_text(diagram.name)}"]
        lines += [f"measured = [{', '.join(map(_text, diagram.measured))}]"]
        lines += _table("outside", diagram.outside)
    for block in diagram.blocks:
        lines += ["", f"[blocks.{_key(block.name)}]"]
        lines += [] if kind is not None else _wiring(block)
        if isinstance(block, Control):
            lines += ["analog = true"] if block.analog else []
            lines += _laws(block)
        elif not isinstance(block, Linked):
            lines += _body(block.name, block.body)
    if kind is None:
        lines += _table("junctions", {j.output: j.terms for j in diagram.junctions})
        lines += _table("texts", diagram.texts)
    return "\n".join(lines) + "\n"


def _table(name: str, content: Mapping[str, Any]) -> list[str]:
    if not content:
        return []
    return ["", f"[{name}]", *(f"{_key(k)} = {_value(v)}" for k, v in content.items())]


def _wiring(block: Block) -> list[str]:
    if isinstance(block, Moving):
        keys: dict[str, Any] = {"kind": "moving", "motion": block.motion, "command": block.command}
        keys |= {"loads": block.loads, "driver": block.driver}
    elif isinstance(block, Attached):
        keys = {"kind": "attached", "motion": block.motion, "force": block.force}
        keys |= {"sign": block.sign}
    else:
        assert isinstance(block, Control)
        keys = {"kind": "control", "input": block.input, "output": block.output}
        keys |= {"motion": block.motion}
    return [f"{k} = {_value(v)}" for k, v in keys.items()]


def _body(name: str, body: Body | AnyBlock) -> list[str]:
    if isinstance(body, AnyBlock):
        return []
    for effect in body.effects:
        if EFFECTS.get(effect.name) is not effect:
            raise ModelError(f'{name}: effect "{effect.name}" is not the one of the catalogue')
    lines = [f"axis = {_text(body.axis)}", f"inertia = {_value(body.parameters['inertia'])}"]
    for effect in body.effects:
        lines += [f"[blocks.{_key(name)}.effects.{_key(effect.name)}]"]
        own = ((p, body.parameters[f"{effect.name}.{p}"]) for p in effect.parameters)
        lines += [f"{p} = {_value(value)}" for p, value in own]
    return lines


def _laws(block: Control) -> Iterator[str]:
    if not isinstance(block.controller, Controller):
        return
    stages = block.controller.stages
    for stage in stages:
        if len(stages) > 1:
            yield f"[[blocks.{_key(block.name)}.series]]"
        yield f"law = {_text(stage.law.name)}"
        yield f"parameters = {_value(stage.values)}"


def _value(value: object) -> str:
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, Mapping):
        return _inline((_key(k), _value(v)) for k, v in value.items())
    if isinstance(value, Value):
        return _number_with_marks(value)
    return repr(value) if isinstance(value, int) else repr(float(value))  # type: ignore[arg-type]


def _number_with_marks(value: Value) -> str:
    if not value.fixed and math.isnan(value.stderr):
        return _value(value.value)
    parts = [("value", _value(value.value))]
    parts += [("fixed", "true")] if value.fixed else []
    parts += [] if math.isnan(value.stderr) else [("stderr", _value(value.stderr))]
    return _inline(parts)


def _inline(parts: Iterable[tuple[str, str]]) -> str:
    inside = ", ".join(f"{k} = {v}" for k, v in parts)
    return f"{{ {inside} }}" if inside else "{}"


def _key(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else _text(name)


def _text(text: str) -> str:
    # JSON's quotes are TOML's, but for one control character
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
