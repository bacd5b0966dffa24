"""What a design starts from: the model that a diagnosis ended with, live or from its answer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from ..by_value import ByValue
from ..diagnose import Diagnosis
from ..diagnose.answers import load_answer
from ..diagnose.arms.prepared import isolate_joint
from ..effects import EFFECTS, Effect
from ..measurement.experiment import Experiment
from ..model import Model


@dataclass(frozen=True, eq=False)
class DiagnosedModel(ByValue):
    """A model, and how well it stands: verdict and what is left, in noise floors.

    verdict: of a diagnosis, such as "model_adequate";  left: its check error over the noise floor,
        about 1 where only sensor noise is left
    """

    experiment: Experiment
    model: Model
    verdict: str
    left: float


def diagnosed_model(diagnosis: Diagnosis) -> DiagnosedModel:
    """The model that a diagnosis ends with, its verdict, and what the model leaves.

    The same as `read_answer` takes from the file of that diagnosis.
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

    joint: of an arm, which is taken out of it: its verdict, with the arm's last model

    raises ExperimentError: no such file, no such answer, one of another experiment, or an effect
        that is not known
    """
    saved = load_answer(path)
    model = saved.model(known, experiment)
    if joint is None:
        return DiagnosedModel(experiment, model, saved.verdict, saved.left)
    mine = saved.of_joint(joint)
    return DiagnosedModel(isolate_joint(experiment, joint), model, mine.verdict, mine.left)
