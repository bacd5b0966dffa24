"""Bodies from what files describe: the one place where written values meet an effect's parameters.

The same table is a body in experiment.toml, in a diagram's file and in an answer. A value with a
unit is converted and its unit checked; a plain number is in SI.
"""

from __future__ import annotations

from collections.abc import Mapping

from ..effects import Effect, Parameter, find_effect
from ..errors import ExperimentError, ModelError, did_you_mean
from ..measurement.description import BodyDescription, Effects, ModelValue
from ..quantity import after_number, unit_of
from .body import INERTIA, Body
from .value import Value


def body_of(
    description: BodyDescription, known: Mapping[str, Effect], *, complete: bool = False
) -> Body:
    """The body that is described, in SI.

    known: effects by name;  complete: every parameter that is not optional is required; else one
        that is left out is open, and stands where its effect is absent
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
                    f'{where}.{name}: no parameter "{key}", has {", ".join(effect.parameters)}'
                    f"{did_you_mean(key, effect.parameters)}"
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
    """A value in SI; raises ExperimentError: wrong unit, or out of the parameter's bounds."""
    number, error = written.in_si(parameter.quantity, axis)
    if not parameter.lower <= number <= parameter.upper:
        unit = written.unit or unit_of(parameter.quantity, axis)
        raise ExperimentError(
            f"{written.where}: {written.value:g}{after_number(unit)} is outside "
            f"{parameter.lower:g} .. {parameter.upper:g}"
        )
    return Value(number, written.fixed) if error is None else Value(number, written.fixed, error)
