"""The answer of a diagnosis: text, JSON data, and the predicted forces as a table."""

from __future__ import annotations

import csv
import gzip
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from io import TextIOWrapper
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from ..base.files import harmless_cell, make_plain, write_beside, write_json
from ..measurement.experiment import Experiment
from ..measurement.reading import reading_data
from ..model import Model
from ..realise.along_motion import residual_along
from .answers.bodies import model_data
from .answers.fingerprint import experiment_data
from .by_simulation import SimulationComparison, simulation_data
from .diagnosis import Diagnosis
from .fit import Fit
from .friction_cells import cells_data
from .ladder_text import offset_rows
from .learnable import learnable_data
from .one_moment import Moment
from .open_questions import open_questions
from .probability import CandidateEvidence, evidence_of
from .record_offsets import apply_record_offsets
from .record_shift import shift_data
from .repeats import repeats_data
from .rung import Rung


def answer(diagnosis: Diagnosis) -> dict[str, Any]:
    """The answer as plain data: verdict, ladder, candidates, parameters; SI units."""
    checked, recorded = bool(diagnosis.experiment.check_records), diagnosis.recorded
    return {
        "verdict": diagnosis.verdict,
        "missing": [_missing_place(r) for r in diagnosis.rungs if r.added in diagnosis.missing],
        "ladder": [
            {
                "added": None if r.added is None else place_data(r.added.key),
                "instead_of": None if r.instead_of is None else r.instead_of.effect.name,
                "fit_error": r.fit.fit_error,
                "check_error": r.fit.check_error,
                "check_error_at_command": make_plain(r.fit.at_command.error),
                "blind": r.fit.at_command.blind,
                "could_be": None if r.could_be is None else [place_data(c.key) for c in r.could_be],
            }
            for r in diagnosis.rungs
        ],
        "blind": diagnosis.after.at_command.blind,
        "noise_floor": diagnosis.floor.value,
        "noise_floor_source": diagnosis.floor.source,
        "check": "records" if checked else "blocks of fit",
        "bandwidth": {"value": diagnosis.prepared.bandwidth, "unit": "Hz"},
        "candidates": candidate_rows(diagnosis),
        "indistinguishable": [
            [place_data(c.key) for c in g] for g in (*diagnosis.groups, *diagnosis.look_alikes)
        ],
        "cannot_tell": undetermined_rows(diagnosis),
        "set_aside": set_aside_rows(diagnosis),
        "own": offset_rows(diagnosis),
        "record_shift": shift_data(diagnosis.model, diagnosis.prepared.stretches),
        "model_parameters": parameter_rows(diagnosis.after, _added_places(diagnosis)),
        "left_over_noise_floors": make_plain(diagnosis.left),
        **learnable_data(diagnosis.learnable, diagnosis.near_reversals),
        "repeats": repeats_data(diagnosis.repeats),
        "one_moment": _moment(diagnosis.moment),
        "on_all_records": make_plain(diagnosis.on_all_records),
        "at_bound": list(diagnosis.after.at_bound),
        "friction_cells": cells_data(diagnosis.model, diagnosis.prepared),
        "evidence": (
            [_evidence(one) for one in evidence_of(diagnosis) if one.share > 0]
            if recorded is None
            else recorded.get("evidence", [])
        ),
        "experiment": experiment_data(diagnosis.experiment),
        "reading": reading_data(diagnosis.experiment.reading),
        "models": {
            "ladder": [model_data(r.fit.model) for r in diagnosis.rungs],
            "estimated": model_data(diagnosis.estimated.model),
        },
        "floor": {"drawn": diagnosis.floor.drawn, "held": diagnosis.floor.held},
        "open": _open(diagnosis),
    } | ({"left_out": list(diagnosis.left_out)} if diagnosis.left_out else {})


