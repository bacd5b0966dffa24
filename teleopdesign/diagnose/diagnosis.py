"""The result of a diagnosis: all that it states, the same from memory and from its answer file.

The fields of `Diagnosis` are the content of an answer (`answer.py` writes and reads it). What needs
the recording is computed from the models of the answer when it is asked for (`recording.py`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from ..base.codec import INLINE, NEVER, OMIT, At, Bounds, Error, Filled, InUnit
from ..base.errors import ExperimentError
from ..base.frozen import ByValue
from ..base.shown import Shown, figure_of
from ..measurement.experiment import Experiment
from ..measurement.prepare import Prepared
from ..model import Model
from ..realise.friction_cells import FrictionCell
from .candidates import Candidate
from .covariance import covariance_in_blocks
from .criteria import CRITERIA
from .error import NearReversals
from .evidence import floors_left, is_adequate
from .learnable import Learnable
from .model_data import model_of_body
from .no_named_law import FreeForm
from .noise_floor import NoiseFloor
from .record_offsets import Offset
from .record_shift import RecordShift
from .recording import DiagnosedRecording, Fingerprint
from .repeats import Repeatability
from .statements import (
    ANEW,
    CandidateResult,
    EstimatedValue,
    LadderRow,
    Nearest,
    NotAccepted,
    OpenQuestion,
    SetAside,
    StepEvidence,
    Undetermined,
    VerdictName,
    estimate_of,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..frequency import ParameterCovariance
    from .fit import Fit


@dataclass(frozen=True, eq=False)
class Diagnosis(Shown, ByValue):
    """Result of a diagnosis: the ladder of effects, its models, and the verdict.

    rungs: the user's model re-estimated, then one row an effect
    floor: the noise floor: the error that the sensors alone would leave
    check: what the check errors are of, by the experiment;  held_out: whether they are those of
        blocks of the fit records, because no check record is long enough, either
    bandwidth: Hz, up to which forces are compared;  bandwidth_source: where it comes from, in words
    candidates: every effect tried, most probable first
    indistinguishable: groups of effects that explain the records equally well, the accepted one
        first, and pairs that the travel hardly distinguishes
    undetermined: what the records cannot determine about the accepted effects
    set_aside: effects that were accepted first and removed again, because the final errors do not
        support them
    offsets: offsets that belong to one record, with the final model
    record_shift: log -> delay of the log, by the final model
    at_bound: parameters of the final model that ended at a bound
    learnable: how much of the residual a black box can learn; None without the extra `learn`
    near_reversals: the check error near reversals of the motion; None where there are none
    repeats: how far the residual repeats with the motion; None where no motion is repeated
    on_all_records: check error of the final model estimated on all records; None: not computed,
        because the check error is not much larger than the fit error
    fingerprint: of the experiment;  reading: corrections of its logs, as plain data
    estimated: the final model, not yet corrected for errors of the readings; None: as `fitted`
    open: questions that the records leave open; None: an older answer does not say
    not_accepted, nearest: candidates that leave less than the final model, and do not count
    no_named_law: the final model with a curve through values, which surely leaves less and explains
        nothing; None: there is none
    silence: why the records tell no effect, as the end of a verdict; "": they may tell one
    remarks: further sentences on the records
    left_out: parts of a full search that this one left out, in words
    considered: names of the effects that the model may take
    joints: joint of an arm -> its own diagnosis, with the information of the others on the links
    other_motion: joint -> the joint whose motion is its channel `other_position`
    links: name -> base parameter of the links of an arm
    friction_cells: body -> least friction that model and residual show together, by cells of its
        travel; an older answer, and an arm's joint, have none
    kind: "friction curve": the records have no time, and the bandwidth is NaN; "": others
    simulation: comparison of the final model by simulation, as plain data
    recording: of the experiment; no part of the content
    """

    verdict: VerdictName
    rungs: Annotated[tuple[LadderRow, ...], Filled(1), At("ladder")]
    floor: Annotated[NoiseFloor, INLINE]
    candidates: tuple[CandidateResult, ...]
    indistinguishable: tuple[Annotated[tuple[Candidate, ...], Filled(2)], ...]
    check: Literal["records", "blocks of fit"] = "records"
    held_out: bool = False
    bandwidth: Annotated[float, InUnit("Hz"), Bounds(1e-9)] = math.nan
    bandwidth_source: Annotated[str, At("bandwidth.source")] = ""
    undetermined: Annotated[tuple[Undetermined, ...], At("cannot_tell")] = ()
    set_aside: tuple[SetAside, ...] = ()
    offsets: Annotated[tuple[Offset, ...], At("own")] = ()
    record_shift: Mapping[str, RecordShift] = field(default_factory=dict)
    learnable: Annotated[Learnable | None, INLINE] = None
    near_reversals: NearReversals | None = None
    repeats: Repeatability | None = None
    on_all_records: Error | None = None
    at_bound: tuple[str, ...] = ()
    evidence: tuple[StepEvidence, ...] = ()
    fingerprint: Annotated[Fingerprint | None, At("experiment")] = None
    reading: tuple[Any, ...] = ()
    estimated: Annotated[Model | None, At("models.estimated")] = None
    open: tuple[OpenQuestion, ...] | None = None
    not_accepted: tuple[NotAccepted, ...] = ()
    nearest: Nearest | None = None
    no_named_law: Annotated[FreeForm | None, OMIT] = None
    silence: str = ""
    remarks: tuple[str, ...] = ()
    left_out: Annotated[tuple[str, ...], OMIT] = ()
    considered: tuple[str, ...] = ()
    joints: Annotated[Mapping[str, Diagnosis], OMIT] = field(default_factory=dict)
    other_motion: Annotated[Mapping[str, str], OMIT] = field(default_factory=dict)
    links: Annotated[Mapping[str, EstimatedValue], OMIT] = field(default_factory=dict)
    friction_cells: Annotated[Mapping[str, tuple[FrictionCell, ...]], OMIT] = field(
        default_factory=dict
    )
    kind: Annotated[str, OMIT] = ""
    simulation: Annotated[Any, OMIT] = None
    recording: Annotated[DiagnosedRecording, NEVER] = field(
        default=DiagnosedRecording(), compare=False, repr=False
    )

    ALSO_WRITTEN: ClassVar[Mapping[str, str]] = {
        "missing": "missing_places",
        "blind": "blind",
        "left_over_noise_floors": "left",
        "model_parameters": "parameters",
    }

    @property
    def before(self) -> LadderRow:
        """The user's model, re-estimated."""
        return self.rungs[0]

    @property
    def after(self) -> LadderRow:
        """The model with every accepted effect."""
        return self.rungs[-1]

    @property
    def model(self) -> Model:
        """The final model of the diagnosis."""
        return self.after.model

    @property
    def blind(self) -> float:
        """Share of the sliding samples in which the command has no influence, at the end."""
        return self.after.blind

    @property
    def named(self) -> tuple[Candidate, ...]:
        """Accepted effects that are probable enough to be called missing."""
        return tuple(r.added for r in self.rungs if r.added is not None and r.named)

    @property
    def missing(self) -> tuple[Candidate, ...]:
        """Effects that are called missing, in the order added; none where they cannot be named."""
        return self.named if self.verdict == "effects_missing" else ()

    @property
    def missing_places(self) -> list[dict[str, str]]:
        """The effects that are called missing, as an answer writes them."""
        rows = [r for r in self.rungs if r.added is not None and r.added in self.missing]
        more = ({"follows": r.follows, "instead_of": r.instead_of} for r in rows)
        return [
            {"effect": r.added.effect.name, "at": r.added.at}  # type: ignore[union-attr]
            | {key: word for key, word in one.items() if word is not None}
            for r, one in zip(rows, more, strict=True)
        ]

    @property
    def parameters(self) -> dict[str, EstimatedValue]:
        """Parameters of the final model without those of added effects; base parameters of links.

        The inertia of an arm's joint is left out: it includes that of the links. So is that of a
        friction curve, which tells none.
        """
        added = {f"{r.added.at}.{r.added.effect.name}" for r in self.rungs if r.added is not None}
        ours = {f"{joint}.inertia" for joint in (self.model.bodies if self.kind else self.joints)}
        rows = {
            name: estimate_of(self.model, name)
            for name in self.model.parameters
            if name.rpartition(".")[0] not in added and name not in ours
        }
        return rows | {f"arm.{name}": one for name, one in self.links.items()}

    def reason_set_aside(self, key: tuple[str, str]) -> str:
        """Why an effect (name, place) was accepted and removed again; "" for all other effects."""
        return next((one.reason for one in self.set_aside if one.candidate.key == key), "")

    @property
    def unlikely(self) -> bool:
        """Whether the verdict is undecided only because no effect is probable enough."""
        alone = any(r.added is not None and not r.alternatives for r in self.rungs)
        return self.verdict == "undecided" and alone

    @property
    def groups(self) -> tuple[tuple[Candidate, ...], ...]:
        """Groups of effects that explain the records equally well, the accepted one first."""
        return tuple(
            (r.added, *(one.candidate for one in r.alternatives))
            for r in self.rungs
            if r.added is not None and r.alternatives
        )

    @property
    def either(self) -> tuple[LadderRow, ...]:
        """Rows that are not named, but whose effect or one of its look-alikes is likely missing."""
        chances = {c.candidate.key: c.probability for c in self.candidates}

        def together(row: LadderRow) -> float:
            assert row.added is not None
            alike = (row.added, *(one.candidate for one in row.alternatives))
            return sum(chances.get(one.key, 0.0) for one in alike)

        open_rows = (r for r in self.rungs if r.alternatives and r.added not in self.missing)
        return tuple(r for r in open_rows if together(r) >= CRITERIA.named)

    @property
    def more_is_missing(self) -> bool:
        """Whether the final model leaves more than noise."""
        if self.joints:
            return any(one.more_is_missing for one in self.joints.values())
        return not is_adequate(self.after, self.floor)

    @property
    def left(self) -> float:
        """Final error over the noise floor: of the force or at the command, the larger ratio.

        Of an arm: at the joint where it is largest.
        """
        if self.joints:
            return max(one.left for one in self.joints.values())
        return floors_left(self.after, self.floor)

    @property
    def questions(self) -> tuple[OpenQuestion, ...]:
        """The open questions; raises ExperimentError: an older answer does not say them."""
        if self.open is None:
            raise ExperimentError(f'no key "open": {ANEW}; diagnose anew, or leave --answer out')
        return self.open

    @property
    def experiment(self) -> Experiment:
        """The experiment: as given, or read now from the folder that the answer names.

        raises ExperimentError: there is no such folder, or it holds another experiment now
        """
        return self.recording.experiment

    @property
    def prepared(self) -> Prepared:
        """The records, prepared for comparison at the bandwidth of this diagnosis."""
        return self.recording.prepared

    def with_final_model(self, model: Model) -> Diagnosis:
        """The same diagnosis with another final model, such as one body of several."""
        return replace(self, rungs=(*self.rungs[:-1], replace(self.after, fitted=model)))

    def parts(self, row: int = -1) -> list[tuple[Prepared, Model]]:
        """Records and model of each part that is compared alone: all bodies, or each joint.

        row: of the ladder
        """
        model = self.rungs[row].model
        if not self.joints:
            return [(self.prepared, model)]
        return [(one.prepared, model_of_body(model, name)) for name, one in self.joints.items()]

    def fit(self, model: Model) -> Fit:
        """A model of this diagnosis along its records: residuals and their derivatives."""
        return self.recording.evaluate(model)

    @cached_property
    def last_fit(self) -> Fit:
        """The final model along the records."""
        return self.fit(self.model)

    def covariance(self, blocks: Mapping[str, str] | None = None) -> ParameterCovariance:
        """Covariance of the final parameters, for the bands of responses: `bode(covariance=...)`.

        blocks: block of a diagram -> body of the model; None: "Z_M" is the only body
        """
        return covariance_in_blocks(self.model, self.recording.searched, blocks)

    def plot(self) -> Figure:
        """Figure of forces, of the residual over time, velocity and position, and of the ladder."""
        return figure_of(self)
