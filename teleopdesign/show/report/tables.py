"""The tables of a report in SI: parameters, added effects, records, channels."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping
from typing import Any

from ...base.errors import ExperimentError
from ...base.files import make_plain
from ...base.units import unit_of
from ...blocks import CONTACT, NINETY_FIVE, Value
from ...diagnose import Diagnosis, Fit
from ...effects import EFFECTS
from ...measurement.channel import BODY_QUANTITIES, Channel
from ...measurement.experiment import Experiment
from ...measurement.reading import log_name
from ...model import Model
from .candidate_table import PageRow


def correlation_rows(fit: Fit) -> tuple[PageRow, ...]:
    """Every estimate that the records move, with correlations with those before it, and 1."""
    known = fit.correlations
    moved = {name for pair in known for name in pair}
    names = [name for name in fit.free if name in moved]
    return tuple(
        {"name": name, "values": (*(known[name, other] for other in names[:k]), 1.0)}
        for k, name in enumerate(names)
    )


def parameter_rows(diagnosis: Diagnosis) -> tuple[PageRow, ...]:
    """Every parameter of the user's model and of the last model of the diagnosis, in SI.

    stated: as written in the experiment, None if it leaves the parameter open
    before, before_stderr: re-estimated, None if the effect was added
    after, stderr: None if another effect replaced the effect;  gave_way_to: its name, else ""
    low, high: 95 % interval, cut at the physical bounds
    """
    stated, before = _stated_values(diagnosis), diagnosis.before.model.parameters
    added = {r.added.key for r in diagnosis.rungs if r.added is not None}
    rows = []
    for name, value in diagnosis.model.parameters.items():
        declared = diagnosis.model.declared(name)
        low, high = _interval(value, declared.lower, declared.upper)
        row = _row(diagnosis.model, name, stated, before.get(name)) | {
            "after": value.value,
            "stderr": None if value.fixed else make_plain(value.stderr),
            "low": low,
            "high": high,
            "at_bound": name in diagnosis.at_bound,
        }
        rows.append(row | {"added": (row["effect"], row["at"]) in added})
    return (*rows, *_rows_removed(diagnosis, stated))


def _rows_removed(diagnosis: Diagnosis, stated: Mapping[str, float]) -> list[PageRow]:
    """The parameters of effects in the user's model that other effects replaced."""
    model, there = diagnosis.before.model, diagnosis.model.parameters
    instead = {(r.instead_of, r.added.at): r.added for r in diagnosis.rungs if r.added}
    rows = [_row(model, name, stated, v) for name, v in model.parameters.items()]
    return [
        row | {"gave_way_to": by.effect.name}
        for row in rows
        if row["name"] not in there and (by := instead.get((row["effect"], row["at"]))) is not None
    ]


def _row(
    model: Model, name: str, stated: Mapping[str, float], before: Value | None
) -> dict[str, Any]:
    """The row of a parameter, without what was estimated at the end;  before: its first estimate"""
    place, _, local = name.partition(".")
    effect, _, parameter = local.rpartition(".")
    return {
        "name": name,
        "at": place,
        "effect": effect,
        "parameter": parameter,
        "meaning": model.declared(name).meaning,
        "unit": model.unit(name),
        "stated": stated.get(name),
        "before": None if before is None else before.value,
        "before_stderr": None if before is None else make_plain(before.stderr),
        **dict.fromkeys(("after", "stderr", "low", "high")),
        "fixed": model.parameters[name].fixed,
        **dict.fromkeys(("at_bound", "added"), False),
        "gave_way_to": "",
    }


def added_effects(diagnosis: Diagnosis, rows: tuple[PageRow, ...]) -> tuple[PageRow, ...]:
    """The description of each added effect, from its file, and the rows of its parameters."""
    return tuple(
        {
            "effect": r.added.effect.name,
            "at": r.added.at,
            "alike": tuple(str(one.candidate) for one in r.alternatives),
            "title": r.added.effect.title,
            "law": r.added.effect.text.strip(),
            "source": r.added.effect.source,
            "parameters": tuple(p for p in rows if (p["effect"], p["at"]) == r.added.key),
        }
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


def record_rows(experiment: Experiment) -> tuple[PageRow, ...]:
    """Every record of the experiment; duration: s, rate: Hz, NaN on friction curves."""
    return tuple(
        {
            "file": r.file,
            "use": r.use,
            "samples": len(r.time),
            "duration": math.nan if r.is_curve else r.duration,
            "rate": math.nan if r.is_curve else 1.0 / r.sample_time,
            "segments": len(r.segments),
            "offset_names": tuple(sorted(n.replace("_", " ") for n in r.offset_names)),
            "digest": _digest(experiment, r.file),
        }
        for r in experiment.records
    )


def _digest(experiment: Experiment, file: str) -> str:
    """SHA-256 of a record's log; "" if the log no longer exists.

    For a folder (a bag): of its files one after the other, sorted by name.
    """
    path = experiment.folder / file
    if not path.exists():  # a part of a log
        path = experiment.folder / log_name(file)
    files = sorted(p for p in path.rglob("*") if p.is_file()) if path.is_dir() else [path]
    whole = hashlib.sha256()
    try:
        for one in files:
            with one.open("rb") as stream:
                hashlib.file_digest(stream, lambda: whole)
    except OSError:
        return ""
    return whole.hexdigest()


def channel_rows(experiment: Experiment) -> tuple[PageRow, ...]:
    """Every channel as described; resolution and noise in SI (`si_unit`), None if not stated."""
    return tuple(
        {n: getattr(c, n) for n in ("column", "unit", "resolution", "noise")}
        | {"name": name, "si_unit": _si_unit(experiment, c)}
        for name, c in experiment.channels.items()
    )


def _si_unit(experiment: Experiment, channel: Channel) -> str:
    """The SI unit of a channel of a body; "" of any other."""
    if channel.body is None:
        return ""
    return unit_of(BODY_QUANTITIES[channel.quantity], experiment.axis(channel.body))
