"""A diagram from a TOML file: blocks with their values, wired by the names of their signals.

Values are in SI; the value of a body may have a unit, { value = 150, unit = "g" }. A block without
laws or inertia is only a name. Weights and kinematics may be expressions of positions, as text.
Unknown keys are refused, in one line.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast, get_args

from ..base.errors import ExperimentError, ModelError
from ..base.toml import Table, describe_toml_value, read_toml
from ..base.units import AXES, QUANTITIES, to_si
from ..blocks import Body, with_block_effects
from ..blocks.described import body_of
from ..controllers import CANCEL, CONTROLLERS, ControlLaw, Controller, Stage, cancelling_law
from ..effects import Effect
from ..measurement.description import BODY, body_from
from .expressions import read_expression
from .junctions import Junction, Kinematics, Weight
from .parts import ANY, AnyBlock, Attached, Block, Control, Linked, Moving, PortRole
from .short_form import KINDS, Content
from .toml_matrices import MATRICES, read_matrices
from .wiring import Diagram

LAW = ("law", "parameters", "series")
#: what older files call the hand and the environment, without a role
ROLES_BY_NAME: Mapping[str, PortRole] = {"Z_H": "hand", "Z_E": "environment"}
#: kind of a block -> its keys, besides those of its body or law
WIRING = {
    "moving": ("motion", "command", "loads", "driver"),
    "attached": ("motion", "force", "sign", "role"),
    "linked": ("motions", "forces", "sign", "role"),
    "control": ("input", "output", "motion", "analog", "others"),
}


@dataclass(frozen=True)
class _Known:
    """What a file may name: effects of bodies and control laws."""

    effects: Mapping[str, Effect]
    laws: Mapping[str, ControlLaw]


def read_diagram(
    path: str | Path,
    *,
    effects: Mapping[str, Effect] | None = None,
    laws: Mapping[str, ControlLaw] | None = None,
) -> Diagram:
    """The diagram that a file describes; the page "Diagrams" of the documentation has the format.

    effects: known effects by name, for users who add effects (`effects.catalogue`); None: EFFECTS.
        The effects of blocks, such as "environment", are known as well
    laws: known control laws by name, for users who add laws (`controllers.catalogue`); None:
        CONTROLLERS. A file names laws and never holds code
    raises ExperimentError: the file cannot be read, or an entry has no meaning

        >>> device = td.hand(mass=0.2, damping=2.0, stiffness=0.0)
        >>> td.write_diagram(td.haptic_interface(device), "interface.toml")
        >>> td.read_diagram("interface.toml").name
        'haptic interface'
    """
    path = Path(path)
    root = read_toml(path, path.name)
    known = _Known(with_block_effects(effects), CONTROLLERS if laws is None else laws)
    head = root.table("diagram")
    try:
        if "kind" in head.content:
            return _read_short_form(root, head, known)
        return _read_free_diagram(root, head, known)
    except ModelError as error:
        raise ExperimentError(f"{path.name}: {error}") from error


def _read_short_form(root: Table, head: Table, known: _Known) -> Diagram:
    """Read a diagram whose wiring the package knows: the file states only blocks."""
    root.allow(("diagram", "blocks"))
    head.allow(("kind", "name"))
    kind = head.choice("kind", KINDS)
    form, tables = KINDS[kind], root.table("blocks")
    tables.allow((*form.bodies, *form.controls))
    blocks: dict[str, Content] = {}
    analog = []
    for name in tables.content:
        table = tables.table(name)
        if name in form.bodies:
            table.allow(BODY)
            blocks[name] = _body(table, known)
            continue
        table.allow((*LAW, "analog") if form.has_analog else LAW)
        blocks[name] = _controller(table, known)
        analog += [name] if table.flag("analog", False) else []
    diagram = form.wire(blocks, tuple(analog))
    return replace(diagram, name=_string(head, "name")) if "name" in head.content else diagram


def _read_free_diagram(root: Table, head: Table, known: _Known) -> Diagram:
    """Read a diagram with all its blocks, junctions and outside signals."""
    root.allow(("diagram", "outside", "blocks", "kinematics", "junctions", "pose", "texts"))
    head.allow(("name", "measured", "kind"))
    outside, tables = root.table("outside"), root.table("blocks")
    junctions, texts = root.table("junctions"), root.table("texts")
    kinematics, pose = root.table("kinematics"), root.table("pose")
    for table in (junctions, kinematics):
        _refuse_ambiguous_pi(table, tables)
    return Diagram(
        _string(head, "name"),
        tuple(_block(name, tables.table(name), known) for name in tables.content),
        tuple(Junction(name, _terms(junctions, name)) for name in junctions.content),
        {name: outside.choice(name, QUANTITIES) for name in outside.content},
        tuple(_strings(head, "measured")),
        {name: _string(texts, name) for name in texts.content},
        tuple(_kinematics(kinematics, name) for name in kinematics.content),
        {name: pose.number(name) for name in pose.content},
    )


def _refuse_ambiguous_pi(expressions: Table, blocks: Table) -> None:
    """Refuse "pi" in an expression if a position has this name: the number would be used."""
    if not any("pi" in _motions(blocks.table(name)) for name in blocks.content):
        return
    for name, terms in expressions.content.items():
        texts = terms.values() if isinstance(terms, dict) else [terms]
        if any(isinstance(text, str) and re.search(r"\bpi\b", text) for text in texts):
            where = expressions.where(name)
            raise ExperimentError(f'{where}: found "pi", a number and a motion: rename the motion')


def _motions(block: Table) -> list[object]:
    motions = block.content.get("motions", [])
    return [block.content.get("motion"), *(motions if isinstance(motions, list) else [])]


def _block(name: str, table: Table, known: _Known) -> Block:
    kind = table.choice("kind", WIRING)
    content = {"control": LAW, "linked": MATRICES}.get(kind, BODY)
    table.allow(("kind", *WIRING[kind], *content))
    if kind == "control":
        source, made = (_string(table, key) for key in ("input", "output"))
        along = _string(table, "motion") if "motion" in table.content else ""
        law = _controller(table, known)
        others = tuple(_strings(table, "others"))
        return Control(name, law, source, made, along, table.flag("analog", False), others=others)
    if kind == "linked":
        motions, forces = (tuple(_strings(table, key)) for key in ("motions", "forces"))
        z, role = read_matrices(table, len(motions)), _role(name, table)
        return Linked(name, z, motions, forces, _sign(table), role)
    motion, body = _string(table, "motion"), _body(table, known)
    if kind == "attached":
        force = _string(table, "force")
        return Attached(name, body, motion, force, _sign(table), _role(name, table))
    command, driver, loads = (
        _string(table, "command"),
        _string(table, "driver"),
        table.table("loads"),
    )
    terms: dict[str, Any] = {signal: _number(loads, signal) for signal in loads.content}
    return Moving(name, body, motion, command, terms, driver)


def _sign(table: Table) -> int:
    sign = -1 if "sign" not in table.content else _number(table, "sign")
    if sign not in (1, -1):
        raise ExperimentError(f"{table.where('sign')}: found {sign:g}, expected 1 or -1")
    return int(sign)


def _role(name: str, table: Table) -> PortRole:
    """The role that a block states; files from before roles had names for hand and environment."""
    if "role" not in table.content and name in ROLES_BY_NAME:
        role = ROLES_BY_NAME[name]
        warnings.warn(
            f'{table.where("role")}: taken for "{role}" by the name of the block: state role = '
            f'"{role}", or "part" for a part of the device',
            stacklevel=2,
        )
        return role
    stated = table.choice("role", get_args(PortRole)) if "role" in table.content else "part"
    return cast(PortRole, stated)


def _terms(table: Table, key: str) -> dict[str, Weight]:
    """Signal -> sign, weight, or an expression of positions."""
    terms = table.table(key)
    return {
        signal: read_expression(text, where=terms.where(signal))
        if isinstance(text, str)
        else _number(terms, signal)
        for signal, text in terms.content.items()
    }


def _number(table: Table, key: str) -> float:
    number = table.number(key)
    return int(number) if isinstance(table.content[key], int) else number


def _kinematics(table: Table, name: str) -> Kinematics:
    """Read an expression, or { expression = "...", axis = "revolute" }."""
    if isinstance(table.content[name], str):
        return Kinematics(name, read_expression(table.content[name], where=table.where(name)))
    entry = table.table(name)
    entry.allow(("expression", "axis"))
    where = read_expression(entry.text("expression"), where=entry.where("expression"))
    return Kinematics(name, where, entry.choice("axis", AXES))


def _body(table: Table, known: _Known) -> Body | AnyBlock:
    if not any(key in table.content for key in BODY):
        return ANY
    return body_of(body_from(table.key, table), known.effects, complete=True)


def _controller(table: Table, known: _Known) -> Controller | AnyBlock:
    if not any(key in table.content for key in LAW):
        return ANY
    if "series" not in table.content:
        return Controller((_stage(table, known),))
    for key in ("law", "parameters"):
        if key in table.content:
            raise ExperimentError(f"{table.where(key)}: found beside series, expected one of them")
    rows = table.tables("series")
    for row in rows:
        row.allow(("law", "parameters"))
    if not rows:
        raise ExperimentError(f"{table.where('series')}: found no law, expected one or more")
    try:
        named = (replace(row, key=f"{table.key}.{row.key}") for row in rows)
        return Controller(tuple(_stage(row, known) for row in named))
    except ModelError as error:
        raise ExperimentError(f"{table.where('series')}: {error}") from error


def _stage(table: Table, known: _Known) -> Stage:
    name = table.choice("law", (*known.laws, CANCEL))
    parameters = table.table("parameters")
    if name == CANCEL:
        parameters = replace(parameters, content=_flat(parameters.content))
    try:
        law = known.laws[name] if name != CANCEL else _cancelling(parameters, known)
        parameters.allow(law.parameters)
        entries = {n: _parameter(parameters, n, p.quantity) for n, p in law.parameters.items()}
        free = tuple(name for name, (_, is_free) in entries.items() if is_free)
        return Stage(law, {name: value for name, (value, _) in entries.items()}, free=free)
    except ModelError as error:
        raise ExperimentError(f"{parameters.where()}: {error}") from error


def _parameter(table: Table, name: str, quantity: str) -> tuple[float, bool]:
    """Value (SI) of a law's parameter, and whether it is free: a number is as programmed."""
    if not isinstance(table.content.get(name), Mapping):
        return table.number(name), False
    entry = table.table(name)
    entry.allow(("value", "unit", "fixed"))
    value = entry.number("value")
    if "unit" in entry.content:
        # a law is used on either axis: the unit says on which
        unit = entry.text("unit")
        axis = "revolute" if "N*m" in unit or "rad" in unit else "prismatic"
        value = to_si(value, unit, quantity=quantity, axis=axis, where=entry.where("unit"))
    return value, not entry.flag("fixed", True)


def _cancelling(parameters: Table, known: _Known) -> ControlLaw:
    return cancelling_law(tuple(parameters.content), known.effects)


def _flat(content: Mapping[str, Any]) -> dict[str, Any]:
    """Parameters of effects, written cogging.amplitude = 0.1 or in a table of the effect."""
    flat: dict[str, Any] = {}
    for name, value in content.items():
        is_effect = isinstance(value, Mapping) and "value" not in value
        inner = value if is_effect else {"": value}
        flat |= {f"{name}.{n}" if n else name: v for n, v in inner.items()}
    return flat


def _string(table: Table, key: str) -> str:
    """As `Table.text`, but the text may be blank."""
    text = table.content.get(key)
    return text if isinstance(text, str) else table.text(key)


def _strings(table: Table, key: str) -> list[str]:
    signals = table.content.get(key, [])
    if not isinstance(signals, list) or not all(isinstance(s, str) for s in signals):
        raise ExperimentError(
            f"{table.where(key)}: found {describe_toml_value(signals)}, "
            "expected a list of signals in quotes"
        )
    return signals
