"""The motion of one body through one uninterrupted stretch of a record, ready for comparison."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..base.frozen import ByValue
from .encoder import reading_noise, reading_step
from .filtering import Array, Spectrum, held_command, spectrum
from .limits import HALF
from .record import Record
from .spikes import hum_of, without_hum

#: edge of the smoothing over the bandwidth of the comparison: below the bandwidth |H| > 0.998
SMOOTHING = 1.5
#: a body whose reading is constant for longer than this part of a period at the bandwidth may stick
DWELL = 0.25
#: fewest steps of a reading in a motion: a shorter one may be the deflection of a sticking contact
TRAVEL = 3
#: velocities within so many errors, from the noise of readings, count as rest: in slow motion the
#: steps of an encoder are no white noise, and their error is larger than that of white noise
SLOW = 4.0
#: part (of the motion in one direction, of the time, of a force) below which it counts as absent
RARE = 0.02
#: s, shortest stretch that leaves something after the ends are trimmed
SHORTEST = 0.6


@dataclass(frozen=True, eq=False)
class LinkForces(ByValue):
    """Force that the links of an arm need at one joint, along a motion of n samples, SI.

    constant: (n,) from the known parameters;  columns: (b, n) per unit of each base parameter
    smooth: the same columns through the low-pass of the comparison, less what friction at rest
        takes up in the model at hand, if there is one
    inertia: part of the forces that belongs to the body itself and is not carried
    drawn: the same forces with the positions of all joints read anew, for the noise floor
    """

    constant: Array
    columns: Array
    smooth: Array
    drawn: tuple[LinkForces, ...] = ()
    inertia: float = 0.0

    def carried(self, values: Sequence[float], acceleration: Array) -> Array:
        """The force (n,) at the values (b,) of the base parameters; acceleration: (n,)."""
        force = self.constant + np.asarray(values) @ self.columns if len(values) else self.constant
        return force - self.inertia * acceleration


@dataclass(frozen=True, eq=False)
class Motion(ByValue):
    """One body along one segment (n samples, uniform); all SI, position positive like the forces.

    position, velocity, acceleration: smoothed to `SMOOTHING` times the bandwidth, zero phase
    command: as commanded, held until the next row;  interaction: smoothed (zeros if not measured)
    direction: +1 or -1, or 0 where the readings do not show a direction
    step: uncertainty of one position reading (encoder step, or a multiple of its noise)
    rows: place of the samples in the record;  bandwidth: of the comparison, Hz
    further: other channels: "temperature", "other_position" and its derivatives, smoothed alike
    command_late: s by which the log of the command is later than that of the position
    interaction_late: s, time constant of the sensor of the interaction force; its low-pass is
        removed from `interaction`
    merged: rows of the record from one sample to the next; 1 unless samples were left out
    links: of the arm, if the body is a joint of an arm;  carried: (n,) the force that the links
        need
    The points of a friction curve are a motion without time: their bandwidth is inf, nothing is
    filtered, acceleration and position are 0.
    """

    body: str
    file: str
    time: Array
    position: Array
    velocity: Array
    acceleration: Array
    command: Array
    interaction: Array
    direction: NDArray[np.int8]
    step: float
    rows: slice
    spectrum: Spectrum
    smoothing: Array
    bandwidth: float
    command_late: float = 0.0
    interaction_late: float = 0.0
    merged: int = 1
    further: Mapping[str, Array] = field(default_factory=dict)
    links: LinkForces | None = None
    carried: Array | None = None

    @property
    def is_curve(self) -> bool:
        """Whether the samples are points of a friction curve, without time."""
        return self.bandwidth == np.inf

    @property
    def sample_time(self) -> float:
        """Time between samples, s."""
        return self.spectrum.sample_time

    def at_rows(self, staircase: Array) -> Array:
        """A held signal, constant from row to row, as a smooth signal at the rows, (..., n).

        The signal is advanced by `command_late`, the delay of its log.

        staircase: (..., n), or (..., k n) with k values in turn for equal parts of each row
        """
        if self.is_curve:
            return staircase
        if staircase is self.command:
            held = held_command(self.command, self.spectrum)
            return held.smooth(self.command_late, self.smoothing)
        parts = staircase.shape[-1] // len(self.time)
        s = self.spectrum
        transformed = s.transform(staircase[..., ::parts]) * s.hold(parts, 0)
        for k in range(1, parts):
            transformed += s.transform(staircase[..., k::parts]) * s.hold(parts, k)
        return s.back(transformed * (self.smoothing * s.ahead(self.command_late)))

    def lowpassed(self, y: Array, at: NDArray[np.intp] | None = None) -> Array:
        """Signals (..., n) through the low-pass of the comparison; at: only these rows."""
        if self.is_curve:
            return y if at is None else y[..., at]
        from .zero_phase import zero_phase  # numba: only where something is filtered

        return zero_phase(y, self.bandwidth, self.sample_time, at)


def direction_of(position: Array, change: float, step: float, patience: int) -> NDArray[np.int8]:
    """Direction of motion: +1 or -1 where consecutive readings show it, else 0; shape (n,).

    A motion shows in changes of the reading in the same direction, no more than `patience` samples
    apart, over at least `TRAVEL` steps; a shorter one may be the deflection of a contact that
    holds. Between motions the body may rest, creep or turn: the direction is 0.

    change: smallest change of a reading that counts;  step: uncertainty of one reading
    """
    direction = np.zeros(len(position), dtype=np.int8)
    changes = np.flatnonzero(np.abs(np.diff(position)) > HALF * change) + 1
    if len(changes) < 2:
        return direction
    sign = np.sign(position[changes] - position[changes - 1]).astype(np.int64)
    same = (sign[1:] == sign[:-1]) & (np.diff(changes) <= patience)
    runs = np.concatenate([[0], np.flatnonzero(~same) + 1, [len(changes)]])
    first, last = runs[:-1], runs[1:] - 1
    travel = np.abs(position[changes[last]] - position[changes[first] - 1])
    long = (travel > (TRAVEL - 0.5) * step) & (last > first)
    edges = np.zeros(len(position) + 1, dtype=np.int64)
    np.add.at(edges, changes[first[long]], sign[first[long]])
    np.add.at(edges, changes[last[long]], -sign[first[long]])
    return np.cumsum(edges[:-1]).astype(np.int8)


def mark_neighbours(marked: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Mask (n,) of the marked samples and of the samples next to them."""
    wide = marked.copy()
    wide[1:] |= marked[:-1]
    wide[:-1] |= marked[1:]
    return wide


