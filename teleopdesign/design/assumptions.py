"""Assumptions of a design about values that no record shows; each can be stated by the user.

They contain the sampling of the controllers in simulation. The sinusoid for which a design is
predicted lies within the range of the records. A whole diagram completes what it knows of computer
and hand.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..base.arguments import check_types
from ..base.errors import ExperimentError, ModelError, unknown
from ..base.sentences import round_down
from ..base.units import unit_of
from ..block_cuts import BlockDiagnosis
from ..blocks import NINETY_FIVE
from ..diagnose import Diagnosis
from ..diagrams import Attached
from ..measurement.experiment import Experiment
from ..measurement.filtering import Array
from ..measurement.motion import RARE, TRAVEL
from ..measurement.prepare import prepare
from ..realise.reach import Reach
from ..simulate import Sampling, Trajectory, sine


@check_types
@dataclass(frozen=True)
class Assumptions:
    """Assumptions of a design, SI. None: derived from the record, as `design` says.

    load: inertia that stands for the hand, kg or kg m^2; None: three times that of the device
    sample_period: of the controller, s; None: that of the record
    delay: from a sample to the change of the command, s; None: one sample period
    bandwidth: of the low-pass in H, Hz
    velocity_bandwidth: of the filter on the differenced position, Hz; None: 50, at most 0.1/period
    errors: half width of the interval of a level, in standard errors; 1.96: 95 %
    fraction: part of the least level in this interval that is cancelled, at most 1
    delay_factor: H remains stable with this multiple of the delay of its loop
    count_force: part of the level by which one encoder count may change a smoothed cancellation
    counts: encoder counts in the bristle length of a Dahl cancellation
    amplitude, frequency: of the predicted motion, m or rad, Hz; None: from the record
    """

    load: float | None = None
    sample_period: float | None = None
    delay: float | None = None
    bandwidth: float = 20.0
    velocity_bandwidth: float | None = None
    errors: float = NINETY_FIVE
    fraction: float = 0.9
    delay_factor: float = 3.0
    count_force: float = 0.25
    counts: float = 10.0
    amplitude: float | None = None
    frequency: float | None = None

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if value is None:
                continue
            least = 0.0 if name in ("errors", "delay") else math.ulp(0.0)
            most = 1.0 if name in ("fraction", "count_force") else math.inf
            if not (math.isfinite(value) and least <= value <= most):
                words = "above 0, at most 1" if most == 1.0 else "a finite number above 0"
                raise ModelError(f"design: {name}: found {value:g}, expected {words}")
        if self.delay_factor < 1.0:
            raise ModelError(
                f"design: delay_factor: found {self.delay_factor:g}, expected 1 or more"
            )


def sampling_of(assumptions: Assumptions, reach: Reach) -> Sampling:
    """The sampling that the assumptions state, with the encoder of the record.

    assumptions: complete: period, delay and velocity filter are numbers
    """
    period, delay, filtered = (
        assumptions.sample_period,
        assumptions.delay,
        assumptions.velocity_bandwidth,
    )
    assert period is not None and delay is not None and filtered is not None
    return Sampling(
        period=period,
        # in tenths of a sample, the inner steps of the simulation
        delay=round(10 * delay / period) * period / 10,
        encoder_step=reach.step,
        velocity_bandwidth=filtered,
    )


def device_of_diagram(
    diagnosis: BlockDiagnosis, place: str | None, assumptions: Assumptions | None
) -> tuple[Diagnosis, str, Assumptions]:
    """The diagnosis of a device, its place, and the assumptions that the diagram completes.

    The load is the identified inertia of the hand, the delay that of the computer: as stated, and
    as identified beyond. What the caller assumes stands.
    raises ModelError: no such device, or the records do not test it
    """
    experiment, diagram = diagnosis.experiment, diagnosis.experiment.diagram
    devices = [b for b in diagram.moving if b.name in diagnosis.bodies]
    names = [b.name for b in devices]
    if place is None and len(devices) != 1:
        raise ModelError(f"design: place: expected one of {', '.join(names) or 'none'}")
    if place is not None and place not in names:
        raise ModelError(f"design: {unknown('place', place, names)}")
    device = next(b for b in devices if place in (None, b.name))
    computer, settings = experiment.computer, assumptions or Assumptions()
    late = computer.delay + sum(
        p.value
        for p, _ in diagnosis.placed
        if p.key in diagnosis.missing and p.effect.name == "delay" and p.at == "computer"
    )
    held = [b for b in diagram.blocks if isinstance(b, Attached) and b.motion == device.motion]
    tested = [b.name for b in held if b.name in diagnosis.bodies]
    loads = [diagnosis.bodies[n].model.parameters[f"{n}.inertia"].value for n in tested]
    known = {
        "sample_period": computer.sample_period,
        "delay": late or None,
        "load": sum(loads) or None,
    }
    if np.isfinite(computer.velocity_bandwidth):
        known["velocity_bandwidth"] = computer.velocity_bandwidth
    missing: dict[str, Any] = {n: v for n, v in known.items() if getattr(settings, n) is None}
    return diagnosis.bodies[device.name], device.name, replace(settings, **missing)


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
