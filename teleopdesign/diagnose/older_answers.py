"""Answers of earlier versions: their content in the keys of this version, as far as it goes.

Versions before the models of each row were written hold the parameters of the final model alone.
They state neither axes nor fixed parameters: these come from the experiment, else the axes follow
from the units of the inertias, and only chosen parameters are fixed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

from ..base.codec import At, Error, Filled, Size, from_data
from ..base.errors import ExperimentError, quote
from ..base.units import AXES, unit_of
from ..blocks import CONTACT
from ..effects import Effect, are_alike
from ..measurement.bandwidth import bandwidth_of
from ..measurement.experiment import Experiment
from ..measurement.logger_clock import CLOCK
from ..model import Model


@dataclass(frozen=True)
class Place:
    """An effect and its place, as answers write them."""

    effect: str
    at: str


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
class _OfRecord:
    record: str


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
    offsets: Annotated[tuple[_OfRecord, ...], At("own")] = ()
    one_moment: _OfRecord | None = None
    bandwidth: Annotated[float, At("bandwidth.value")] = float("nan")


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
        if experiment is not None and (differs := _difference(old, content, experiment)):
            raise ExperimentError(
                f"is not an answer to {experiment.folder.name} but to another experiment: {differs}"
            )
        last = _bodies(old, experiment, known)
        new["models"] = {"ladder": [*([None] * (len(old.ladder) - 1)), last]}
        new["bandwidth"] = content.get("bandwidth", {"value": None})
    new.setdefault("held_out", old.check == "blocks of fit")
    new["floor"] = content.get("floor", {"drawn": old.noise_floor})
    new["ladder"] = [_row(row, i, old, known) for i, row in enumerate(content["ladder"])]
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


def _row(
    row: dict[str, Any], number: int, old: _Answer, known: Mapping[str, Effect]
) -> dict[str, Any]:
    """A row of the ladder with its look-alikes, and whether its effect is named.

    Where no error at the command was written, no effect lay between command and force.
    """
    added = old.ladder[number].added
    row = {"check_error_at_command": row["check_error"], **row}
    if added is None:
        return row
    groups = (g for g in old.indistinguishable if g[:1] == (added,) and not _is_named(g, known))
    alike = [{"effect": one.effect, "at": one.at} for one in next(groups, ())[1:]]
    return {"alternatives": alike, "named": added in old.missing, **row}


def _is_named(group: tuple[Place, ...], known: Mapping[str, Effect]) -> bool:
    """Whether a group is a pair that leaves no verdict open: one of the two is the commoner."""
    effects = [known.get(place.effect) for place in group]
    one, other = effects[0], effects[-1]
    return len(group) == 2 and one is not None and other is not None and are_alike(one, other)


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
    fixed = {name for name, value in stated.items() if value.fixed}
    places = list(dict.fromkeys(name.partition(".")[0] for name in parameters))
    bodies = [place for place in places if place != CONTACT.name]
    tables: dict[str, Any] = {}
    for place in bodies:
        name = f"{place}.inertia"
        if name not in parameters:
            raise ExperimentError(f'model_parameters: no key "{name}"')
        axis = experiment.axis(place) if experiment else _axis_of(name, parameters[name].unit)
        inertia = _value(parameters[name], name in fixed)
        tables[place] = {"axis": axis, "inertia": inertia, "effects": {}}
    for name, parameter in parameters.items():
        place, _, local_name = name.partition(".")
        if local_name == "inertia" or not bodies:
            continue
        effect, _, key = local_name.rpartition(".")
        if place == CONTACT.name:
            effect = effect or place  # environment.stiffness belongs to the contact
        if not effect:
            raise ExperimentError(f"model_parameters: no body has a {quote(name)}")
        holder = bodies[-1] if place == CONTACT.name else place
        row = tables[holder]["effects"].setdefault(effect, {})
        if parameter.value == parameter.value:
            row[key] = _value(parameter, name in fixed or _is_chosen(known.get(effect), key))
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


def _difference(old: _Answer, content: Mapping[str, Any], experiment: Experiment) -> str | None:
    """How an answer without a fingerprint contradicts this experiment; None where it does not."""
    if "experiment" in content:
        return None
    places = dict.fromkeys(name.partition(".")[0] for name in old.model_parameters)
    bodies = [place for place in places if place != CONTACT.name]
    if bodies != list(experiment.bodies):
        return f"bodies {', '.join(bodies) or 'none'}, found {', '.join(experiment.bodies)}"
    for place in bodies:
        unit, inertia = unit_of("inertia", experiment.axis(place)), f"{place}.inertia"
        if inertia in old.model_parameters and old.model_parameters[inertia].unit != unit:
            return f"{inertia} in {quote(old.model_parameters[inertia].unit)}, found {quote(unit)}"
    stated = {place: set(body.effects) for place, body in experiment.bodies.items()}
    touched = experiment.environment
    stated[CONTACT.name] = set() if touched is None else set(touched.effects)
    for name in old.model_parameters:
        place, _, local_name = name.partition(".")
        effect = local_name.partition(".")[0] if "." in local_name else ""
        if effect and effect not in stated[place]:
            return f"a model with {effect} at {place}, found {', '.join(stated[place]) or 'none'}"
    check = "records" if experiment.check_records else "blocks of fit"
    if old.check not in ("", check):
        return f"check by {old.check}, found {check}"
    files = {r.file for r in experiment.records}
    named_records = [*old.offsets, *([old.one_moment] if old.one_moment else [])]
    if others := [one.record for one in named_records if one.record not in files]:
        return f"a record {quote(others[0])}, found {', '.join(sorted(files))}"
    stated_band = experiment.bandwidth is not None and old.bandwidth == old.bandwidth
    if stated_band and old.bandwidth != (now := bandwidth_of(experiment)):
        return f"bandwidth {old.bandwidth:g} Hz, found {now:g} Hz"
    return None