def _open(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """The open questions: an accepted effect, and its rivals with their models."""
    return [
        {
            "added": None if question.added is None else place_data(question.added.key),
            "others": [
                place_data(c.key) | {"model": model_data(fit.model)} for c, fit in question.others
            ],
        }
        for question in open_questions(diagnosis)
    ]


def _moment(moment: Moment | None) -> dict[str, Any] | None:
    """The moment that holds all of the residual above noise, as plain data."""
    if moment is None:
        return None
    return {
        "record": moment.file,
        "at": moment.body,
        "begin": {"value": moment.begin, "unit": "s"},
        "end": {"value": moment.end, "unit": "s"},
        "left_over_noise_floors_without": moment.without,
    }


def place_data(key: tuple[str, str]) -> dict[str, str]:
    """An effect and its place, as answers write them."""
    return {"effect": key[0], "at": key[1]}


def _missing_place(rung: Rung) -> dict[str, str]:
    """The effect that a rung added, with the effect of the user's model that it replaces."""
    assert rung.added is not None
    place = place_data(rung.added.key)
    instead = rung.instead_of
    return place if instead is None else place | {"instead_of": instead.effect.name}


def _added_places(diagnosis: Diagnosis) -> set[str]:
    return {f"{r.added.at}.{r.added.effect.name}" for r in diagnosis.rungs if r.added is not None}


def _parameter(model: Model, name: str) -> dict[str, Any]:
    value = model.parameters[name]
    return {
        "value": make_plain(value.value),
        "stderr": make_plain(value.stderr),
        "unit": model.unit(name),
    }


def parameter_rows(fit: Fit, without: Iterable[str] = ()) -> dict[str, Any]:
    """Parameters of a fit with standard errors and units.

    without: effects to leave out, as "PLACE.EFFECT"
    """
    skip = set(without)
    return {
        n: _parameter(fit.model, n)
        for n in fit.model.parameters
        if n.rpartition(".")[0] not in skip
    }


def undetermined_rows(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """What the records cannot determine about accepted effects: one sentence each."""
    return [
        place_data(one.candidate.key) | {"sentence": one.sentence} for one in diagnosis.undetermined
    ]


def set_aside_rows(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """Effects that were accepted and later removed, each with the reason."""
    return [
        place_data(one.candidate.key) | {"check_error": one.check_error, "reason": one.reason}
        for one in diagnosis.set_aside
    ]


def candidate_rows(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """Every candidate, most probable first, with its fit at one step of the ladder.

    The step is the one that accepted the candidate, else the one where it was most probable.
    """
    if diagnosis.recorded is not None:
        return list(diagnosis.recorded["candidates"])
    best: dict[tuple[str, str], CandidateEvidence] = {}
    for one in evidence_of(diagnosis):
        before = best.setdefault(one.ranked.candidate.key, one)
        if (one.accepted, one.probability()) > (before.accepted, before.probability()):
            best[one.ranked.candidate.key] = one
    rows = [_row(diagnosis, one) for one in best.values()]
    # rounded: candidates of equal probability keep the order of the rankings on every machine
    return sorted(rows, key=lambda c: -round(c["probability"], 6))


def _evidence(one: CandidateEvidence) -> dict[str, Any]:
    """Evidence behind the probability of a candidate, one row for each step that considered it."""
    return place_data(one.ranked.candidate.key) | {
        "accepted": one.accepted,
        "as_good": one.as_good,
        "score": make_plain(one.ranked.score),
        "share": one.share,
        "explained": one.explained,
    }


def _row(diagnosis: Diagnosis, one: CandidateEvidence) -> dict[str, Any]:
    candidate, fit = one.ranked.candidate, one.ranked.fit
    effect, at = candidate.key
    if one.accepted:  # the fit of the ladder: later exchanges and removals changed it
        fit = next(r.fit for r in diagnosis.rungs if r.added == candidate)
    model = fit.model
    if one.accepted and diagnosis.model.body(at).has(effect):
        model = diagnosis.model  # each later rung estimates all parameters again
    return {
        "effect": effect,
        "at": at,
        "probability": one.probability(),
        "check_error": fit.check_error,
        "check_error_at_command": make_plain(fit.at_command.error),
        "blind": fit.at_command.blind,
        "refused": one.barred or None,
        "parameters": {
            n: _parameter(model, f"{at}.{effect}.{n}") for n in candidate.effect.parameters
        },
    }


def write_answer(
    diagnosis: Diagnosis, path: str | Path, *, simulation: SimulationComparison | None = None
) -> None:
    """Write the answer as JSON, with the path of its experiment relative to the answer.

    simulation: a comparison by simulation, where one was made
    """
    content = with_folder(answer(diagnosis), diagnosis.experiment, path)
    if simulation is not None:
        content["simulation"] = simulation_data(simulation)
    write_json(path, content)


def with_folder(
    content: dict[str, Any], experiment: Experiment, path: str | Path
) -> dict[str, Any]:
    """An answer with the folder of its experiment, relative to the answer's path."""
    folder = experiment.folder
    if not folder.is_dir():  # an experiment of arrays has none
        return content
    place = os.path.relpath(folder.resolve(), Path(path).resolve().parent)
    described = content["experiment"] | {"folder": Path(place).as_posix()}
    return content | {"experiment": described}


def write_predictions(diagnosis: Diagnosis, path: str | Path) -> None:
    """Write measured and modelled forces: one row per sample of every record; .csv or .csv.gz.

    `BODY.measured` is the actuator force plus the interaction force as recorded. Residuals are
    low-passed only by the smoothing of the motion, so their low-passed values can be recomputed.
    """
    path = Path(path)
    bodies = list(diagnosis.experiment.bodies)
    head = ["record", "t"]
    for body in bodies:
        head += [f"{body}.{q}" for q in ("measured", "model_before", "model_after")]
        head += [f"{body}.residual_before", f"{body}.residual_after"]
    with write_beside(path) as part, open_for_writing(part, path) as file:
        out = csv.writer(file)
        out.writerow(head)
        for record in diagnosis.experiment.records:
            columns = _predicted_forces(diagnosis, record.file)
            for k in range(len(record.time)):
                out.writerow(
                    [
                        harmless_cell(record.file),
                        f"{record.time[k]:.9g}",
                        *(f"{c[k]:.7g}" for c in columns),
                    ]
                )


@contextmanager
def open_for_writing(part: Path, path: Path) -> Iterator[TextIO]:
    """A text file to write to, compressed where the path ends in .gz.

    part: the file that is written;  path: its final name, also written into the compressed file
    """
    with part.open("wb") as raw:
        if path.suffix != ".gz":
            with TextIOWrapper(raw, encoding="utf-8", newline="") as file:
                yield file
            return
        with gzip.GzipFile(path.name, "wb", fileobj=raw) as packed:
            with TextIOWrapper(packed, encoding="utf-8", newline="") as file:
                yield file


def _predicted_forces(diagnosis: Diagnosis, file: str) -> list[np.ndarray]:
    record = next(r for r in diagnosis.experiment.records if r.file == file)
    columns: list[np.ndarray] = []
    stretches = [s for s in diagnosis.prepared.stretches if s.motion.file == file]
    models = (diagnosis.before.model, diagnosis.model)
    along = [apply_record_offsets(model, stretches) for model in models]
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
            for arguments, out in zip(along, (before, after), strict=True):
                out[motion.rows] = residual_along(*arguments[i]).residual.value
        columns += [measured, measured - before, measured - after, before, after]
    return columns
