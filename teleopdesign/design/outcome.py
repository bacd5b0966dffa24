"""The design that follows from a measurement: its proposals, predictions and claims."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..base.errors import ModelError
from ..base.files import make_plain, write_json
from ..base.frozen import ByValue
from ..base.shown import Shown, figure_of, look
from ..base.toml import comment_text
from ..base.units import unit_of
from ..blocks import Body
from ..diagrams import ANY, Attached, Block, Diagram, Moving, haptic_interface
from ..diagrams.toml_writing import diagram_text
from ..frequency import FrequencyResponse
from ..passivity import Claim
from ..realise.friction_interval import FrictionInterval
from ..realise.reach import Reach
from ..simulate import Sampling
from .assumptions import Assumptions, sampling_of
from .cancellation import ProposedController
from .expected import ExpectedError
from .force_feedback import FeedbackLoop
from .other_effects import LEVEL
from .prediction import FeltImpedance, Prediction
from .quasi_static import ResidualFriction

if TYPE_CHECKING:
    import matplotlib.figure


@dataclass(frozen=True, eq=False)
class Design(Shown, ByValue):
    """A compensation for the body at `place` of an experiment.

    body: as the diagnosis identified it;  friction: range of its level, None: no friction level
    cancellation: C; None where no cancellation is certain to be passive
    other: the second-best law for C;  other_left: force error of the hybrid with that law
    force_feedback: H;  loop: its loop at rest;  prediction: force errors of the four cases
    expected: force error of the case that the recorded sensors allow, as an interval
    not_cancelled: effects of the body that C does not make up for -> why
    impedance: Zhat_M that a hand feels, simulated and by describing functions
    residual: friction left in slow steady motion, in the middle of the travel
    transparency: T of the four cases, by linear theory, with the load in place of the hand
    claims: case -> claims on passivity, each with its proof or evidence
    verdict, left: of the diagnosis, as in `Diagnosis`
    """

    experiment: str
    place: str
    body: Body
    assumptions: Assumptions
    reach: Reach
    friction: FrictionInterval | None
    cancellation: ProposedController | None
    other: ProposedController | None
    other_left: float
    force_feedback: ProposedController
    loop: FeedbackLoop
    prediction: Prediction
    expected: ExpectedError
    not_cancelled: Mapping[str, str]
    impedance: FeltImpedance
    residual: ResidualFriction
    transparency: FrequencyResponse
    claims: Mapping[str, tuple[Claim, ...]]
    verdict: str
    left: float

    @property
    def notes(self) -> tuple[str, ...]:
        """Warnings, to be read with the numbers."""
        return tuple(look(self, "notes"))

    @property
    def follows_level(self) -> bool:
        """Whether C follows the friction level over place, load, speed or direction."""
        names = () if self.cancellation is None else self.cancellation.controller.names()
        parts = {n.split(".")[1] for n in names}
        levels = (e.name for e in self.body.effects if e.role in LEVEL)
        return any(name in parts for name in levels if name != "coulomb")

    @property
    def held(self) -> FeedbackLoop:
        """The loop of H at rest while the device is held rigidly: a load without limit."""
        gain = self.force_feedback.controller.names()["velocity_schedule.gain"]
        return replace(self.loop, gain=gain)

    @property
    def sampling(self) -> Sampling:
        """Sampling of the controllers in simulation."""
        return sampling_of(self.assumptions, self.reach)

    def plot(self) -> matplotlib.figure.Figure:
        """Plot force error over velocity in the four cases, friction left in slow motion, and T."""
        return figure_of(self)

    @property
    def diagram(self) -> Diagram:
        """The device with the proposed controllers, in free space."""
        return haptic_interface(
            self.body,
            cancellation=self.cancellation.controller if self.cancellation else None,
            force_feedback=self.force_feedback.controller,
        )

    def to_toml(self) -> str:
        """The diagram as text for a file that `read_diagram` reads, with reasons for each number.

        A device with effects that are in no catalogue is only a name in this file.
        """
        chosen = [c for c in (self.cancellation, self.force_feedback) if c is not None]
        comments = [
            f"{self.experiment}, {self.place}",
            *(str(r) for c in chosen for r in c.reasons),
        ]
        try:
            content = diagram_text(self.diagram)
        except ModelError:
            content = diagram_text(replace(self.diagram, blocks=_nameless(self.diagram)))
        return "\n".join([*map(comment_text, comments), "", content])

    def as_dict(self) -> dict[str, Any]:
        """The design as plain data, SI units; a number that is not finite is null."""
        axis = self.body.axis
        residual = self.residual
        content = {
            "experiment": self.experiment,
            "place": self.place,
            "axis": axis,
            "units": {q: unit_of(q, axis) for q in ("force", "position", "velocity", "stiffness")},
            "model_parameters": {
                n: {"value": v.value, "stderr": v.stderr, "unit": self.body.unit(n)}
                for n, v in self.body.parameters.items()
            },
            "assumptions": asdict(self.assumptions),
            "recorded": asdict(self.reach),
            "friction": _friction(self),
            "cancellation": _chosen(self.cancellation),
            "second_cancellation": _chosen(self.other),
            "force_feedback": _chosen(self.force_feedback),
            "loop": _loop(self.loop),
            "loop_held_rigidly": _loop(self.held),
            "motion": asdict(self.prediction.motion),
            "prediction": {case: asdict(p) for case, p in self.prediction.cases.items()},
            "expected": asdict(self.expected),
            "not_cancelled": dict(self.not_cancelled),
            "taken_rigid_in_simulation": self.prediction.rigid,
            "left_out_of_linear": self.prediction.left_out,
            "felt_impedance": _impedance(self.impedance),
            "residual_friction": {
                "speed": residual.speeds.tolist(),
                **{case: row.tolist() for case, row in residual.rows.items()},
            },
            "passivity": {
                case: [_claim(c) for c in claims] for case, claims in self.claims.items()
            },
            "notes": list(self.notes),
            "diagram_toml": self.to_toml(),
        }
        data: dict[str, Any] = make_plain(content)
        return data

    def to_json(self, path: str | Path) -> None:
        """Write the design as JSON."""
        write_json(path, self.as_dict())


def _nameless(diagram: Diagram) -> tuple[Block, ...]:
    """The blocks, with bodies reduced to their name."""
    return tuple(
        replace(b, body=ANY) if isinstance(b, Moving | Attached) else b for b in diagram.blocks
    )


def _friction(design: Design) -> dict[str, Any] | None:
    """The friction interval, and half of the travel in bristle lengths; None without friction."""
    if design.friction is None:
        return None
    lengths = design.friction.bristle_lengths(design.reach.travel)
    return {**asdict(design.friction), "bristle_lengths": lengths}


def _impedance(felt: FeltImpedance) -> dict[str, Any]:
    """Magnitude (dB) and phase (deg) of each case over frequency (Hz), simulated and predicted.

    95 %: half widths of the band that the estimates of the device leave to the prediction
    """
    data: dict[str, Any] = {"missing": list(felt.missing)}
    for how, one in (("simulated", felt.simulated), ("predicted", felt.predicted)):
        if one is None:
            continue
        data["frequency"] = one.data["frequency"].values.tolist()
        data["amplitude"] = one.data["amplitude"].values.tolist()
        data[how] = {
            str(case): {
                "decibel": one.decibel.sel(case=case).values.tolist(),
                "phase": one.phase.sel(case=case).values.tolist(),
            }
            for case in one.data["case"].values
        }
        if one.band is not None:
            for row, case in enumerate(one.data["case"].values):
                data[how][str(case)]["95 %"] = {
                    "decibel": one.band.decibel[row].tolist(),
                    "phase": one.band.degrees[row].tolist(),
                }
    return data


def _chosen(chosen: ProposedController | None) -> dict[str, Any] | None:
    if chosen is None:
        return None
    return {
        "laws": [stage.law.name for stage in chosen.controller.stages],
        "parameters": {
            r.parameter: {"value": r.value, "unit": r.unit, "why": r.why} for r in chosen.reasons
        },
    }


def _loop(loop: FeedbackLoop) -> dict[str, Any]:
    return {
        **asdict(loop),
        "crossover": loop.crossover,
        "phase_margin": loop.phase_margin,
        "largest_delay": loop.largest_delay,
    }


def _claim(claim: Claim) -> dict[str, Any]:
    return {
        "status": claim.status,
        "holds": claim.holds,
        "statement": claim.statement,
        "how": str(claim.verdict),
        "certificates": len(claim.certificates),
    }
