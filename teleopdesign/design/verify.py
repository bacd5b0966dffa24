"""A second recording, made with the compensation on, against what the design predicted for it.

The hand moves the device, and the desired force is zero. Along the recorded motion the design's own
diagram is simulated, with the body drawn within its standard errors. The force error R_D - R_M is
then the interaction force, measured and predicted, both below the bandwidth of the comparison.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..base.errors import ExperimentError, ModelError, did_you_mean
from ..base.files import write_text
from ..base.frozen import ByValue
from ..base.shown import Shown, figure_of
from ..diagrams import Diagram, four_cases, read_diagram
from ..measurement.experiment import Experiment
from ..measurement.filtering import Array
from ..measurement.motion import Motion
from ..measurement.prepare import TRIM, prepare
from ..simulate import Sampling, Trajectory, simulate_many
from .expected import drawn_values
from .outcome import Design
from .prediction import BRISTLE_SHARE

#: s: longest part of a record that is simulated; several cycles of a slow motion
LONGEST = 20.0
_NO_DESIGN = "holds no design, expected a file that `teleopdesign design --json` wrote"


@dataclass(frozen=True, eq=False)
class Verification(Shown, ByValue):
    """The force error with the compensation on, measured and predicted, N or N m.

    case: of compensation;  low, high: predicted interval (95 %) of the rms about the mean
    measured: the rms about its mean;  without: predicted without compensation
    rows: name -> (n,): "time", "velocity", "measured", "predicted" and "without"
    axis: "prismatic" or "revolute"
    """

    case: str
    low: float
    high: float
    measured: float
    without: float
    rows: Mapping[str, Array]
    axis: str

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
    design: Design | Plan, experiment: Experiment, *, case: str | None = None
) -> Verification:
    """Compare a recording with the compensation on with what the design predicts along it.

    experiment: of the same body, with its interaction force; the desired force was zero
    case: "MBC", "FF" or "hybrid", as it was switched on; default: as the design leads with
    raises ExperimentError: no interaction force, or no motion;  ModelError: no such case
    """
    plan = Plan.of(design) if isinstance(design, Design) else design
    cases = four_cases(plan.diagram, every=True)
    case = case or plan.case
    if case not in cases:
        raise ModelError(f'verify: no case "{case}", has {", ".join(cases)}')
    motion = _longest_motion(experiment, plan.place)
    counted = _rows_that_count(motion)
    measured = _about_mean(motion.lowpassed(motion.interaction)[counted])
    predicted = _force_along(cases[case], motion, plan.sampling)[:, counted]
    without = _force_along(cases["none"], motion, plan.sampling, draws=1)[0, counted]
    sizes = np.std(predicted, axis=1)
    middle, half = float(np.mean(sizes)), 1.96 * float(np.std(sizes))
    rows = {
        "time": motion.time[: len(counted)][counted],
        "velocity": motion.velocity[: len(counted)][counted],
        "measured": measured,
        "predicted": _about_mean(predicted[0]),
        "without": _about_mean(without),
    }
    low, high = max(middle - half, 0.0), math.hypot(middle + half, plan.unexplained)
    axis = experiment.bodies[plan.place].axis
    size = float(np.std(measured))
    return Verification(case, low, high, size, float(np.std(without)), rows, axis)


def _about_mean(values: Array) -> Array:
    return np.asarray(values - np.mean(values))


def _longest_motion(experiment: Experiment, place: str) -> Motion:
    if f"{place}.interaction_force" not in experiment.channels:
        raise ExperimentError(
            f"{experiment.folder.name}: {place}.interaction_force: is no channel: without it no "
            "recording shows the force error"
        )
    motions = [s.motion for s in prepare(experiment).stretches if s.motion.body == place]
    return max(motions, key=lambda m: len(m.time))


def _rows_that_count(motion: Motion) -> Array:
    """Which of the simulated samples count, (n,)."""
    number = min(len(motion.time), int(LONGEST / motion.sample_time))
    at = np.arange(number) * motion.sample_time
    return np.asarray((at >= TRIM) & (at <= at[-1] - TRIM))


def _force_along(diagram: Diagram, motion: Motion, sampling: Sampling, *, draws: int = 16) -> Array:
    """Force error of a diagram along a recorded motion, low-passed, (draws, n).

    The first draw has the estimates.
    """
    number = len(_rows_that_count(motion))
    at = np.arange(number) * motion.sample_time

    def course(samples: Array) -> Any:
        return lambda t: np.interp(t, at, samples[:number])

    parts = motion.position, motion.velocity, motion.acceleration
    run = simulate_many(
        diagram,
        drawn_values(diagram, draws, first_exact=True),
        duration=at[-1],
        motion={"L": Trajectory(*map(course, parts))},
        computer=sampling,
        step=sampling.period / 10,
        give=BRISTLE_SHARE * float(np.ptp(motion.position)) / 2,
        keep=["E"],
    )
    times = run["time"].values
    forces = np.array([np.interp(at, times, row) for row in run["E"].values])
    return np.array([motion.lowpassed(row) for row in forces])
