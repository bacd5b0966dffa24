"""Bodies and an environment as written in experiment.toml, in a diagram's file or in an answer.

A value is a number in SI, or { value = 150, unit = "g", fixed = true, stderr = 2 }; values keep the
unit in which they were written. Only the effect knows the physical quantity of its parameters:
`blocks.described` converts their values and repeats `where` in its messages. Of a command line, a
value is a number with a unit where one is required: "0.037 N*m/A".
"""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

from ..base.errors import ExperimentError
from ..base.toml import Table
from ..base.units import AXES, is_unit, measures, to_si, unit_of
from .column_names import unit_of_text

_NUMBER_AND_UNIT = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*)")

ONE_BODY = ("device",)
TWO_BODIES = ("master", "slave")
#: keys of a table that describes a body
BODY = ("axis", "inertia", "effects")
_ENVIRONMENT = {"stiffness": "stiffness", "damping": "damping", "contact_position": "position"}


@dataclass(frozen=True)
class ModelValue:
    """A number as written in a file.

    unit: of the number; None: SI;  fixed: the number is not estimated again
    where: place in the file, for messages;  stderr: standard error in `unit`; None: not written
    """

    value: float
    unit: str | None
    fixed: bool
    where: str
    stderr: float | None = None

    def in_si(self, quantity: str, axis: str) -> tuple[float, float | None]:
        """Value and standard error in SI; raises ExperimentError: the unit of another quantity."""
        if self.unit is None:
            return self.value, self.stderr

        def converted(number: float) -> float:
            where = f"{self.where}.unit"
            return to_si(number, self.unit, quantity=quantity, axis=axis, where=where)

        return converted(self.value), None if self.stderr is None else converted(self.stderr)


Effects = Mapping[str, Mapping[str, ModelValue]]
"""Effect's name -> parameter's name -> value; {} where the user leaves the parameters open."""


@dataclass(frozen=True)
class BodyDescription:
    """One body ("device", "master", "slave" or a joint) on one axis ("prismatic" or "revolute")."""

    name: str
    axis: str
    inertia: ModelValue | None
    effects: Effects
    where: str


@dataclass(frozen=True)
class EnvironmentDescription:
    """The environment that the slave (or device) touches.

    values: stiffness, damping and contact_position, those that are written
    """

    values: Mapping[str, ModelValue]
    effects: Effects
    where: str


def bodies_from(model: Table) -> dict[str, BodyDescription]:
    """Read the bodies of [model]: device alone, or master and slave."""
    model.allow((*ONE_BODY, *TWO_BODIES, "environment"))
    names = tuple(name for name in (*ONE_BODY, *TWO_BODIES) if name in model.content)
    if names not in (ONE_BODY, TWO_BODIES):
        listed = ", ".join(names) or "none of them"
        raise ExperimentError(
            f"{model.where()}: found {listed}, "
            "expected [model.device], or [model.master] and [model.slave]"
        )
    return {name: _require_inertia(name, model.table(name)) for name in names}


def environment_from(
    model: Table, bodies: Mapping[str, BodyDescription]
) -> EnvironmentDescription | None:
    """Read [model.environment] or None; its axis is that of the last body, which touches it."""
    if "environment" not in model.content:
        return None
    table = model.table("environment")
    table.allow((*_ENVIRONMENT, "effects"))
    axis = list(bodies.values())[-1].axis
    values = {}
    for name, quantity in _ENVIRONMENT.items():
        if name in table.content:
            values[name] = value_from(table, name)
            values[name].in_si(quantity, axis)
    return EnvironmentDescription(values, effects_from(table), table.where())


def _require_inertia(name: str, table: Table) -> BodyDescription:
    """Read a body whose motion is recorded; its inertia, if written, must be above 0.

    A fixed one may be 0: on a friction curve nothing accelerates.
    """
    table.allow(BODY)
    body = body_from(name, table)
    inertia = body.inertia
    if inertia is not None and (inertia.value < 0 or inertia.value == 0 and not inertia.fixed):
        raise ExperimentError(
            f"{inertia.where}: found {inertia.value:g}, expected a number above 0"
        )
    return body


