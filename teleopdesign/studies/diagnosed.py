"""Diagnoses as points of a study: one recording per point, named by its folder."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..diagnose import Diagnosis


def diagnose_recording(experiment: str) -> Diagnosis:
    """The diagnosis of the recording in that folder; see `find_missing`.

    experiment: path of a folder with experiment.toml;  a model function for `study`
    raises ExperimentError: no such folder, or an experiment that cannot be read
    """
    from ..diagnose import find_missing
    from ..measurement import load_experiment

    return find_missing(load_experiment(experiment))
