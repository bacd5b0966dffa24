"""The design that follows from a measurement: its proposals, predictions and claims."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..base.errors import ModelError
from ..base.files import write_json
from ..base.frozen import ByValue
from ..base.toml import comment_text
from ..blocks import Body
from ..diagrams import ANY, Attached, Block, Diagram, Moving, haptic_interface
from ..diagrams.toml_writing import diagram_text
from ..frequency import FrequencyResponse
from ..passivity import Claim
from ..realise.friction_interval import FrictionInterval
from ..realise.reach import Reach
from ..simulate import Sampling
from .assumptions import Assumptions
from .chosen import ProposedController
from .design_data import design_data
from .felt_impedance import FeltImpedance
from .force_feedback import FeedbackLoop
from .prediction import Prediction
from .residual_friction import ResidualFriction
from .sampling import sampling_of
from .sentences import design_text

if TYPE_CHECKING:
    import matplotlib.figure


@dataclass(frozen=True, eq=False)
class Design(ByValue):
    """A compensation for the body at `place` of an experiment.

    body: as the diagnosis identified it;  friction: range of its level, None: no friction level
    cancellation: C; None where no cancellation is certain to be passive
    other: the second-best law for C;  other_left: force error of the hybrid with that law
    force_feedback: H;  loop: its loop at rest;  prediction: force errors of the four cases
    impedance: Zhat_M that a hand feels, simulated and by describing functions
    residual: friction left in slow steady motion, in the middle of the travel
    transparency: T of the four cases, by linear theory, with the load in place of the hand
    claims: case -> claims on passivity, each with its proof or evidence;  notes: warnings
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
    impedance: FeltImpedance
    residual: ResidualFriction
    transparency: FrequencyResponse
    claims: Mapping[str, tuple[Claim, ...]]
    notes: tuple[str, ...]

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
        from ..show.figures.design_from_measurement import plot_design

        return plot_design(self)

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
        """The design as plain data; SI units."""
        return design_data(self)

    def to_json(self, path: str | Path) -> None:
        """Write the design as JSON."""
        write_json(path, self.as_dict())

    def __repr__(self) -> str:
        return design_text(self)


def _nameless(diagram: Diagram) -> tuple[Block, ...]:
    """The blocks, with bodies reduced to their name."""
    return tuple(
        replace(b, body=ANY) if isinstance(b, Moving | Attached) else b for b in diagram.blocks
    )
