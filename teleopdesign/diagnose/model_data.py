"""Bodies and effects of a model as plain data, as in experiments, diagrams and answers."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from ..base.codec import Error, from_data
from ..base.errors import ExperimentError, did_you_mean, quote
from ..base.toml import Table, describe_toml_value
from ..blocks import Body, Value, with_block_effects
from ..blocks.described import body_of
from ..effects import Effect
from ..measurement.arm_description import joints_from
from ..measurement.description import ONE_BODY, TWO_BODIES, bodies_from
from ..model import Model
from ..realise.stages_along import RECORD_SHIFT
from .candidates import Candidate

#: key of an arm's base parameters beside its bodies
LINKS = "links"


@dataclass(frozen=True)
class Place:
    """An effect and its place, as answers write them."""

    effect: str
    at: str


def place_data(candidate: Candidate) -> dict[str, str]:
    """An effect and its place, as answers write them."""
    return {"effect": candidate.effect.name, "at": candidate.at}


def model_data(model: Model) -> dict[str, Any]:
    """The bodies by their places, the shifts of their records, an arm's base parameters; SI."""
    data: dict[str, Any] = {place: body_data(body) for place, body in model.bodies.items()}
    if model.record_shift:
        data[RECORD_SHIFT] = {
            place: {"value": late.value, "unit": "s", "fixed": late.fixed} | _error(late)
            for place, late in model.record_shift.items()
        }
    if model.links:
        data[LINKS] = list(model.links)
    return data


def model_of_body(model: Model, place: str) -> Model:
    """The model of one of its bodies, with the shifts of its records and the links of its arm."""
    late = {n: x for n, x in model.record_shift.items() if n.partition(".")[0] == place}
    return replace(model, bodies={place: model.bodies[place]}, record_shift=late)


def body_data(body: Body) -> dict[str, Any]:
    """A body as the table that `measurement.description.body_from` reads.

    A value that is not finite is left out: its effect is absent there, and a reader restores it so.
    """
    return {
        "axis": body.axis,
        "inertia": _value(body, "inertia"),
        "effects": {
            e.name: {
                p: _value(body, f"{e.name}.{p}")
                for p in e.parameters
                if math.isfinite(body.parameters[f"{e.name}.{p}"].value)
            }
            for e in body.effects
        },
    }


def _value(body: Body, name: str) -> dict[str, Any]:
    value = body.parameters[name]
    data = {"value": value.value, "unit": body.unit(name), "fixed": value.fixed}
    return data | _error(value)


def _error(value: Value) -> dict[str, float]:
    return {"stderr": value.stderr} if math.isfinite(value.stderr) else {}


def model_from(
    content: Any,
    known: Mapping[str, Effect],
    where: str,
    *,
    may_take: Mapping[str, Effect] | None = None,
) -> Model:
    """The model of data that `model_data` wrote.

    known: effects by name;  where: place of the data in their file, for messages
    may_take: the effects that may be added to the model; None: all that are known
    raises ExperimentError: the data are no model, or an effect is unknown
    """
    if not isinstance(content, dict):
        raise ExperimentError(f"{where}: found {describe_toml_value(content)}, expected a table")
    bodies, effects = {}, with_block_effects(known)
    at = f"{where}.{RECORD_SHIFT}"
    shifts = from_data(Mapping[str, _Shift], content.get(RECORD_SHIFT, {}), at, {})
    links = from_data(tuple[float, ...], content.get(LINKS, []), f"{where}.{LINKS}", {})
    content = {n: body for n, body in content.items() if n not in (RECORD_SHIFT, LINKS)}
    of_arm = bool(content) and not content.keys() & {*ONE_BODY, *TWO_BODIES}
    read = joints_from if of_arm else bodies_from
    for place, described in read(Table(content, where)).items():
        for name in described.effects:
            known_effect(name, effects, where=f"{described.where}.effects")
        bodies[place] = body_of(described, effects)
    late = {log: Value(one.value, one.fixed, one.stderr) for log, one in shifts.items()}
    return Model(bodies, known if may_take is None else may_take, late, links)


@dataclass(frozen=True)
class _Shift:
    """The shift of a record, s."""

    value: float
    fixed: bool = False
    stderr: Error = math.nan


def known_effect(name: str, known: Mapping[str, Effect], *, where: str) -> Effect:
    """The effect of that name.

    raises ExperimentError: the name is unknown; the message asks for the file of a user's effect
    """
    if name not in known:
        raise ExperimentError(
            f"{where}: no effect {quote(name)}{did_you_mean(name, known)}; "
            "if it is your own, give its file with --effect FILE"
        )
    return known[name]
