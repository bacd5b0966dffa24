"""The answer on an arm: like that on one body, with the errors of each joint in its ladder."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ...base.files import harmless_cell, make_plain, write_beside, write_json
from ...measurement.filtering import Array
from ...measurement.reading import reading_data
from ...realise.along_motion import residual_along
from ..answer import (
    answer,
    candidate_rows,
    open_for_writing,
    parameter_rows,
    place_data,
    set_aside_rows,
    undetermined_rows,
    with_folder,
)
from ..answers.bodies import model_data
from ..answers.fingerprint import experiment_data
from ..by_simulation import SimulationComparison, simulation_data
from ..learnable import learnable_data
from ..record_offsets import apply_record_offsets
from ..record_shift import shift_data
from .diagnosis import ArmDiagnosis, ArmRung


def arm_answer(diagnosis: ArmDiagnosis) -> dict[str, Any]:
    """The answer as plain data: verdict, ladder, candidates, parameters; SI units."""
    joints = diagnosis.joints.values()
    candidates = [row for d in joints for row in candidate_rows(d)]
    added = {c.added.key for c in diagnosis.rungs if c.added is not None}
    shifts: dict[str, Any] = {}
    for d in joints:
        shifts |= shift_data(d.model, d.prepared.stretches)
    return {
        "verdict": diagnosis.verdict,
        "missing": [_missing_effects(r) for r in diagnosis.rungs if r.added in diagnosis.missing],
        "ladder": [_rung(r) for r in diagnosis.rungs],
        "noise_floor": diagnosis.floor,
        "noise_floor_source": next(iter(joints)).floor.source,
        "check": "records" if diagnosis.experiment.check_records else "blocks of fit",
        "bandwidth": {"value": diagnosis.prepared.bandwidth, "unit": "Hz"},
        "joints": {j: answer(d) for j, d in diagnosis.joints.items()},
        "candidates": sorted(candidates, key=lambda c: -c["probability"]),
        "indistinguishable": [
            [place_data(c.key) for c in group]
            for d in joints
            for group in d.groups
            if group[0].key in added
        ],
        "cannot_tell": [row for d in joints for row in undetermined_rows(d)],
        "set_aside": [row for d in joints for row in set_aside_rows(d)],
        "record_shift": shifts,
        "other_motion": dict(diagnosis.prepared.others),
        "model_parameters": _parameters(diagnosis),
        **learnable_data(diagnosis.learnable, None),
        "left_over_noise_floors": make_plain(diagnosis.left),
        "at_bound": [n for d in joints for n in d.after.at_bound],
        "models": {
            "ladder": [model_data(r.fit.model) for r in diagnosis.rungs],
            "estimated": model_data(diagnosis.after.model),
        },
        "experiment": experiment_data(diagnosis.experiment),
        "reading": reading_data(diagnosis.experiment.reading),
    } | ({"left_out": list(diagnosis.left_out)} if diagnosis.left_out else {})


def _missing_effects(rung: ArmRung) -> dict[str, str]:
    assert rung.added is not None
    place = place_data(rung.added.key)
    if rung.follows is not None:
        place = place | {"follows": rung.follows}
    instead = rung.instead_of
    return place if instead is None else place | {"instead_of": instead.effect.name}


def _rung(rung: ArmRung) -> dict[str, Any]:
    fit = rung.fit
    return {
        "added": None if rung.added is None else place_data(rung.added.key),
        "instead_of": None if rung.instead_of is None else rung.instead_of.effect.name,
        "fit_error": fit.fit_error,
        "check_error": fit.check_error,
        "joints": {
            j: {"fit_error": fit.fit_errors[j], "check_error": fit.check_errors[j]}
            for j in fit.fits
        },
    }


def _parameters(diagnosis: ArmDiagnosis) -> dict[str, Any]:
    """Parameters of the user's model, and the base parameters of the links."""
    rows: dict[str, Any] = {}
    added = {f"{r.added.at}.{r.added.effect.name}" for r in diagnosis.rungs if r.added is not None}
    for j, fit in diagnosis.after.fits.items():
        rows |= {
            n: row
            for n, row in parameter_rows(fit, added).items()
            if n != f"{j}.inertia"  # in the search this inertia includes the links
        }
    rows |= {
        f"arm.{n}": {"value": make_plain(value), "stderr": make_plain(error), "unit": unit}
        for n, (value, error, unit) in diagnosis.base_parameters.items()
    }
    return rows


def write_arm_answer(
    diagnosis: ArmDiagnosis,
    path: str | Path,
    *,
    simulation: SimulationComparison | None = None,
) -> None:
    """Write the answer as JSON, with the path of its experiment relative to the answer.

    simulation: the final model compared by simulation, to be written too
    """
    content = with_folder(arm_answer(diagnosis), diagnosis.experiment, path)
    if simulation is not None:
        content["simulation"] = simulation_data(simulation)
    write_json(path, content)


def write_arm_predictions(diagnosis: ArmDiagnosis, path: str | Path) -> None:
    """Write measured and modelled forces: one row per sample of every record; .csv or .csv.gz.

    Five columns for each joint, as `write_predictions` writes for each body.
    """
    path = Path(path)
    head = ["record", "t"]
    for joint in diagnosis.joints:
        head += [f"{joint}.{q}" for q in ("measured", "model_before", "model_after")]
        head += [f"{joint}.residual_before", f"{joint}.residual_after"]
    with write_beside(path) as part, open_for_writing(part, path) as file:
        out = csv.writer(file)
        out.writerow(head)
        for record in diagnosis.experiment.records:
            columns: list[Array] = []
            for joint in diagnosis.joints:
                columns += _predicted_forces(diagnosis, joint, record.file)
            for k, time in enumerate(record.time):
                numbers = (f"{c[k]:.7g}" for c in columns)
                out.writerow([harmless_cell(record.file), f"{time:.9g}", *numbers])


def _predicted_forces(diagnosis: ArmDiagnosis, joint: str, file: str) -> Sequence[Array]:
    record = next(r for r in diagnosis.experiment.records if r.file == file)
    stretches = [s for s in diagnosis.before.prepared[joint].stretches if s.motion.file == file]
    interaction = record.signals.get(f"{joint}.interaction_force")
    measured = record.signals[f"{joint}.actuator_force"] + (
        0.0 if interaction is None else interaction
    )
    left = []
    for fit in (diagnosis.before, diagnosis.after):
        residual = np.zeros_like(measured)
        for body, motion in apply_record_offsets(fit.fits[joint].model, stretches):
            residual[motion.rows] = residual_along(body, motion).residual.value
        left.append(residual)
    before, after = left
    return [measured, measured - before, measured - after, before, after]
