"""The recording that a diagnosis belongs to: read and prepared when it is first needed.

From memory and from an answer file the same is computed, by the models that the diagnosis states.
A fingerprint of the experiment (title, records and a digest) matches answers and records.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated

import numpy as np

from ..base.codec import Filled
from ..base.errors import ExperimentError, did_you_mean, quote
from ..measurement.experiment import Experiment, isolate_joint, load_experiment
from ..measurement.prepare import Prepared
from ..model import Model
from .fit import Fit, estimate
from .other_motion import with_other_motions
from .parts import PreparedParts, prepare_parts, with_bodies_of
from .search_plan import EFFORTS, cut_to_windows


@dataclass(frozen=True, eq=False)
class DiagnosedRecording:
    """The experiment of a diagnosis, and its records prepared for comparison.

    stated: the experiment; None: it is loaded from the folder
    folder: of the experiment, relative to the answer file;  file: the answer file
    fingerprint: of the experiment that the answer belongs to; None: not known
    bandwidth: Hz; None: the experiment's
    model: the final model: an arm's links are prepared with the inertias of its bodies
    other_motion: joint -> the joint whose motion is its channel `other_position`
    whole, joint: of the arm of which this is one joint; None, "": of the whole experiment
    """

    stated: Experiment | None = None
    folder: str | None = None
    file: str = ""
    fingerprint: Fingerprint | None = None
    bandwidth: float | None = None
    model: Model | None = None
    other_motion: Mapping[str, str] = field(default_factory=dict)
    whole: DiagnosedRecording | None = None
    joint: str = ""

    @cached_property
    def experiment(self) -> Experiment:
        """The experiment; of one joint: with the channels of this joint alone.

        raises ExperimentError: it is nowhere, or another one than that of the answer
        """
        if self.whole is not None:
            return isolate_joint(self.whole.experiment, self.joint)
        experiment = self.stated if self.stated is not None else load_experiment(self.place)
        self.require(experiment)
        return experiment

    @property
    def place(self) -> Path:
        """The folder of the experiment.

        raises ExperimentError: an answer of an earlier version names no folder, or the folder is
            absent
        """
        if self.folder is None:
            raise ExperimentError(
                f"{self.file}: does not say where its records are: give the folder of its "
                f"experiment, and --answer {self.file}; one of arrays in Python: "
                "load_answer(FILE, experiment=...)"
            )
        place = Path(self.file).parent / self.folder
        if not place.is_dir():
            raise ExperimentError(
                f"{self.file}: its experiment was in {quote(self.folder)}, found no such folder: "
                f"give the folder, and --answer {self.file}"
            )
        return place

    def require(self, experiment: Experiment) -> None:
        """Refuse another experiment than that of the answer, or other bodies than its model has.

        raises ExperimentError: with the difference in words
        """
        differs = None if self.fingerprint is None else self.fingerprint.difference(experiment)
        if differs is not None:
            raise ExperimentError(
                f"{self.file}: is not an answer to {experiment.folder.name} but to another "
                f"experiment: {differs}"
            )
        if self.model is None:
            return
        axes = {name: body.axis for name, body in self.model.bodies.items()}
        expected = {name: body.axis for name, body in experiment.bodies.items()}
        if axes != expected:
            raise ExperimentError(
                f"{self.file}: models: found {bodies_text(axes)}, expected "
                f"{bodies_text(expected)} as in {experiment.folder.name}"
            )

    @property
    def prepared(self) -> Prepared:
        """The records, prepared for comparison."""
        return (self.whole or self).parts.parts[self.joint]

    @cached_property
    def parts(self) -> PreparedParts:
        """The records of all parts; joints of an arm with the bodies of the final model.

        raises ExperimentError: an arm with other joints or links than the model
        """
        prepared, model = prepare_parts(self.experiment, bandwidth=self.bandwidth), self.model
        if model is None:
            return prepared
        if len(model.links) != len(prepared.initial):
            raise ExperimentError(
                f"{self.file}: models.ladder: found {len(model.links)} base parameters, expected "
                f"{len(prepared.initial)} as the links of {self.experiment.folder.name} have"
            )
        for joint in (*self.other_motion, *self.other_motion.values()):
            if joint not in prepared.parts:
                raise ExperimentError(
                    f"{self.file}: other_motion: no joint {quote(joint)}, has "
                    f"{', '.join(prepared.parts)}{did_you_mean(joint, prepared.parts)}"
                )
        return with_other_motions(with_bodies_of(model, prepared), self.other_motion)

    @cached_property
    def searched(self) -> Prepared:
        """The windows of the records that models are fitted on; those of a joint are whole."""
        return self.prepared if self.whole is not None else cut_to_windows(self.prepared)

    def evaluate(self, model: Model) -> Fit:
        """A fit with the residuals of a model and their derivatives; no parameter changes.

        Without check records, the held-out blocks are fitted from these values, as by `estimate`.
        """
        return replace(estimate(model, self.searched, effort=EFFORTS.evaluation), model=model)

    def of_joint(self, joint: str, model: Model | None) -> DiagnosedRecording:
        """The recording of one joint of an arm; model: the final model of the joint."""
        return replace(self, model=model, whole=self, joint=joint)

    def __getstate__(self) -> dict[str, object]:
        state = {f: self.__dict__[f] for f in self.__dataclass_fields__}
        if self.stated is None and "experiment" in self.__dict__ and self.whole is None:
            state["stated"] = self.__dict__["experiment"]
        return state

    def __setstate__(self, state: dict[str, object]) -> None:
        self.__dict__.update(state)


@dataclass(frozen=True)
class RecordPrint:
    """A record: its file, its use and its number of samples."""

    file: str
    use: str
    samples: int

    def __str__(self) -> str:
        return f"{self.file} ({self.use}, {self.samples} samples)"


@dataclass(frozen=True)
class Fingerprint:
    """Title, axis of each body, records, and the digest of their readings."""

    title: str
    axes: Mapping[str, str]
    records: Annotated[tuple[RecordPrint, ...], Filled(1)]
    digest: str

    def difference(self, experiment: Experiment) -> str | None:
        """How the expected experiment differs from this one, in words; None: they are equal.

        Records are what they read, in their order: a file that was renamed, or arrays that were
        saved as a folder, are the same records.
        """
        present = fingerprint_of(experiment)
        if self.title != present.title:
            return f"title {quote(self.title)}, found {quote(present.title)}"
        if self.axes != present.axes:
            return f"bodies {bodies_text(self.axes)}, found {bodies_text(present.axes)}"
        if [(r.use, r.samples) for r in self.records] != [
            (r.use, r.samples) for r in present.records
        ]:
            return f"records {_list(self.records)}, found {_list(present.records)}"
        if self.digest != digest(experiment, [r.file for r in self.records]):
            return "records of the same length, but they read differently now"
        return None


def fingerprint_of(experiment: Experiment) -> Fingerprint:
    """The fingerprint of an experiment, from its records as they were read."""
    return Fingerprint(
        title=experiment.title,
        axes={name: body.axis for name, body in experiment.bodies.items()},
        records=tuple(RecordPrint(r.file, r.use, len(r.time)) for r in experiment.records),
        digest=digest(experiment, [r.file for r in experiment.records]),
    )


def digest(experiment: Experiment, files: Sequence[str]) -> str:
    """SHA-256 of every record as it was read: use, clock and signals in SI, by these file names.

    The packing of a file does not change it; another unit, sign or column does.
    """
    whole = hashlib.sha256()
    for r, file in zip(experiment.records, files, strict=True):
        cuts = [(s.start, s.stop) for s in r.segments]
        whole.update(repr((file, r.use, sorted(r.offset_names), r.sample_time, cuts)).encode())
        for name in sorted(r.signals):
            whole.update(f"{name} {len(r.signals[name])} ".encode())
            whole.update(np.ascontiguousarray(r.signals[name], dtype="<f8").tobytes())
    return whole.hexdigest()


def bodies_text(axes: Mapping[str, str]) -> str:
    """Names of bodies with their axes, as text: "device (prismatic)"."""
    return ", ".join(f"{place} ({axis})" for place, axis in axes.items())


def _list(records: tuple[RecordPrint, ...]) -> str:
    return ", ".join(map(str, records[:4])) + (", ..." if records[4:] else "")
