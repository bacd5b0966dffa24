"""A study from a TOML file, without Python; the page "Parameter studies" describes the format.

[study]
model = "late.toml"                 # a diagram's file, or a shipped diagram
[axes]
"C.dahl.level" = { from = 0.2, to = 1.2, points = 6 }
"computer.delay" = [0, 1e-3]
[simulation]
duration = 2.0
motion.L = { amplitude = 0.01, frequency = 2.0 }
[measures]
force_error = {}
hand = { measure = "peak", signal = "R_M" }
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.errors import ExperimentError, ModelError, did_you_mean, quote
from ..base.toml import Table, describe_toml_value, read_toml
from ..controllers import CONTROLLERS, ControlLaw
from ..diagrams import Diagram, read_diagram
from ..effects import EFFECTS, Effect
from ..simulate import Sampling, sine
from .chosen_measures import Measure, measure
from .measures import MEASURES
from .points import read_axes, read_whole

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


_NUMBERS = ("step", "give")


@dataclass(frozen=True)
class SineInput:
    """An input from a file: offset + amplitude sin(2 pi frequency t + phase)."""

    amplitude: float
    frequency: float
    phase: float = 0.0
    offset: float = 0.0

    def __call__(self, time: np.ndarray) -> np.ndarray:
        turned = np.sin(2 * np.pi * self.frequency * time + self.phase)
        return np.asarray(self.offset + self.amplitude * turned)


def read_study_file(
    path: str | Path,
    *,
    effects: Mapping[str, Effect] = EFFECTS,
    laws: Mapping[str, ControlLaw] = CONTROLLERS,
) -> dict[str, Any]:
    """The arguments of `study` that a file describes.

    effects, laws: known effects and control laws by name, as `read_diagram` takes them
    raises ExperimentError: the file cannot be read, or an entry has no meaning
    """
    path = Path(path)
    root = read_toml(path, path.name)
    root.allow(("study", "axes", "samples", "simulation", "measures"))
    head = root.table("study")
    head.allow(("model", "experiments", "seed"))
    try:
        arguments = _read_model(head, path.parent, effects, laws)
        arguments["axes"] = [*arguments.pop("axes", []), *read_axes(root)]
        arguments["measures"] = _read_measures(root.table("measures")) or arguments.get(
            "measures", {}
        )
        arguments |= _read_simulation(root.table("simulation"))
    except ModelError as error:
        raise ExperimentError(f"{path.name}: {error}") from error
    if "seed" in head.content:
        arguments["seed"] = read_whole(head, "seed")
    if not arguments["measures"]:
        raise ExperimentError(
            f"{path.name}: measures: found none, expected one of {', '.join(MEASURES)}"
        )
    return arguments


def _read_model(
    head: Table, folder: Path, effects: Mapping[str, Effect], laws: Mapping[str, ControlLaw]
) -> dict[str, Any]:
    if ("model" in head.content) == ("experiments" in head.content):
        raise ExperimentError(
            f"{head.where()}: expected model (a diagram) or experiments (folders), one of them"
        )
    if "model" in head.content:
        return {"model": _read_diagram(head, folder, effects, laws)}
    content = head.content["experiments"]
    if not isinstance(content, list) or not all(isinstance(g, str) for g in content):
        raise ExperimentError(
            f"{head.where('experiments')}: found {describe_toml_value(content)}, "
            "expected a list of folders, "
            'such as ["rod", "runs/*"]'
        )
    folders = _list_folders(content, folder, head.where("experiments"))
    return {"model": diagnose_recording, "axes": [{"experiment": folders}], "measures": ["verdict"]}


def _list_folders(patterns: Iterable[str], home: Path, where: str) -> list[str]:
    """Folders of experiments, with patterns that contain * resolved."""
    folders: list[str] = []
    for text in patterns:
        matches = sorted(home.glob(text)) if "*" in text and text[0] != "/" else [home / text]
        chosen = [m for m in matches if (m / "experiment.toml").is_file()]
        if not chosen:
            raise ExperimentError(f"{where}: {quote(text)}: no folder with an experiment.toml")
        folders += [str(m) for m in chosen]
    return list(dict.fromkeys(folders))


def _read_diagram(
    head: Table, folder: Path, effects: Mapping[str, Effect], laws: Mapping[str, ControlLaw]
) -> Diagram:
    from ..diagrams import SHIPPED, load_shipped

    name = head.text("model")
    if name in SHIPPED:
        return load_shipped(name)
    if not name.endswith(".toml"):
        raise ExperimentError(
            f"{head.where('model')}: found {quote(name)}, expected a file NAME.toml or one of "
            f"{', '.join(SHIPPED)}{did_you_mean(name, SHIPPED)}"
        )
    return read_diagram(folder / name, effects=effects, laws=laws)


def _read_simulation(table: Table) -> dict[str, Any]:
    table.allow(("duration", "inputs", "motion", "initial", "computer", "every_step", *_NUMBERS))
    arguments: dict[str, Any] = {
        n: table.number(n, above=0.0) for n in _NUMBERS if n in table.content
    }
    if "duration" in table.content:
        arguments["duration"] = table.number("duration", above=0.0)
    arguments["every_step"] = table.flag("every_step", False)
    initial = table.table("initial")
    arguments["initial"] = {name: initial.number(name) for name in initial.content}
    inputs, motions = table.table("inputs"), table.table("motion")
    arguments["inputs"] = {name: _read_input(inputs, name) for name in inputs.content}
    arguments["motion"] = {
        name: sine(**_read_sine(motions.table(name))) for name in motions.content
    }
    if "computer" in table.content:
        arguments["computer"] = _read_computer(table)
    return arguments


def _read_computer(table: Table) -> Any:
    content = table.content["computer"]
    if isinstance(content, str):
        if content != "continuous":
            raise ExperimentError(
                f"{table.where('computer')}: found {quote(content)}, expected a table or "
                f'"continuous"{did_you_mean(content, ["continuous"])}'
            )
        return content
    computer = table.table("computer")
    computer.allow(f.name for f in fields(Sampling))
    values: dict[str, Any] = {n: computer.number(n) for n in {*computer.content} - {"velocity"}}
    if "velocity" in computer.content:
        values["velocity"] = computer.text("velocity")
    if "observer_order" in values:
        values["observer_order"] = read_whole(computer, "observer_order")
    return Sampling(**values)


def _read_input(table: Table, name: str) -> Any:
    if not isinstance(table.content[name], dict):
        return table.number(name)
    entry = table.table(name)
    offset = entry.number("offset") if "offset" in entry.content else 0.0
    return SineInput(**_read_sine(entry, "offset"), offset=offset)


def _read_sine(table: Table, *more: str) -> dict[str, float]:
    table.allow(("amplitude", "frequency", "phase", *more))
    phase = table.number("phase") if "phase" in table.content else 0.0
    frequency = table.number("frequency", above=0.0)
    return {"amplitude": table.number("amplitude"), "frequency": frequency, "phase": phase}


def _read_measures(table: Table) -> dict[str, Measure]:
    """Name -> measure; the name is that of a measure, or the table names the measure."""
    measures: dict[str, Measure] = {}
    for name in table.content:
        entry = table.table(name)
        options = {k: v for k, v in entry.content.items() if k != "measure"}
        try:
            measures[name] = measure(entry.text("measure", default=name), **options)
        except ModelError as error:
            raise ExperimentError(f"{entry.where()}: {error}") from error
    return measures
