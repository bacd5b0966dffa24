"""The model that a diagnosis ended with, read back from its answer file."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ..blocks import Value
from ..by_value import ByValue
from ..diagnose import Diagnosis
from ..effects import EFFECTS, Effect
from ..errors import ExperimentError, ModelError
from ..measurement.experiment import Experiment
from ..model import Model


@dataclass(frozen=True, eq=False)
class Diagnosed(ByValue):
    """A model, and how well it stands: verdict and what is left, in noise floors."""

    experiment: Experiment
    model: Model
    verdict: str
    left: float


def diagnosed(diagnosis: Diagnosis) -> Diagnosed:
    """What a diagnosis ends with."""
    return Diagnosed(diagnosis.experiment, diagnosis.model, diagnosis.verdict, diagnosis.left)


def read_answer(
    path: str | Path, experiment: Experiment, known: Mapping[str, Effect] = EFFECTS
) -> Diagnosed:
    """The model of an answer that `teleopdesign diagnose --json` wrote for that experiment.

    raises ExperimentError: no such file, no such answer, or one of another experiment
    """
    where = str(path)
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
        added = [row["added"] for row in content["ladder"] if row["added"] is not None]
        tried = {(c["effect"], c["at"]): c["parameters"] for c in content["candidates"]}
        model = Model.from_experiment(experiment, known)
        for one in added:
            model = _with_effect(model, one["effect"], one["at"], tried)
        model = _with_values(model, content["model_parameters"])
        left = content.get("left_over_noise_floors")
        left = float("inf") if left is None else float(left)
        return Diagnosed(experiment, model, content["verdict"], left)
    except OSError as error:
        raise ExperimentError(f"{where}: {error.strerror}") from error
    except json.JSONDecodeError as error:
        raise ExperimentError(f"{where}: line {error.lineno}: no JSON: {error.msg}") from error
    except (KeyError, TypeError, AttributeError) as error:
        raise ExperimentError(
            f"{where}: no answer of `teleopdesign diagnose --json`: {error}"
        ) from error
    except ModelError as error:
        folder = experiment.folder.name
        raise ExperimentError(f"{where}: is not an answer to {folder}: {error}") from error


def _with_effect(
    model: Model, effect: str, at: str, tried: Mapping[tuple[str, str], Mapping[str, Any]]
) -> Model:
    model = model.with_effect(effect, at=at)
    return _with_values(model, {f"{at}.{effect}.{n}": p for n, p in tried[effect, at].items()})


def _with_values(model: Model, parameters: Mapping[str, Any]) -> Model:
    """The model with these values and errors; those that are not finite stay as they were."""
    values: dict[str, float | Value] = {}
    for name, found in parameters.items():
        if found["value"] is None:
            continue
        error = float("nan") if found["stderr"] is None else found["stderr"]
        own = model.parameters.get(name, Value(0.0))  # an unknown name: with_values says so
        values[name] = replace(own, value=found["value"], stderr=error)
    return model.with_values(values)
