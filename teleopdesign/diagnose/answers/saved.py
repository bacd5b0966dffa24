"""An answer file and the model in it, of this version or an older one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ...base.errors import ExperimentError, did_you_mean, quote
from ...base.units import AXES, unit_of
from ...blocks import CONTACT
from ...effects import EFFECTS, Effect
from ...measurement.bandwidth import bandwidth_of
from ...measurement.experiment import Experiment
from ...model import Model
from ...realise.friction_cells import FrictionCells, cells_of_rows
from ..criteria import CRITERIA
from .bodies import model_from
from .fingerprint import bodies_text, difference
from .schema import read_content


@dataclass(frozen=True)
class SavedAnswer:
    """The checked content of an answer file.

    file: its name in messages;  content: as `diagnose.answer.answer` writes it
    """

    file: str
    content: Mapping[str, Any]

    @property
    def verdict(self) -> str:
        """ "effects_missing", "model_adequate" or "undecided"."""
        return str(self.content["verdict"])

    @property
    def folder(self) -> Path:
        """The folder of its experiment.

        raises ExperimentError: an answer of an earlier version names no folder, or the folder is
            absent
        """
        recorded = self.content.get("experiment", {}).get("folder")
        if recorded is None:
            raise ExperimentError(
                f"{self.file}: does not say where its records are: give the folder of its "
                f"experiment, and --answer {self.file}"
            )
        folder: Path = Path(self.file).parent / recorded
        if not folder.is_dir():
            raise ExperimentError(
                f"{self.file}: its experiment was in {quote(recorded)}, found no such folder: "
                f"give the folder, and --answer {self.file}"
            )
        return folder

    @property
    def left(self) -> float:
        """Final error as a multiple of the noise floor."""
        floor, last = self.content["noise_floor"], self.content["ladder"][-1]["check_error"]
        computed = last / floor if floor and last is not None else None
        left = self.content.get("left_over_noise_floors", computed)
        return float("inf") if left is None else float(left)

    @property
    def is_adequate(self) -> bool:
        """Whether its last model leaves no more than noise."""
        return self.verdict == "model_adequate" or self.left <= CRITERIA.adequate

    def friction_cells(self, place: str) -> FrictionCells | None:
        """Least friction of a body by cells of its travel; None: the answer does not say it."""
        rows = self.content.get("friction_cells", {}).get(place)
        return None if rows is None else cells_of_rows(rows)

    def model(
        self, known: Mapping[str, Effect] = EFFECTS, experiment: Experiment | None = None
    ) -> Model:
        """The final model of the diagnosis.

        known: effects by name, with those of the user
        experiment: the experiment of the answer. An older answer states neither axes nor fixed
            parameters. They come from the experiment; without it the units of the inertias give the
            axes, and only chosen parameters are fixed
        raises ExperimentError: the answer is to another experiment, or an effect is unknown
        """
        if experiment is not None:
            self.require(experiment)
        if "models" in self.content:
            last = self.content["models"]["ladder"][-1]
            model = model_from(last, known, file=self.file, key="models.ladder")
            if experiment is not None:
                self.require_bodies(model, experiment)
            return model
        bodies = _older_bodies(self, experiment, known)
        model = model_from(bodies, known, file=self.file, key="model_parameters")
        return model if experiment is None else _as_stated(model, experiment, known)

    def of_joint(self, joint: str) -> SavedAnswer:
        """The answer on one joint of an arm.

        raises ExperimentError: there is no such joint, or the answer is of an earlier version,
            without models
        """
        joints = self.content.get("joints", {})
        if joint not in joints:
            raise ExperimentError(
                f"{self.file}: joints: no joint {quote(joint)}, has {', '.join(joints) or 'none'}"
                f"{did_you_mean(joint, joints)}"
            )
        if "models" not in joints[joint]:
            raise ExperimentError(
                f"{self.file}: joints.{joint}: the answer of an earlier version: diagnose anew"
            )
        return SavedAnswer(self.file, joints[joint])

    def require(self, experiment: Experiment) -> None:
        """Refuse the answer to another experiment.

        An older answer is compared as far as possible.
        raises ExperimentError: with the difference in words
        """
        recorded = self.content.get("experiment")
        if recorded is None:
            differs = _older_difference(self, experiment)
        else:
            differs = difference(recorded, experiment)
        if differs is not None:
            raise ExperimentError(
                f"{self.file}: is not an answer to {experiment.folder.name} but to another "
                f"experiment: {differs}"
            )

    def require_bodies(self, model: Model, experiment: Experiment) -> None:
        """Refuse a model of other bodies, or on other axes, than the experiment's.

        raises ExperimentError: with both in words
        """
        axes = {name: body.axis for name, body in model.bodies.items()}
        expected = {name: body.axis for name, body in experiment.bodies.items()}
        if axes != expected:
            raise ExperimentError(
                f"{self.file}: models: found {bodies_text(axes)}, expected "
                f"{bodies_text(expected)} as in {experiment.folder.name}"
            )


def load_answer(path: str | Path) -> SavedAnswer:
    """Read an answer that `teleopdesign diagnose --json` wrote.

    raises ExperimentError: the file cannot be read, or is no answer
    """
    return SavedAnswer(str(path), read_content(path))


def _parameters(saved: SavedAnswer) -> dict[str, Mapping[str, Any]]:
    """Every parameter of the last model by its full name: of the user's effects, then of each rung.

    raises ExperimentError: an effect of the ladder is not among the candidates
    """
    content = saved.content
    parameters = dict(content["model_parameters"])
    rows = {(c["effect"], c["at"]): c["parameters"] for c in content["candidates"]}
    for row in content["ladder"]:
        if (added := row["added"]) is None:
            continue
        key = added["effect"], added["at"]
        if key not in rows:
            raise ExperimentError(
                f"{saved.file}: candidates: none is {key[0]} at {key[1]}, which the ladder adds"
            )
        parameters |= {f"{key[1]}.{key[0]}.{n}": p for n, p in rows[key].items()}
    return parameters


def _older_bodies(
    saved: SavedAnswer, experiment: Experiment | None, known: Mapping[str, Effect]
) -> dict[str, Any]:
    """Bodies as tables, from the full names of parameters in an older answer.

    experiment: gives the axes; None: the units of the inertias do
    raises ExperimentError: a body has no inertia, or a name belongs to no body
    """
    parameters = _parameters(saved)
    places = list(dict.fromkeys(name.partition(".")[0] for name in parameters))
    bodies = [place for place in places if place != CONTACT.name]
    tables: dict[str, Any] = {}
    for place in bodies:
        inertia = parameters.get(f"{place}.inertia")
        if inertia is None:
            raise ExperimentError(f'{saved.file}: model_parameters: no key "{place}.inertia"')
        axis = experiment.axis(place) if experiment else _axis_of(saved, place, inertia["unit"])
        tables[place] = {"axis": axis, "inertia": _value(inertia, False), "effects": {}}
    for name, parameter in parameters.items():
        place, _, local_name = name.partition(".")
        if local_name == "inertia" or not bodies:
            continue
        effect, _, key = local_name.rpartition(".")
        if place == CONTACT.name:
            effect = effect or place  # environment.stiffness belongs to the contact
        if not effect:
            raise ExperimentError(f"{saved.file}: model_parameters: no body has a {quote(name)}")
        holder = bodies[-1] if place == CONTACT.name else place
        row = tables[holder]["effects"].setdefault(effect, {})
        if parameter["value"] is not None:
            row[key] = _value(parameter, _is_chosen(known.get(effect), key))
    return tables


def _value(parameter: Mapping[str, Any], fixed: bool) -> dict[str, Any]:
    stderr = parameter["stderr"]
    error = {} if stderr is None else {"stderr": stderr}
    return {"value": parameter["value"], "unit": parameter["unit"], "fixed": fixed} | error


def _is_chosen(effect: Effect | None, key: str) -> bool:
    return effect is not None and key in effect.parameters and effect.parameters[key].search.chosen


def _axis_of(saved: SavedAnswer, place: str, unit: str) -> str:
    """The axis of a body in an older answer, by the unit of its inertia (SI).

    raises ExperimentError: the unit is that of no axis
    """
    for axis in AXES:
        if unit == unit_of("inertia", axis):
            return axis
    raise ExperimentError(
        f"{saved.file}: model_parameters.{place}.inertia.unit: found {quote(unit)}, expected "
        f"{' or '.join(quote(unit_of('inertia', a)) for a in AXES)}: the answer of an earlier "
        "version, it says no axis"
    )


def _as_stated(model: Model, experiment: Experiment, known: Mapping[str, Effect]) -> Model:
    """The model with the parameters fixed that its experiment fixes."""
    stated = Model.from_experiment(experiment, known).parameters
    fixed = {n for n, v in stated.items() if v.fixed}
    values = {n: replace(v, fixed=True) for n, v in model.parameters.items() if n in fixed}
    return model.with_values(values)


def _older_difference(saved: SavedAnswer, experiment: Experiment) -> str | None:
    """How an older answer contradicts this experiment, in words; None where it does not."""
    content = saved.content
    parameters = content["model_parameters"]
    places = dict.fromkeys(name.partition(".")[0] for name in parameters)
    bodies = [place for place in places if place != CONTACT.name]
    if bodies != list(experiment.bodies):
        return f"bodies {', '.join(bodies) or 'none'}, found {', '.join(experiment.bodies)}"
    for place in bodies:
        unit = unit_of("inertia", experiment.axis(place))
        stated_unit = parameters.get(f"{place}.inertia", {}).get("unit", unit)
        if stated_unit != unit:
            return f"{place}.inertia in {quote(stated_unit)}, found {quote(unit)}"
    stated = {place: set(body.effects) for place, body in experiment.bodies.items()}
    touched = experiment.environment
    stated[CONTACT.name] = set() if touched is None else set(touched.effects)
    for name in parameters:
        place, _, local_name = name.partition(".")
        effect, _, _ = local_name.partition(".") if "." in local_name else ("", "", "")
        if effect and effect not in stated[place]:
            return f"a model with {effect} at {place}, found {', '.join(stated[place]) or 'none'}"
    check = "records" if experiment.check_records else "blocks of fit"
    if content.get("check", check) != check:
        return f"check by {content['check']}, found {check}"
    moment = content.get("one_moment")
    files = {r.file for r in experiment.records}
    named_records = [o["record"] for o in content.get("own", [])] + (
        [moment["record"]] if moment else []
    )
    if others := [file for file in named_records if file not in files]:
        return f"a record {quote(others[0])}, found {', '.join(sorted(files))}"
    bandwidth = content.get("bandwidth", {}).get("value", experiment.bandwidth)
    if experiment.bandwidth is not None and bandwidth != (now := bandwidth_of(experiment)):
        return f"bandwidth {bandwidth:g} Hz, found {now:g} Hz"
    return None
