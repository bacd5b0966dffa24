"""What limits of friction rest on: a diagnosis, or its answer, and the friction by cells."""

from __future__ import annotations

from ..base.errors import ExperimentError
from ..diagnose import Diagnosis
from ..diagnose.answers import SavedAnswer
from ..diagnose.friction_cells import friction_cells
from ..measurement import Experiment, load_experiment
from ..measurement.prepare import prepare
from ..model import Model
from ..passivity.identified import Basis


def basis_of_diagnosis(diagnosis: Diagnosis, place: str) -> Basis:
    """What limits of the friction of a body rest on, from a diagnosis."""
    cells = friction_cells(diagnosis.model, diagnosis.prepared, place)
    return Basis(diagnosis.verdict, diagnosis.left, not diagnosis.more_is_missing, cells)


def basis_of_answer(
    saved: SavedAnswer, model: Model, place: str, experiment: Experiment | None = None
) -> Basis:
    """What limits of the friction of a body rest on, from an answer with this model.

    An older answer has no friction by cells: the records of its experiment show it, if they are
    found. An arm's joint has none.
    """
    cells = saved.friction_cells(place)
    if cells is None and not saved.is_adequate and "joints" not in saved.content:
        try:
            if experiment is None:
                experiment = load_experiment(saved.folder)
                saved.require(experiment)
            cells = friction_cells(model, prepare(experiment), place)
        except ExperimentError:
            pass  # no records: the limits then say that none is certain
    return Basis(saved.verdict, saved.left, saved.is_adequate, cells)
