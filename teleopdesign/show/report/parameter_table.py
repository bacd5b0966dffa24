"""Parameters of a diagnosis, as stated, before and after; and the effects that were added."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from ...base.errors import ExperimentError
from ...base.files import make_plain
from ...blocks import CONTACT, NINETY_FIVE, Value
from ...diagnose import Diagnosis, Fit
from ...effects import EFFECTS
from ...model import Model


@dataclass(frozen=True)
class ParameterRow:
    """A parameter in SI: as written in the experiment, re-estimated before, and after.

    stated: None if the experiment leaves it open;  before: None if its effect was added
    after: None if another effect replaced its effect;  gave_way_to: name of the other effect, else
        ""
    low, high: 95 % interval, cut at the physical bounds
    """

    name: str
    at: str
    effect: str
    parameter: str
    meaning: str
    unit: str
    stated: float | None
    before: float | None = None
    before_stderr: float | None = None
    after: float | None = None
    stderr: float | None = None
    low: float | None = None
    high: float | None = None
    fixed: bool = False
    at_bound: bool = False
    added: bool = False
    gave_way_to: str = ""


@dataclass(frozen=True)
class CorrelationRow:
    """Correlations of an estimate with those of the rows before it, and 1 with itself."""

    name: str
    values: tuple[float, ...]


def correlation_rows(fit: Fit) -> tuple[CorrelationRow, ...]:
    """Every estimate that the records move, in the order of the parameters."""
    known = fit.correlations
    moved = {name for pair in known for name in pair}
    names = [name for name in fit.free if name in moved]
    return tuple(
        CorrelationRow(name, (*(known[name, other] for other in names[:k]), 1.0))
        for k, name in enumerate(names)
    )


@dataclass(frozen=True)
class AddedEffect:
    """An effect that was added: its description, and the rows of its parameters."""

    effect: str
    at: str
    alike: tuple[str, ...]
    title: str
    law: str
    source: str
    parameters: tuple[ParameterRow, ...]


def parameter_rows(diagnosis: Diagnosis) -> tuple[ParameterRow, ...]:
    """Every parameter of the user's model and of the last model of the diagnosis."""
    stated, before = _stated_values(diagnosis), diagnosis.before.model.parameters
    added = {r.added.key for r in diagnosis.rungs if r.added is not None}
    rows = []
    for name, value in diagnosis.model.parameters.items():
        row, first = _row(diagnosis.model, name, stated), before.get(name)
        declared = diagnosis.model.declared(name)
        low, high = _interval(value, declared.lower, declared.upper)
        rows.append(
            replace(
                row,
                before=None if first is None else first.value,
                before_stderr=None if first is None else make_plain(first.stderr),
                after=value.value,
                stderr=None if value.fixed else make_plain(value.stderr),
                low=low,
                high=high,
                at_bound=name in diagnosis.at_bound,
                added=(row.effect, row.at) in added,
            )
        )
    return (*rows, *_rows_removed(diagnosis, stated))


def _rows_removed(diagnosis: Diagnosis, stated: Mapping[str, float]) -> list[ParameterRow]:
    """The parameters of effects in the user's model that other effects replaced."""
    model, there = diagnosis.before.model, diagnosis.model.parameters
    instead = {(r.instead_of, r.added.at): r.added for r in diagnosis.rungs if r.added}
    rows = []
    for name, value in model.parameters.items():
        row = _row(model, name, stated)
        by = instead.get((row.effect, row.at))
        if name not in there and by is not None:
            first, error = value.value, make_plain(value.stderr)
            rows.append(replace(row, before=first, before_stderr=error, gave_way_to=by.effect.name))
    return rows


def _row(model: Model, name: str, stated: Mapping[str, float]) -> ParameterRow:
    """The row of a parameter, without what was estimated."""
    place, effect, parameter = _parts(name)
    return ParameterRow(
        name=name,
        at=place,
        effect=effect,
        parameter=parameter,
        meaning=model.declared(name).meaning,
        unit=model.unit(name),
        stated=stated.get(name),
        fixed=model.parameters[name].fixed,
    )


def _parts(name: str) -> tuple[str, str, str]:
    """Place, effect ("" for a parameter of the body) and parameter in a full name."""
    place, _, local = name.partition(".")
    effect, _, parameter = local.rpartition(".")
    return place, effect, parameter


def added_effects(diagnosis: Diagnosis, rows: tuple[ParameterRow, ...]) -> tuple[AddedEffect, ...]:
    """The description of each added effect, from its file."""
    return tuple(
        AddedEffect(
            effect=r.added.effect.name,
            at=r.added.at,
            alike=tuple(str(one.candidate) for one in r.alternatives),
            title=r.added.effect.title,
            law=r.added.effect.text.strip(),
            source=r.added.effect.source,
            parameters=tuple(p for p in rows if (p.effect, p.at) == r.added.key),
        )
        for r in diagnosis.rungs
        if r.added is not None
    )


def _stated_values(diagnosis: Diagnosis) -> dict[str, float]:
    """Values in the experiment's file, by full name (SI)."""
    experiment = diagnosis.experiment
    try:
        # a diagnosis among some effects knows no others; the file's model may have them
        model = Model.from_experiment(experiment, {**EFFECTS, **diagnosis.model.known})
    except ExperimentError:  # diagnosed with another model: the file's cannot be built
        return {}
    stated = {f"{place}.inertia" for place in experiment.bodies}
    for place, body in experiment.bodies.items():
        stated |= {f"{place}.{e}.{p}" for e, values in body.effects.items() for p in values}
    if experiment.environment is not None:
        at = CONTACT.name
        stated |= {f"{at}.{p}" for p in experiment.environment.values}
        effects = experiment.environment.effects.items()
        stated |= {f"{at}.{e}.{p}" for e, values in effects for p in values}
    return {n: v.value for n, v in model.parameters.items() if n in stated}


def _interval(value: Value, lower: float, upper: float) -> tuple[float | None, float | None]:
    if value.fixed or not math.isfinite(value.stderr):
        return None, None
    half = NINETY_FIVE * value.stderr
    return max(value.value - half, lower), min(value.value + half, upper)