def body_from(name: str, table: Table) -> BodyDescription:
    """Read a body from the keys `BODY` of a table; the caller checks all other keys.

    raises ExperimentError: a wrong type, no axis, no number, the unit of another quantity
    """
    axis = table.choice("axis", AXES)
    inertia = None
    if "inertia" in table.content:
        inertia = value_from(table, "inertia")
        inertia.in_si("inertia", axis)
    return BodyDescription(name, axis, inertia, effects_from(table), table.where())


def effects_from(table: Table) -> dict[str, dict[str, ModelValue]]:
    """Read the effects under the key `effects` of a table, with their parameters as written."""
    effects = table.table("effects")
    written = {name: effects.table(name) for name in effects.content}
    return {
        name: {parameter: value_from(effect, parameter) for parameter in effect.content}
        for name, effect in written.items()
    }


def with_first_values(
    body: BodyDescription, *, inertia: float, level: float, damping: float
) -> BodyDescription:
    """The body with an inertia, and values of its plain friction where none is written, SI.

    inertia, level, damping: starts, of which three digits count; friction above 0 alone
    """
    start = _start(body, "inertia", inertia, "inertia")
    effects = {name: dict(values) for name, values in body.effects.items()}
    for name, parameter, quantity, number in (
        ("coulomb", "level", "force", level),
        ("viscous", "damping", "damping", damping),
    ):
        if name in effects and not effects[name] and number > 0:
            effects[name] = {
                parameter: _start(body, f"effects.{name}.{parameter}", number, quantity)
            }
    return replace(body, inertia=start, effects=effects)


def _start(body: BodyDescription, key: str, number: float, quantity: str) -> ModelValue:
    unit = unit_of(quantity, body.axis)
    return ModelValue(float(f"{number:.3g}"), unit, False, f"{body.where}.{key}")


def value_from(table: Table, key: str) -> ModelValue:
    """Read { value = 0.5, unit = "N", fixed = true, stderr = 0.1 }, or a number in SI."""
    if not isinstance(table.content[key], dict):
        return ModelValue(table.number(key), None, False, table.where(key))
    entry = table.table(key)
    entry.allow(("value", "unit", "fixed", "stderr"))
    unit = entry.text("unit") if "unit" in entry.content else None
    number, error = entry.number("value"), entry.number_or_none("stderr")
    if error is not None and error < 0:
        raise entry.error("stderr", "0 or more", f"{error:g}")
    return ModelValue(number, unit, entry.flag("fixed", False), table.where(key), error)


def split_value(text: str) -> tuple[float, str] | None:
    """The number and the rest of a text; None: the text does not begin with a finite number."""
    match = _NUMBER_AND_UNIT.fullmatch(text)
    if match is None or not math.isfinite(float(match[1])):
        return None
    return float(match[1]), match[2].strip()


def motor_constant(text: str, *, where: str) -> tuple[float, str]:
    """A motor constant such as "0.037 N*m/A" or "12 N/A".

    raises ExperimentError: no number, or another unit
    """
    parts = split_value(text)
    force, _, per = (parts[1] if parts else "").rpartition("/")
    force = unit_of_text(force) or ""
    if parts is None or not (is_unit(parts[1]) or is_unit(f"{force}/{per}")):
        raise ExperimentError(
            f'{where}: found {text!r}, expected a number and a unit such as "0.037 N*m/A"'
        )
    if not any(measures(force, "force", axis) for axis in AXES) or per not in ("A", "mA", "V"):
        raise ExperimentError(
            f"{where}: found the unit {parts[1]!r}, expected a force or torque for each "
            'ampere or volt, such as "N*m/A" or "N/A"'
        )
    return parts[0], f"{force}/{per}"


def lever_arm(text: str, *, where: str) -> tuple[float, str]:
    """Distance of a force from the axis, such as "70 mm".

    raises ExperimentError: no number above 0, or no unit of a length
    """
    parts = split_value(text)
    if parts is None or not parts[0] > 0 or not is_unit(parts[1] or "?"):
        raise ExperimentError(f'{where}: found {text!r}, expected a length such as "70 mm"')
    if not measures(parts[1], "position", "prismatic"):
        raise ExperimentError(
            f'{where}: found the unit {parts[1]!r}, expected one of a length such as "mm"'
        )
    return parts


def plain_number(text: str, *, where: str) -> float:
    """A number without a unit; a decimal comma is accepted.

    raises ExperimentError: no number
    """
    try:
        value = float(text.replace(",", "."))
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ExperimentError(f"{where}: found {text!r}, expected a number")
    return value
