"""What the user believes so far, as written in experiment.toml: bodies, effects, an environment.

Values keep the unit they were written in. Which quantity an effect's parameter is, only the effect
knows; the model converts it (`quantity.to_si`) and repeats `where` in its messages.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from ..errors import ExperimentError, did_you_mean, quoted
from ..quantity import AXES, to_si
from .toml_table import Table

ONE_BODY = ("device",)
TWO_BODIES = ("master", "slave")
_ENVIRONMENT = {"stiffness": "stiffness", "damping": "damping", "contact_position": "position"}


@dataclass(frozen=True)
class ModelValue:
    """A number as written, in `unit` (None: none written); `fixed`: not to be re-estimated."""

    value: float
    unit: str | None
    fixed: bool
    where: str


Effects = Mapping[str, Mapping[str, ModelValue]]
"""Effect's name -> parameter's name -> value; {} where the user leaves the parameters open."""


@dataclass(frozen=True)
class BodyDescription:
    """One body ("device", "master", "slave") on one axis ("prismatic" or "revolute")."""

    name: str
    axis: str
    inertia: ModelValue | None
    effects: Effects
    where: str


@dataclass(frozen=True)
class EnvironmentDescription:
    """What the slave (or device) touches: stiffness, damping, contact_position, if written."""

    values: Mapping[str, ModelValue]
    effects: Effects
    where: str


def bodies_from(model: Table) -> dict[str, BodyDescription]:
    """The bodies of [model]: device alone, or master and slave."""
    model.allow((*ONE_BODY, *TWO_BODIES, "environment"))
    names = tuple(name for name in (*ONE_BODY, *TWO_BODIES) if name in model.content)
    if names not in (ONE_BODY, TWO_BODIES):
        found = ", ".join(names) or "none of them"
        raise ExperimentError(
            f"{model.where()}: found {found}, "
            "expected [model.device], or [model.master] and [model.slave]"
        )
    return {name: _body(name, model.table(name)) for name in names}


def environment_from(
    model: Table, bodies: Mapping[str, BodyDescription]
) -> EnvironmentDescription | None:
    """[model.environment], or None; its axis is that of the body that touches it (the last one)."""
    if "environment" not in model.content:
        return None
    table = model.table("environment")
    table.allow((*_ENVIRONMENT, "effects"))
    axis = list(bodies.values())[-1].axis
    values = {}
    for name, quantity in _ENVIRONMENT.items():
        if name in table.content:
            values[name] = _value(table, name)
            _in_si(values[name], quantity, axis)
    return EnvironmentDescription(values, _effects(table), table.where())


def _body(name: str, table: Table) -> BodyDescription:
    table.allow(("axis", "inertia", "effects"))
    axis = table.text("axis")
    if axis not in AXES:
        raise ExperimentError(
            f"{table.where('axis')}: found {quoted(axis)}, expected "
            f"{' or '.join(quoted(a) for a in AXES)}{did_you_mean(axis, AXES)}"
        )
    inertia = None
    if "inertia" in table.content:
        inertia = _value(table, "inertia")
        if _in_si(inertia, "inertia", axis) <= 0:
            raise ExperimentError(
                f"{inertia.where}: found {inertia.value:g}, expected a number above 0"
            )
    return BodyDescription(name, axis, inertia, _effects(table), table.where())


def _in_si(value: ModelValue, quantity: str, axis: str) -> float:
    where = value.where if value.unit is None else f"{value.where}.unit"
    return to_si(value.value, value.unit, quantity=quantity, axis=axis, where=where)


def _effects(table: Table) -> dict[str, dict[str, ModelValue]]:
    effects = table.table("effects")
    written = {name: effects.table(name) for name in effects.content}
    return {
        name: {parameter: _value(effect, parameter) for parameter in effect.content}
        for name, effect in written.items()
    }


def _value(table: Table, key: str) -> ModelValue:
    """{ value = 0.5, unit = "N", fixed = true }, or a bare number (without unit)."""
    if not isinstance(table.content[key], dict):
        return ModelValue(table.number(key), None, False, table.where(key))
    entry = table.table(key)
    entry.allow(("value", "unit", "fixed"))
    unit = entry.text("unit") if "unit" in entry.content else None
    return ModelValue(entry.number("value"), unit, entry.flag("fixed", False), table.where(key))
