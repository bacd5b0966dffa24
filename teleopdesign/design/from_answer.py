"""The starting point of a design: the last model of a diagnosis, in memory or from its answer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from ..base.frozen import ByValue
from ..diagnose import Diagnosis
from ..diagnose.answers import load_answer
from ..diagnose.arms.prepared import isolate_joint
from ..effects import EFFECTS, Effect
from ..measurement.experiment import Experiment
from ..model import Model


@dataclass(frozen=True, eq=False)
class DiagnosedModel(ByValue):
    """A model and its quality.

    verdict: of the diagnosis, such as "model_adequate"
    left: check error of the model over the noise floor, about 1 where only sensor noise is left
    """

    experiment: Experiment
    model: Model
    verdict: str
    left: float


def diagnosed_model(diagnosis: Diagnosis) -> DiagnosedModel:
    """The last model of a diagnosis, with its verdict and its check error in noise floors.

    `read_answer` gives the same from the file of that diagnosis.
    """
    return DiagnosedModel(diagnosis.experiment, diagnosis.model, diagnosis.verdict, diagnosis.left)


def read_answer(
    path: str | Path,
    experiment: Experiment,
    known: Mapping[str, Effect] = EFFECTS,
    *,
    joint: str | None = None,
) -> DiagnosedModel:
    """The model of an answer that `teleopdesign diagnose --json` wrote for that experiment.

    joint: of an arm: the design is for this joint alone, with its verdict and the arm's last model
    raises ExperimentError: no such file, no such answer, one of another experiment, or an effect
        that is not known
    """
    saved = load_answer(path)
    model = saved.model(known, experiment)
    if joint is None:
        return DiagnosedModel(experiment, model, saved.verdict, saved.left)
    mine = saved.of_joint(joint)
    return DiagnosedModel(isolate_joint(experiment, joint), model, mine.verdict, mine.left)
