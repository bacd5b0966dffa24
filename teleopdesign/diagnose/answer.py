"""The diagnosis as text and as the answer file, with the predictions that anyone can recompute."""

from __future__ import annotations

import csv
import gzip
import math
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from io import TextIOWrapper
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from ..model import Model
from ..plain_data import plain, replacing, write_json
from ..quantity import unit_of
from ..realise.along_motion import residual_along
from .answers.bodies import model_data
from .answers.fingerprint import experiment_data
from .diagnosis import Diagnosis
from .fit import Fit
from .force_error import along_own, own_groups
from .one_moment import Moment
from .open_questions import open_questions
from .probability import CandidateEvidence, evidence_of
from .rank import REFUSALS


def answer(diagnosis: Diagnosis) -> dict[str, Any]:
    """The answer as plain data: verdict, ladder, candidates, parameters; SI units."""
    checked = bool(diagnosis.experiment.check_records)
    return {
        "verdict": diagnosis.verdict,
        "missing": [_place(c.key) for c in diagnosis.missing],
        "ladder": [
            {
                "added": None if r.added is None else _place(r.added.key),
                "fit_error": r.fit.fit_error,
                "check_error": r.fit.check_error,
                "check_error_at_command": plain(r.fit.seen.error),
                "blind": r.fit.seen.blind,
            }
            for r in diagnosis.rungs
        ],
        "blind": diagnosis.after.seen.blind,
        "noise_floor": diagnosis.floor.value,
        "noise_floor_source": diagnosis.floor.source,
        "check": "records" if checked else "blocks of fit",
        "bandwidth": {"value": diagnosis.prepared.bandwidth, "unit": "Hz"},
        "candidates": _candidates(diagnosis),
        "indistinguishable": [[_place(c.key) for c in g] for g in diagnosis.groups],
        "own": _own(diagnosis),
        "model_parameters": _parameters(diagnosis.after, _added(diagnosis)),
        "left_over_noise_floors": plain(diagnosis.left),
        "one_moment": _moment(diagnosis.moment),
        "at_bound": list(diagnosis.after.at_bound),
        "evidence": [_evidence(one) for one in evidence_of(diagnosis) if one.share > 0],
        "experiment": experiment_data(diagnosis.experiment),
        "models": {
            "ladder": [model_data(r.fit.model) for r in diagnosis.rungs],
            "estimated": model_data(diagnosis.estimated.model),
        },
        "floor": {"drawn": diagnosis.floor.drawn, "held": diagnosis.floor.held},
        "open": _open(diagnosis),
    }


