"""Answers of earlier versions: their content in the keys of this version, as far as it goes.

Versions before the models of each row were written hold the parameters of the final model alone.
They state neither axes nor fixed parameters: the axes follow from the units of the inertias, and
what is fixed from the experiment; without one only chosen parameters are.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

from ..base.codec import Error, Filled, Size, from_data
from ..base.errors import ExperimentError, quote
from ..base.units import AXES, unit_of
from ..blocks import CONTACT
from ..effects import Effect
from ..measurement.experiment import Experiment
from ..measurement.record_clock import CLOCK
from ..model import Model
from .model_data import Place


@dataclass(frozen=True)
class _Row:
    added: Place | None
    fit_error: Error
    check_error: Error


@dataclass(frozen=True)
class _Parameter:
    value: float
    stderr: Error
    unit: str


@dataclass(frozen=True)
class _Candidate:
    effect: str
    at: str
    parameters: Mapping[str, _Parameter]


@dataclass(frozen=True)
class _Shift:
    value: float
    rows: float
    like_a_delay: bool = False


@dataclass(frozen=True)
class _Answer:
    """What every version has written, and what is needed of it here."""

    verdict: str
    missing: tuple[Place, ...]
    ladder: Annotated[tuple[_Row, ...], Filled(1)]
    noise_floor: Size
    candidates: tuple[_Candidate, ...]
    indistinguishable: tuple[tuple[Place, ...], ...]
    model_parameters: Mapping[str, _Parameter]
    record_shift: Mapping[str, _Shift] = field(default_factory=dict)
    check: str = ""


def upgrade_content(
    content: dict[str, Any],
    known: Mapping[str, Effect],
    experiment: Experiment | None,
    *,
    whole: str = "",
    at: str = "",
) -> dict[str, Any]:
    """The content of an answer with all keys that this version reads.

    known: effects by name;  experiment: of the answer; None: not known
    whole: what the file should be, for messages;  at: place of the content in the file
    raises ExperimentError: the content is no answer, or one to another experiment
    """
    old: _Answer = from_data(_Answer, content, at.rstrip("."), {}, whole=whole)
    new = {"noise_floor_source": "as the answer says", **content}
    if "models" not in content:
        if experiment is not None and "experiment" not in content:
            _require_parameters_of(experiment, old, known)
        last = _bodies(old, experiment, known)
        new["models"] = {"ladder": [*([None] * (len(old.ladder) - 1)), last]}
        new["bandwidth"] = content.get("bandwidth", {"value": None})
    new.setdefault("held_out", old.check == "blocks of fit")
    new["floor"] = content.get("floor", {"drawn": old.noise_floor})
    new["ladder"] = [_row(row, i, old) for i, row in enumerate(content["ladder"])]
    new["record_shift"] = {
        log: _shift(log, old.record_shift[log]) | data
        for log, data in content.get("record_shift", {}).items()
    }
    new["links"] = {
        name.removeprefix("arm."): row
        for name, row in content["model_parameters"].items()
        if name.startswith("arm.")
    }
    joints = from_data(Mapping[str, Mapping[str, Any]], content.get("joints", {}), "joints", {})
    new["joints"] = {
        name: upgrade_content(dict(one), known, None, at=f"{at}joints.{name}.")
        for name, one in joints.items()
    }
    return new


def _row(row: dict[str, Any], number: int, old: _Answer) -> dict[str, Any]:
    """A row of the ladder with its look-alikes, and whether its effect is named.

    Where no error at the command was written, no effect lay between command and force.
    """
    added = old.ladder[number].added
    row = {"check_error_at_command": row["check_error"], **row}
    if added is None:
        return row
    alike = next((group[1:] for group in old.indistinguishable if group[:1] == (added,)), ())
    places = [{"effect": one.effect, "at": one.at} for one in alike]
    return {"alternatives": places, "named": added in old.missing, **row}


def _shift(log: str, old: _Shift) -> dict[str, Any]:
    """What a shift of a record lacked; that of a hand's force was measured."""
    row = old.value / old.rows if old.rows else 1e-3
    return {
        "at": log,
        "row": row,
        "may_delay": old.like_a_delay,
        "latest": max(CLOCK.early * row, CLOCK.latest),
        "measured": "." in log,
    }


