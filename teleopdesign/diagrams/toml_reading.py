"""A diagram from a TOML file: blocks with their values, wired by the names of their signals.

SI throughout; a body's value may carry a unit, { value = 150, unit = "g" }. A block without laws
or inertia is known by its name only. Everything unknown is refused, in one line.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..blocks import Body, Value
from ..blocks.body import INERTIA
from ..controllers import CONTROLLERS, Controller, Stage
from ..effects import EFFECTS, Effect, Parameter, find_effect
from ..errors import ExperimentError, ModelError, did_you_mean, quoted
from ..measurement.toml_table import Table, described, read_toml
from ..quantity import AXES, QUANTITIES, to_si
from .parts import ANY, AnyBlock, Attached, Block, Control, Junction, Moving
from .short_form import KINDS, Content
from .wiring import Diagram

BODY = ("axis", "inertia", "effects")
LAW = ("law", "parameters", "series")
#: keys of a block by its kind, beside those of its body or law
WIRING = {
    "moving": ("motion", "command", "loads", "driver"),
    "attached": ("motion", "force", "sign"),
    "control": ("input", "output", "motion", "analog"),
}


def read_diagram(path: str | Path, *, effects: Mapping[str, Effect] = EFFECTS) -> Diagram:
    """The diagram that a file describes; the format is on the page "Diagrams" of the documentation.

    effects: the effects by name, for those who add their own (`effects.catalogue`)
    raises ExperimentError: what cannot be read or has no meaning: file, key, found, expected
    """
    path = Path(path)
    root = read_toml(path, path.name)
    head = root.table("diagram")
    try:
        if "kind" in head.content:
            return _short(root, head, effects)
        return _free(root, head, effects)
    except ModelError as error:
        raise ExperimentError(f"{path.name}: {error}") from error


def _short(root: Table, head: Table, effects: Mapping[str, Effect]) -> Diagram:
    """The wiring is that of the package: blocks only."""
    root.allow(("diagram", "blocks"))
    head.allow(("kind", "name"))
    kind = _one_of(head, "kind", KINDS)
    form, tables = KINDS[kind], root.table("blocks")
    tables.allow((*form.bodies, *form.controls))
    blocks: dict[str, Content] = {}
    analog = []
    for name in tables.content:
        table = tables.table(name)
        if name in form.bodies:
            table.allow(BODY)
            blocks[name] = _body(table, effects)
            continue
        table.allow((*LAW, "analog") if form.has_analog else LAW)
        blocks[name] = _controller(table)
        analog += [name] if table.flag("analog", False) else []
    diagram = form.wired(blocks, tuple(analog))
    return replace(diagram, name=_string(head, "name")) if "name" in head.content else diagram


def _free(root: Table, head: Table, effects: Mapping[str, Effect]) -> Diagram:
    """Blocks, junctions and what comes from outside, all written out."""
    root.allow(("diagram", "outside", "blocks", "junctions", "texts"))
    head.allow(("name", "measured", "kind"))
    outside, tables = root.table("outside"), root.table("blocks")
    junctions, texts = root.table("junctions"), root.table("texts")
    return Diagram(
        _string(head, "name"),
        tuple(_block(name, tables.table(name), effects) for name in tables.content),
        tuple(Junction(name, _terms(junctions, name)) for name in junctions.content),
        {name: _one_of(outside, name, QUANTITIES) for name in outside.content},
        tuple(_strings(head, "measured")),
        {name: _string(texts, name) for name in texts.content},
    )


def _block(name: str, table: Table, effects: Mapping[str, Effect]) -> Block:
    kind = _one_of(table, "kind", WIRING)
    content = LAW if kind == "control" else BODY
    table.allow(("kind", *WIRING[kind], *content))
    if kind == "control":
        taken, made, along = (_string(table, key) for key in ("input", "output", "motion"))
        return Control(name, _controller(table), taken, made, along, table.flag("analog", False))
    motion, body = _string(table, "motion"), _body(table, effects)
    if kind == "attached":
        sign = -1 if "sign" not in table.content else _weight(table, "sign")
        if sign not in (1, -1):
            raise ExperimentError(f"{table.where('sign')}: found {sign:g}, expected 1 or -1")
        return Attached(name, body, motion, _string(table, "force"), int(sign))
    command, driver = _string(table, "command"), _string(table, "driver")
    return Moving(name, body, motion, command, _terms(table, "loads"), driver)


def _terms(table: Table, key: str) -> dict[str, Any]:
    """Signal -> sign or weight."""
    terms = table.table(key)
    return {signal: _weight(terms, signal) for signal in terms.content}


def _weight(table: Table, key: str) -> float:
    number = table.number(key)
    return int(number) if isinstance(table.content[key], int) else number


def _body(table: Table, effects: Mapping[str, Effect]) -> Body | AnyBlock:
    if not any(key in table.content for key in BODY):
        return ANY
    axis = _one_of(table, "axis", AXES)
    values = {"inertia": _value(table, "inertia", INERTIA, axis)}
    written, own = table.table("effects"), []
    for name in written.content:
        effect = find_effect(name, effects, written.where())
        own.append(effect)
        parameters = written.table(name)
        parameters.allow(effect.parameters)
        for key, parameter in effect.parameters.items():
            if key in parameters.content or not parameter.optional:
                values[f"{name}.{key}"] = _value(parameters, key, parameter, axis)
    try:
        return Body(axis, values, tuple(own))
    except ModelError as error:
        raise ExperimentError(f"{table.where()}: {error}") from error


def _value(table: Table, key: str, parameter: Parameter, axis: str) -> Value:
    """A number in SI, or { value = 150, unit = "g", fixed = true, stderr = 2 }."""
    if not isinstance(table.content.get(key), dict):
        return Value(table.number(key))
    entry = table.table(key)
    entry.allow(("value", "unit", "fixed", "stderr"))
    number, error = entry.number("value"), entry.number_or_none("stderr")
    fixed = entry.flag("fixed", False)
    if "unit" in entry.content:
        unit, where = entry.text("unit"), entry.where("unit")
        number = to_si(number, unit, quantity=parameter.quantity, axis=axis, where=where)
        if error is not None:
            error = to_si(error, unit, quantity=parameter.quantity, axis=axis, where=where)
    return Value(number, fixed) if error is None else Value(number, fixed, error)


def _controller(table: Table) -> Controller | AnyBlock:
    if not any(key in table.content for key in LAW):
        return ANY
    if "series" not in table.content:
        return Controller((_stage(table),))
    for key in ("law", "parameters"):
        if key in table.content:
            raise ExperimentError(f"{table.where(key)}: found beside series, expected one of them")
    rows = table.tables("series")
    for row in rows:
        row.allow(("law", "parameters"))
    if not rows:
        raise ExperimentError(f"{table.where('series')}: found no law, expected one or more")
    try:
        return Controller(tuple(_stage(replace(r, key=f"{table.key}.{r.key}")) for r in rows))
    except ModelError as error:
        raise ExperimentError(f"{table.where('series')}: {error}") from error


def _stage(table: Table) -> Stage:
    law = CONTROLLERS[_one_of(table, "law", CONTROLLERS)]
    parameters = table.table("parameters")
    parameters.allow(law.parameters)
    values = {name: parameters.number(name) for name in law.parameters}
    try:
        return Stage(law, values)
    except ModelError as error:
        raise ExperimentError(f"{parameters.where()}: {error}") from error


def _one_of(table: Table, key: str, known: Any) -> str:
    value = _string(table, key)
    if value not in known:
        raise ExperimentError(
            f"{table.where(key)}: found {quoted(value)}, expected {', '.join(known)}"
            f"{did_you_mean(value, known)}"
        )
    return value


def _string(table: Table, key: str) -> str:
    """As `Table.text`, but it may be blank."""
    found = table.content.get(key)
    return found if isinstance(found, str) else table.text(key)


def _strings(table: Table, key: str) -> list[str]:
    found = table.content.get(key, [])
    if not isinstance(found, list) or not all(isinstance(s, str) for s in found):
        raise ExperimentError(
            f"{table.where(key)}: found {described(found)}, expected a list of signals in quotes"
        )
    return found
