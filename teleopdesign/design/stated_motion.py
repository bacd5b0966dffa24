"""The sinusoid for which a design is predicted, within the range of the records.

The range of the records of an experiment: travel, speed, command, sensors, sampling.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ..base.errors import ExperimentError, ModelError
from ..base.sentences import round_down
from ..base.units import unit_of
from ..measurement.experiment import Experiment
from ..measurement.filtering import Array
from ..measurement.motion import RARE, TRAVEL
from ..measurement.prepare import prepare
from ..realise.reach import Reach
from ..simulate import Trajectory, sine
from .assumptions import Assumptions

#: Hz: lowest frequency of a chosen motion; slower motions cost time and show nothing new
SLOWEST = 0.2


@dataclass(frozen=True)
class StatedMotion:
    """The motion centre + amplitude sin(2 pi frequency t); m or rad, Hz."""

    centre: float
    amplitude: float
    frequency: float

    @property
    def omega(self) -> float:
        """Angular frequency, rad/s."""
        return 2 * math.pi * self.frequency

    @property
    def peak_speed(self) -> float:
        """Peak speed, m/s or rad/s."""
        return self.omega * self.amplitude

    @property
    def motion(self) -> Trajectory:
        """The motion as functions of time."""
        about = sine(amplitude=self.amplitude, frequency=self.frequency)

        def position(time: Array) -> Array:
            return self.centre + about.position(time)

        return replace(about, position=position)

    def cycle(self, rows: int) -> tuple[Array, Array, Array, Array]:
        """Time, position, velocity and acceleration over one cycle, each (rows,)."""
        time = np.arange(rows) / rows / self.frequency
        position, velocity, acceleration = (f(time) for f in self.motion.all)
        return time, position, velocity, acceleration


def stated_motion(reach: Reach, assumptions: Assumptions, axis: str) -> StatedMotion:
    """The stated motion; by default at most a quarter of the travel, at the recorded rms speed.

    raises ModelError: the motion exceeds the recorded travel or speed
    """
    speed = math.sqrt(2) * reach.rms_speed
    speed = min(speed, 0.95 * reach.peak_speed)
    amplitude, frequency = assumptions.amplitude, assumptions.frequency
    if amplitude is None:
        amplitude = reach.travel / 4
        slow = frequency or SLOWEST
        amplitude = round_down(min(amplitude, speed / (2 * math.pi * slow)), digits=2)
    if frequency is None:
        frequency = round_down(speed / (2 * math.pi * amplitude), digits=2)
    motion = StatedMotion((reach.low + reach.high) / 2, amplitude, frequency)
    if 2 * amplitude > reach.travel:
        raise ModelError(
            f"design: amplitude: {amplitude:g} {unit_of('position', axis)} leaves the recorded "
            f"travel of {reach.travel:.3g} {unit_of('position', axis)}, expected at most "
            f"{reach.travel / 2:.3g} {unit_of('position', axis)}"
        )
    if motion.peak_speed > reach.peak_speed:
        unit = unit_of("velocity", axis)
        raise ModelError(
            f"design: frequency: {frequency:g} Hz at {amplitude:g} {unit_of('position', axis)} is "
            f"{motion.peak_speed:.3g} {unit}, recorded are at most {reach.peak_speed:.3g} {unit}"
        )
    return motion


def reach_of(experiment: Experiment, place: str) -> Reach:
    """The recorded range of one body: travel, speed, command, sensors and sampling.

    raises ExperimentError: the body does not move in the records, or is a friction curve
    """
    if experiment.kind:
        raise ExperimentError(
            "design: a friction curve tells no inertia and no motion: td.cancel(model.body("
            '"device"), smoothing_velocity=...) cancels its friction'
        )
    motions = [s.motion for s in prepare(experiment).stretches if s.motion.body == place]
    position = np.concatenate([m.position for m in motions])
    speed = np.abs(np.concatenate([m.velocity for m in motions]))
    if not speed.any():
        raise ExperimentError(f"{experiment.folder.name}: {place}.position: it never moves")
    ways = np.concatenate([m.direction for m in motions])
    records, step = experiment.records, max(m.step for m in motions)
    acceleration = float(np.sqrt(np.mean(np.concatenate([m.acceleration**2 for m in motions]))))
    after_reversal = acceleration / (2 * motions[0].bandwidth) ** 2 / 2
    return Reach(
        low=float(position.min()),
        high=float(position.max()),
        peak_speed=float(speed.max()),
        rms_speed=float(np.sqrt(np.mean(speed**2))),
        command=float(max(np.abs(m.command).max() for m in motions)),
        duration=max(r.duration for r in records),
        sample_period=records[0].sample_time,
        step=step,
        unresolved=max(TRAVEL * step, after_reversal),
        both_ways=bool(min(np.sum(ways > 0), np.sum(ways < 0)) >= RARE * np.sum(ways != 0)),
        measures_force=f"{place}.interaction_force" in experiment.channels,
    )