def play(position: Array, width: float) -> Array:
    """Position behind a play (backlash) of total width `width`: it follows only larger motions."""
    half = 0.5 * width
    out = np.empty_like(position)
    here = position[0]
    for k, x in enumerate(position.tolist()):
        here = min(max(here, x - half), x + half)
        out[k] = here
    return out


def motion_of(
    *,
    body: str,
    file: str,
    time: Array,
    position: Array,
    command: Array,
    interaction: Array | None,
    sample_time: float,
    rows: slice,
    bandwidth: float,
    resolution: float | None,
    further: Mapping[str, Array] | None = None,
) -> Motion:
    """Smooth and differentiate one uninterrupted stretch of readings (n samples each, SI).

    bandwidth: Hz, of the comparison;  resolution: encoder step; None: not stated
    further: readings of other channels, "temperature" and "other_position"
    """
    n = len(position)
    s = spectrum(n, sample_time)
    smoothing = s.lowpass(min(SMOOTHING * bandwidth, 0.45 / sample_time), order=8)
    transformed = s.transform(position) * smoothing
    noise = reading_noise(position)
    # rounding to steps has an rms of 0.29 steps: more is noise
    step, reading = resolution or reading_step(position), position
    if noise > 0.6 * step:
        step = max(step, 4.0 * noise)
        reading = play(position, step)
    patience = max(2, round(DWELL / bandwidth / sample_time))
    change = step if reading is position else 1e-9 * step
    differentiated = smoothing * s.derivative(1)
    velocity = s.back(transformed * s.derivative(1))
    noise_left = step / np.sqrt(12.0) * float(np.sqrt(np.mean(np.abs(differentiated) ** 2)))
    direction = direction_of(reading, change, step, patience)
    more = {}
    for name, signal in (further or {}).items():
        smooth = s.transform(signal) * smoothing
        more[name] = s.back(smooth)
        if name == "other_position":
            more["other_velocity"] = s.back(smooth * s.derivative(1))
            more["other_acceleration"] = s.back(smooth * s.derivative(2))
    direction[mark_neighbours(np.abs(velocity) < SLOW * noise_left)] = 0
    return Motion(
        body=body,
        file=file,
        time=time,
        position=s.back(transformed),
        velocity=velocity,
        acceleration=s.back(transformed * s.derivative(2)),
        command=command,
        interaction=np.zeros(n) if interaction is None else s.multiply(interaction, smoothing),
        direction=direction,
        step=step,
        rows=rows,
        spectrum=s,
        smoothing=smoothing,
        bandwidth=bandwidth,
        further=more,
    )


def without_mains(record: Record, name: str) -> Array:
    """A force of a record (n,), minus a hum of the mains that no position shows."""
    force = record.signals[name]
    longest = record.longest
    positions = [x[longest] for key, x in record.signals.items() if key.endswith(".position")]
    hum = hum_of(force[longest], positions, record.sample_time)
    if hum is None:
        return force
    clean = force.copy()
    for rows in record.segments:
        clean[rows] = without_hum(force[rows], hum, record.sample_time)
    return clean


#: channels of a body that a law may use besides those of its motion
FURTHER = ("temperature", "other_position")


def motions(
    record: Record, body: str, *, bandwidth: float, resolution: float | None
) -> tuple[Motion, ...]:
    """The motions of one body in one record: the segments of at least `SHORTEST`.

    bandwidth: Hz, of the comparison;  resolution: encoder step (SI); None: not stated
    """
    command = without_mains(record, f"{body}.actuator_force")
    measured = f"{body}.interaction_force"
    interaction = without_mains(record, measured) if measured in record.signals else None
    names = {n: f"{body}.{n}" for n in FURTHER if f"{body}.{n}" in record.signals}
    return tuple(
        motion_of(
            body=body,
            file=record.file,
            time=record.time[rows],
            position=record.signals[f"{body}.position"][rows],
            command=command[rows],
            interaction=None if interaction is None else interaction[rows],
            sample_time=record.sample_time,
            rows=rows,
            bandwidth=bandwidth,
            resolution=resolution,
            further={n: record.signals[name][rows] for n, name in names.items()},
        )
        for rows in record.segments
        if (rows.stop - rows.start) * record.sample_time >= SHORTEST
    )
