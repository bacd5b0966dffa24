"""A second recording, made with the compensation on, against what the design predicted for it.

The hand moves the device, and the desired force is zero. The computer's laws run along the recorded
readings, and the body, drawn within its standard errors, needs a force for the recorded motion. The
force error R_D - R_M is then the interaction force, measured and predicted, both below the
bandwidth of the comparison. What readings and the diagnosis leave moves its rms by at most their
own. While the body rests, friction balances the hand: these moments test nothing.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..base.errors import ExperimentError, ModelError, did_you_mean
from ..base.files import write_text
from ..base.frozen import ByValue
from ..base.shown import Shown, figure_of
from ..blocks import NINETY_FIVE, Body
from ..diagnose.criteria import CRITERIA
from ..diagnose.noise_floor import noise_floor
from ..diagrams import Diagram, four_cases, read_diagram
from ..measurement.experiment import Experiment
from ..measurement.filtering import Array
from ..model import Model
from ..simulate import Sampling
from .deviations import Deviation, deviations_of
from .expected import drawn_values
from .outcome import Design
from .second_recording import SecondRecording

#: bodies that are drawn: the spread of the rms is then known to a fifth
DRAWS = 16
_NO_DESIGN = "holds no design, expected a file that `teleopdesign design --json` wrote"


@dataclass(frozen=True, eq=False)
class Verification(Shown, ByValue):
    """The force error with the compensation on, measured and predicted, N or N m.

    case: of compensation;  low, high: predicted interval (95 %) of the rms about the mean
    measured: the rms about its mean;  without: predicted without compensation
    rows: name -> (n,): "time", "velocity", "measured", "predicted" and "without"
    axis: "prismatic" or "revolute"
    deviations: numbers of compensator and device that differ from the design, each first of those
        that explain the recording as well
    """

    case: str
    low: float
    high: float
    measured: float
    without: float
    rows: Mapping[str, Array]
    axis: str
    deviations: tuple[tuple[Deviation, ...], ...] = ()

    @property
    def holds(self) -> bool:
        """Whether the measured error lies in the predicted interval."""
        return self.low <= self.measured <= self.high

    def plot(self) -> Any:
        """Plot the force error over velocity before and after, on one scale."""
        return figure_of(self)


@dataclass(frozen=True, eq=False)
class Plan:
    """What a design predicts from: the diagram, its computer, and the force left unexplained."""

    diagram: Diagram
    sampling: Sampling
    place: str
    case: str
    unexplained: float

    @classmethod
    def of(cls, design: Design) -> Plan:
        """The plan of a design in memory."""
        expected = design.expected
        made = design.diagram, design.sampling, design.place, expected.case, expected.unexplained
        return cls(*made)


def read_plan(path: str | Path, place: str | None = None) -> Plan:
    """The plan in a file that `teleopdesign design --json` wrote; place: which body.

    raises ExperimentError: the file cannot be read, or holds no design of this body
    """
    path = Path(path)
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        bodies = content["bodies"] if "bodies" in content else {content["place"]: content}
        at = next(iter(bodies)) if place is None else place
    except (OSError, ValueError) as error:
        raise ExperimentError(f"{path}: cannot be read as a design: {error}") from None
    except (KeyError, TypeError, StopIteration):
        raise ExperimentError(f"{path}: {_NO_DESIGN}") from None
    if at not in bodies:
        raise ExperimentError(f'{path}: no design for "{at}"{did_you_mean(str(at), bodies)}')
    try:
        return _plan_from(bodies[at], at, path)
    except (KeyError, TypeError):
        raise ExperimentError(f'{path}: "{at}": {_NO_DESIGN}') from None


def _plan_from(one: Mapping[str, Any], at: str, path: Path) -> Plan:
    """The plan of one body; raises KeyError, TypeError: the content is none of a design."""
    return Plan(
        _diagram_of(one["diagram_toml"], path),
        Sampling(
            period=one["assumptions"]["sample_period"],
            delay=one["assumptions"]["delay"],
            encoder_step=one["recorded"]["step"],
            velocity_bandwidth=one["assumptions"]["velocity_bandwidth"],
        ),
        at,
        one["expected"]["case"],
        one["expected"]["unexplained"],
    )


def _diagram_of(text: str, path: Path) -> Diagram:
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / path.with_suffix(".toml").name
        write_text(file, text)
        return read_diagram(file)


def verify(
    design: Design | Plan,
    experiment: Experiment,
    *,
    case: str | None = None,
    without: Experiment | None = None,
) -> Verification:
    """Compare a recording with the compensation on with what the design predicts along it.

    experiment: of the same body, with its interaction force; the desired force was zero
    case: "MBC", "FF" or "hybrid", as it was switched on; default: as the design leads with
    without: a recording of the same time without compensation, which tells a changed device from a
        changed compensator where the command with C was not recorded
    raises ExperimentError: no interaction force, or no motion;  ModelError: no such case
    """
    plan = Plan.of(design) if isinstance(design, Design) else design
    cases = four_cases(plan.diagram, every=True)
    case = case or plan.case
    if case not in cases:
        raise ModelError(f'verify: no case "{case}", has {", ".join(cases)}')
    if f"{plan.place}.interaction_force" not in experiment.channels:
        raise ExperimentError(
            f"{experiment.folder.name}: {plan.place}.interaction_force: is no channel: without it "
            "no recording shows the force error"
        )
    on = SecondRecording.of(cases[case], plan.sampling, experiment, plan.place)
    hand, commands = np.concatenate(on.hand()), on.commands()

    def predicted(body: Body, commands: list[Array]) -> Array:
        return hand - np.concatenate(on.left_by(commands, body))

    drawn = [predicted(body, commands) for body in _drawn_bodies(on)]
    alone = predicted(on.body, [np.zeros(len(u)) for u in commands])
    floor = _floor(on, plan.place)
    left = math.hypot(floor, plan.unexplained)
    sizes = [float(np.std(one)) for one in drawn]
    middle, half = float(np.mean(sizes)), NINETY_FIVE * float(np.std(sizes)) + left
    off = without and SecondRecording.of(on.diagram, plan.sampling, without, plan.place)
    return Verification(
        case,
        max(middle - half, 0.0),
        middle + half,
        float(np.std(hand)),
        float(np.std(alone)),
        {
            "time": on.along("time"),
            "velocity": on.along("velocity"),
            "measured": _about_mean(hand),
            "predicted": _about_mean(drawn[0]),
            "without": _about_mean(alone),
        },
        on.body.axis,
        deviations_of(on, off, enough=CRITERIA.adequate * left),
    )


def _about_mean(values: Array) -> Array:
    return np.asarray(values - np.mean(values))


def _drawn_bodies(on: SecondRecording) -> Iterator[Body]:
    """The body within its standard errors, the estimates first."""
    values = drawn_values(on.diagram, DRAWS, first_exact=True)
    names = {n: n.partition(".")[2] for n in values}
    for k in range(DRAWS):
        yield on.body.with_values({names[n]: float(np.asarray(v)[k]) for n, v in values.items()})


def _floor(on: SecondRecording, place: str) -> float:
    """Rms force that the readings alone leave of the right device, N or N m."""
    model = Model({place: on.body})
    floor = noise_floor(model, on.prepared, np.random.default_rng(0)).value
    force = np.concatenate(
        [on.low(i, s.motion.command + s.motion.interaction) for i, s in enumerate(on.stretches)]
    )
    return floor * float(np.sqrt(np.mean(force**2)))
