"""Bodies from descriptions in files: the only place where written values become parameters.

The same table describes a body in experiment.toml, in a diagram's file and in an answer. A value
with a unit is checked and converted; a plain number is in SI.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ..base.errors import ExperimentError, ModelError, unknown
from ..base.units import unit_after_number, unit_of
from ..effects import CONTACT_ROLES, Effect, Parameter, find_effect
from ..measurement.description import BodyDescription, Effects, EnvironmentDescription, ModelValue
from .body import INERTIA, Body
from .body_equation import CONTACT
from .value import Value


def body_of(
    description: BodyDescription, known: Mapping[str, Effect], *, complete: bool = False
) -> Body:
    """The body of a description, in SI.

    known: effects by name
    complete: whether every parameter that is not optional is required; otherwise a missing one is
        free, with the value at which its effect is absent
    raises ExperimentError: unknown effect or parameter, wrong unit, value out of bounds or missing
    """
    where = description.where
    if description.inertia is None:
        raise ExperimentError(f"{where}: no inertia given")
    effects, parameters = effects_of(
        description.effects, f"{where}.effects", description.axis, known, complete=complete
    )
    parameters["inertia"] = value_of(description.inertia, INERTIA, description.axis)
    try:
        return Body(description.axis, parameters, tuple(effects))
    except ModelError as error:
        raise ExperimentError(f"{where}: {error}") from error


def effects_of(
    written: Effects,
    where: str,
    axis: str,
    known: Mapping[str, Effect],
    *,
    complete: bool = False,
) -> tuple[list[Effect], dict[str, Value]]:
    """The effects of a table, and their parameters by name within the body; see `body_of`."""
    effects: list[Effect] = []
    parameters: dict[str, Value] = {}
    for name, entries in written.items():
        try:
            effect = find_effect(name, known, where)
        except ModelError as error:
            raise ExperimentError(str(error)) from error
        effects.append(effect)
        for key in entries:
            if key not in effect.parameters:
                raise ExperimentError(
                    f"{where}.{name}: {unknown('parameter', key, effect.parameters)}"
                )
        for key, parameter in effect.parameters.items():
            if key in entries:
                parameters[f"{name}.{key}"] = value_of(entries[key], parameter, axis)
            elif not complete:
                open_value = Value(effect.default(key), fixed=parameter.search.chosen)
                parameters[f"{name}.{key}"] = open_value
            elif not parameter.optional:
                raise ExperimentError(f'{where}.{name}: no key "{key}", expected a number')
    return effects, parameters


def value_of(written: ModelValue, parameter: Parameter, axis: str) -> Value:
    """A value in SI.

    raises ExperimentError: wrong unit, or value out of the parameter's bounds
    """
    number, error = written.in_si(parameter.quantity, axis)
    if not parameter.lower <= number <= parameter.upper:
        unit = written.unit or unit_of(parameter.quantity, axis)
        raise ExperimentError(
            f"{written.where}: {written.value:g}{unit_after_number(unit)} is outside "
            f"{parameter.lower:g} .. {parameter.upper:g}"
        )
    return Value(number, written.fixed) if error is None else Value(number, written.fixed, error)


def with_environment(
    body: Body, description: EnvironmentDescription, known: Mapping[str, Effect]
) -> Body:
    """The body with the environment that it touches; a damping that is not stated is zero.

    raises ExperimentError: no stiffness, or as `body_of`
    """
    if "stiffness" not in description.values:
        raise ExperimentError(f"{description.where}: no stiffness given")
    values = {
        f"{CONTACT.name}.damping": Value(0.0, fixed=True),
        f"{CONTACT.name}.contact_position": Value(0.0, fixed=True),
    }
    for name, value in description.values.items():
        values[f"{CONTACT.name}.{name}"] = value_of(value, CONTACT.parameters[name], body.axis)
    body = body.with_effect(CONTACT).with_values(values)
    where = f"{description.where}.effects"
    effects, parameters = effects_of(description.effects, where, body.axis, known)
    for effect in effects:
        if effect.role not in CONTACT_ROLES:
            raise ExperimentError(f'{where}: "{effect.name}" acts at a body, not at an environment')
        body = body.with_effect(effect)
    return body.with_values(parameters)


def joint_with_links(description: BodyDescription) -> BodyDescription:
    """A joint of an arm as a body with fixed inertia: that of its motor, or zero if not stated."""
    motor = description.inertia or ModelValue(0.0, None, True, description.where)
    return replace(description, inertia=replace(motor, fixed=True))


def free_body_of(description: BodyDescription, known: Mapping[str, Effect]) -> Body:
    """As `body_of`, for a body without an environment, which `with_environment` adds.

    raises ExperimentError: also where an effect acts at an environment
    """
    for name in description.effects:
        if name in known and known[name].role in CONTACT_ROLES:
            raise ExperimentError(
                f'{description.where}.effects: "{name}" acts at an environment: '
                "see [model.environment.effects]"
            )
    return body_of(description, known)