def _bodies(
    old: _Answer, experiment: Experiment | None, known: Mapping[str, Effect]
) -> dict[str, Any]:
    """The bodies of the final model as tables, from the full names of its parameters.

    raises ExperimentError: a body has no inertia, or a name belongs to no body
    """
    parameters = _parameters(old)
    stated = {} if experiment is None else Model.from_experiment(experiment, known).parameters
    tables: dict[str, Any] = {}
    for name, parameter in parameters.items():
        place, _, local_name = name.partition(".")
        effect, _, key = local_name.rpartition(".")
        holder = place
        if place == CONTACT.name:
            effect = effect or place  # environment.stiffness belongs to the contact
            holder = list(tables)[-1] if tables else place
        if holder not in tables:
            if (inertia := f"{holder}.inertia") not in parameters:
                raise ExperimentError(f'model_parameters: no key "{inertia}"')
            axis = _axis_of(inertia, parameters[inertia].unit)
            tables[holder] = {"axis": axis, "effects": {}}
        is_fixed = name in stated and stated[name].fixed
        value = _value(parameter, is_fixed or _is_chosen(known.get(effect), key))
        if local_name == "inertia":
            tables[holder]["inertia"] = value
        elif not effect:
            raise ExperimentError(f"model_parameters: no body has a {quote(name)}")
        else:
            row = tables[holder]["effects"].setdefault(effect, {})
            row |= {key: value} if parameter.value == parameter.value else {}
    return tables


def _parameters(old: _Answer) -> dict[str, _Parameter]:
    """Every parameter of the final model by its full name: of the user's effects, then of each row.

    raises ExperimentError: an effect of the ladder is not among the candidates
    """
    parameters = dict(old.model_parameters)
    rows = {(c.effect, c.at): c.parameters for c in old.candidates}
    for place in (row.added for row in old.ladder if row.added is not None):
        if (place.effect, place.at) not in rows:
            raise ExperimentError(
                f"candidates: none is {place.effect} at {place.at}, which the ladder adds"
            )
        theirs = rows[place.effect, place.at].items()
        parameters |= {f"{place.at}.{place.effect}.{n}": p for n, p in theirs}
    return parameters


def _value(parameter: _Parameter, fixed: bool) -> dict[str, Any]:
    known = parameter.stderr == parameter.stderr
    error = {"stderr": parameter.stderr} if known else {}
    return {"value": parameter.value, "unit": parameter.unit, "fixed": fixed} | error


def _is_chosen(effect: Effect | None, key: str) -> bool:
    return effect is not None and key in effect.parameters and effect.parameters[key].search.chosen


def _axis_of(name: str, unit: str) -> str:
    """The axis of a body, by the unit of its inertia (SI).

    raises ExperimentError: the unit is that of no axis
    """
    for axis in AXES:
        if unit == unit_of("inertia", axis):
            return axis
    raise ExperimentError(
        f"model_parameters.{name}.unit: found {quote(unit)}, expected "
        f"{' or '.join(quote(unit_of('inertia', a)) for a in AXES)}: the answer of an earlier "
        "version, it says no axis"
    )


def _require_parameters_of(
    experiment: Experiment, old: _Answer, known: Mapping[str, Effect]
) -> None:
    """Refuse the answer to an experiment whose model has other parameters.

    raises ExperimentError: with the first one that differs
    """
    model = Model.from_experiment(experiment, known)
    units = {name: model.unit(name) for name in model.parameters}
    for name, one in old.model_parameters.items():
        if units.get(name) != one.unit:
            raise ExperimentError(
                f"is not an answer to {experiment.folder.name} but to another experiment: {name} "
                f"in {quote(one.unit)}, found {quote(units.get(name, 'no such parameter'))}"
            )