def _open(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """What the records leave open: an accepted effect, and others with the models they were in."""
    return [
        {
            "added": None if question.added is None else _place(question.added.key),
            "others": [
                _place(c.key) | {"model": model_data(fit.model)} for c, fit in question.others
            ],
        }
        for question in open_questions(diagnosis)
    ]


def _moment(moment: Moment | None) -> dict[str, Any] | None:
    """The moment that holds all that is left above noise."""
    if moment is None:
        return None
    return {
        "record": moment.file,
        "at": moment.body,
        "begin": {"value": moment.begin, "unit": "s"},
        "end": {"value": moment.end, "unit": "s"},
        "left_over_noise_floors_without": moment.without,
    }


def _own(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """What records have of their own by the model that the diagnosis ends with."""
    stretches, rows = diagnosis.prepared.stretches, []
    for group, own in own_groups(diagnosis.model, stretches):
        motion = stretches[group[0]].motion
        units = {
            "position_zero": unit_of("position", own.body.axis),
            "bias": unit_of("force", own.body.axis),
            "friction_level": "of the model's",
        }
        rows += [
            {"record": motion.file, "at": motion.body, "of": n, "value": v, "unit": units[n]}
            for n, v in own.values.items()
        ]
    return rows


def _place(key: tuple[str, str]) -> dict[str, str]:
    return {"effect": key[0], "at": key[1]}


def _added(diagnosis: Diagnosis) -> set[str]:
    return {f"{r.added.at}.{r.added.effect.name}" for r in diagnosis.rungs if r.added is not None}


def _parameter(model: Model, name: str) -> dict[str, Any]:
    value = model.parameters[name]
    return {
        "value": plain(value.value),
        "stderr": plain(value.stderr),
        "unit": model.unit(name),
    }


def _parameters(found: Fit, without: Iterable[str] = ()) -> dict[str, Any]:
    skip = set(without)
    return {
        n: _parameter(found.model, n)
        for n in found.model.parameters
        if n.rpartition(".")[0] not in skip
    }


def _candidates(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """Every effect tried, most probable first: on the step that accepted it, or its best one."""
    best: dict[tuple[str, str], CandidateEvidence] = {}
    for one in evidence_of(diagnosis):
        before = best.setdefault(one.ranked.candidate.key, one)
        if (one.accepted, one.probability()) > (before.accepted, before.probability()):
            best[one.ranked.candidate.key] = one
    rows = [_row(diagnosis, one) for one in best.values()]
    return sorted(rows, key=lambda c: -c["probability"])


def _evidence(one: CandidateEvidence) -> dict[str, Any]:
    """What the probability of a candidate rests on, a row a step that took it seriously."""
    return _place(one.ranked.candidate.key) | {
        "accepted": one.accepted,
        "as_good": one.as_good,
        "score": plain(one.ranked.score),
        "share": one.share,
        "explained": one.explained,
    }


def _row(diagnosis: Diagnosis, one: CandidateEvidence) -> dict[str, Any]:
    candidate, found = one.ranked.candidate, one.ranked.fit
    effect, at = candidate.key
    if one.accepted:  # fitted again with what was exchanged or left out since: as in the ladder
        found = next(r.fit for r in diagnosis.rungs if r.added == candidate)
    model = found.model
    if one.accepted and diagnosis.model.body(at).has(effect):
        model = diagnosis.model  # all parameters are re-estimated with each effect that follows
    return {
        "effect": effect,
        "at": at,
        "probability": one.probability(),
        "check_error": found.check_error,
        "check_error_at_command": plain(found.seen.error),
        "blind": found.seen.blind,
        "refused": REFUSALS.get(one.ranked.refused),
        "parameters": {
            n: _parameter(model, f"{at}.{effect}.{n}") for n in candidate.effect.parameters
        },
    }


def write_answer(diagnosis: Diagnosis, path: str | Path) -> None:
    """Write the answer as JSON."""
    write_json(path, answer(diagnosis))


def write_predictions(diagnosis: Diagnosis, path: str | Path) -> None:
    """Write measured and modelled force, a row a sample of every record; .csv or .csv.gz.

    `BODY.measured` is actuator plus interaction force as recorded; residuals are not low-passed
    beyond the smoothing of the motion, so that their low-passed figures can be recomputed.
    """
    path = Path(path)
    bodies = list(diagnosis.experiment.bodies)
    head = ["record", "t"]
    for body in bodies:
        head += [f"{body}.{q}" for q in ("measured", "model_before", "model_after")]
        head += [f"{body}.residual_before", f"{body}.residual_after"]
    with replacing(path) as part, _opened(part, path) as file:
        out = csv.writer(file)
        out.writerow(head)
        for record in diagnosis.experiment.records:
            columns = _predicted(diagnosis, record.file)
            for k in range(len(record.time)):
                out.writerow(
                    [record.file, f"{record.time[k]:.9g}", *(f"{c[k]:.7g}" for c in columns)]
                )


@contextmanager
def _opened(part: Path, path: Path) -> Iterator[TextIO]:
    """A text file to write to, packed where the name says so; the name within is the path's."""
    with part.open("wb") as raw:
        if path.suffix != ".gz":
            with TextIOWrapper(raw, encoding="utf-8", newline="") as file:
                yield file
            return
        with gzip.GzipFile(path.name, "wb", fileobj=raw) as packed:
            with TextIOWrapper(packed, encoding="utf-8", newline="") as file:
                yield file


def _predicted(diagnosis: Diagnosis, file: str) -> list[np.ndarray]:
    record = next(r for r in diagnosis.experiment.records if r.file == file)
    columns: list[np.ndarray] = []
    stretches = [s for s in diagnosis.prepared.stretches if s.motion.file == file]
    models = (diagnosis.before.model, diagnosis.model)
    along = [along_own(model, stretches) for model in models]
    for body in diagnosis.experiment.bodies:
        interaction = record.signals.get(f"{body}.interaction_force")
        measured = record.signals[f"{body}.actuator_force"] + (
            0.0 if interaction is None else interaction
        )
        before, after = np.zeros_like(measured), np.zeros_like(measured)
        for i, stretch in enumerate(stretches):
            motion = stretch.motion
            if motion.body != body:
                continue
            for own, out in zip(along, (before, after), strict=True):
                out[motion.rows] = residual_along(*own[i]).residual.value
        columns += [measured, measured - before, measured - after, before, after]
    return columns


def _number(value: float, error: float, unit: str) -> str:
    if math.isfinite(error) and error > 0:
        return f"{value:.4g} +- {error:.1g} {unit}"
    return f"{value:.4g} {unit}"


#: part of the error from which the one seen at the command is told beside it
DIFFERENT = 0.02


def seen_text(found: Fit) -> str | None:
    """The error seen at the command and the blind share, where they say more than the error."""
    seen = found.seen
    alike = abs(seen.error - found.check_error) <= DIFFERENT * found.check_error
    if alike and seen.blind == 0.0:
        return None
    blind = f", blind in {100 * seen.blind:.2g} % of the motion" if seen.blind else ""
    return f"check error seen at the command: {_percent(seen.error)}{blind}"


def _percent(error: float) -> str:
    """An error in percent; that of a model that is blind everywhere is not told."""
    return f"{100 * error:.2f} %" if math.isfinite(error) else "not told"


def refused_lines(diagnosis: Diagnosis) -> list[str]:
    """What left less force than the model that the ladder ends with, and why it does not count."""
    after = diagnosis.after
    return [
        f"refused: {r.candidate} ({_percent(r.fit.check_error)}; seen at the command "
        f"{_percent(r.fit.seen.error)}): {REFUSALS[r.refused]}"
        for r in diagnosis.last.ranked
        if r.refused and r.fit.check_error < after.check_error
    ]


def ladder_text(diagnosis: Diagnosis) -> str:
    """The ladder as a table, with parameters, noise floor and verdict."""
    lines = [f"{'added':<42}{'fit error':>10}{'check error':>13}"]
    for rung in diagnosis.rungs:
        name = "(your model, re-estimated)" if rung.added is None else f"+ {rung.added}"
        lines.append(
            f"{name:<42}{100 * rung.fit.fit_error:>9.2f}%{100 * rung.fit.check_error:>12.2f}%"
        )
        if rung.added is None:
            continue
        model = diagnosis.model
        for p in rung.added.effect.parameters:
            full = f"{rung.added.at}.{rung.added.effect.name}.{p}"
            value = model.parameters[full]
            bound = "  at its bound" if full in diagnosis.after.at_bound else ""
            lines.append(
                f"      {p} = {_number(value.value, value.stderr, model.unit(full))}{bound}"
            )
        if (seen := seen_text(rung.fit)) is not None:
            lines.append(f"      {seen}")
        if rung.equals:
            others = ", ".join(map(str, rung.equals))
            lines.append(f"      no different on these records: {others}")
    lines += [
        f"own of {o['record']}: {o['of'].replace('_', ' ')} {o['value']:.4g} {o['unit']}"
        for o in _own(diagnosis)
    ]
    lines.append(
        f"{'noise floor':<42}{'':>10}{100 * diagnosis.floor.value:>12.2f}%"
        f"  ({diagnosis.floor.source})"
    )
    lines += refused_lines(diagnosis)
    lines.append("")
    lines.append(sentence(diagnosis))
    return "\n".join(lines)


def sentence(diagnosis: Diagnosis) -> str:
    """The verdict in words."""
    left = diagnosis.left
    more = f" What is left is {left:.1f} noise floors: more is missing."
    rest = more if diagnosis.more_is_missing else ""
    if (moment := diagnosis.moment) is not None:
        rest = (
            f" What is left is {left:.1f} noise floors, but {moment.without:.1f} without one "
            f"moment ({moment})."
        )
    if diagnosis.verdict == "model_adequate":
        noise = f" What is left is noise ({left:.2f} noise floors)."
        return f"verdict: model_adequate.{rest or noise}"
    if diagnosis.verdict == "effects_missing":
        equals = {r.added: r.equals for r in diagnosis.rungs if r.added is not None}
        names = ", ".join(" or ".join(map(str, (c, *equals[c]))) for c in diagnosis.missing)
        less = [str(c) for c in equals if c not in diagnosis.missing]
        others = f" {', '.join(less)}: less likely than not." if less else ""
        return f"verdict: effects_missing: {names}.{others}{rest}"
    if diagnosis.unlikely:
        names = ", ".join(str(r.added) for r in diagnosis.rungs if r.added is not None)
        return (
            f"verdict: undecided. What helps most ({names}) is less likely than not what is "
            f"missing: {left:.1f} noise floors are left."
        )
    if len(diagnosis.rungs) > 1 and any(r.added and not r.equals for r in diagnosis.rungs):
        names = ", ".join(str(r.added) for r in diagnosis.rungs if r.added is not None)
        return (
            f"verdict: undecided. {names} help, but explain less than half of what is missing: "
            f"{left:.1f} noise floors are left."
        )
    if diagnosis.groups:
        names = "; ".join(" or ".join(map(str, g)) for g in diagnosis.groups)
        return f"verdict: undecided between {names}: these records cannot tell.{rest}"
    return (
        f"verdict: undecided. No effect tried explains the {left:.1f} noise floors that are left."
    )
