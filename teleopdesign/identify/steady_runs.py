"""Stretches of a record in which a body moves at constant speed.

A run is a stretch in which the smoothed velocity keeps its sign and stays within a tolerance,
without its two ends, where the speed still settles.

The standard error of the mean of samples that are not independent.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from ..base.frozen import ByValue
from ..measurement.experiment import Experiment
from ..measurement.filtering import Array
from ..measurement.motion import Motion, motions
from ..model import Model


def correlation_length(samples: Array) -> float:
    """Number of samples per independent one: 1 + 2 sum of autocorrelations, to the first < 0."""
    x = samples - samples.mean()
    size = 2 ** int(np.ceil(np.log2(2 * len(x))))
    spectrum = np.fft.rfft(x, size)
    sums = np.fft.irfft(spectrum * spectrum.conj(), size)[: len(x)]
    if sums[0] <= 0.0:
        return 1.0
    # biased sums: those of long lags fall to zero instead of running wild
    correlation = sums / sums[0]
    below = np.flatnonzero(correlation < 0.0)
    last = int(below[0]) if below.size else len(x)
    return float(1.0 + 2.0 * correlation[1:last].sum())


def mean_error(samples: Array) -> float:
    """Standard error of the mean of samples (n,), in their unit.

    Neighbouring samples may be correlated; then fewer samples count as independent.
    """
    independent = min(max(len(samples) / correlation_length(samples), 1.0), float(len(samples)))
    return float(np.std(samples) / np.sqrt(max(independent - 1.0, 1.0)))


#: Hz: bandwidth for the search for runs if the experiment states no bandwidth
BANDWIDTH = 20.0
#: encoder steps that a run must travel
STEPS = 20


@dataclass(frozen=True, eq=False)
class SteadyRun(ByValue):
    """One run at constant speed; SI.

    velocity: mean, signed;  start: s, in its record;  time, position, force: along the run, (n,)
    force: that moves the body: actuator and interaction force, less inertia times acceleration
    """

    file: str
    start: float
    velocity: float
    time: Array
    position: Array
    force: Array

    @property
    def direction(self) -> int:
        """Direction of the motion, +1 or -1."""
        return 1 if self.velocity > 0 else -1

    @property
    def duration(self) -> float:
        """Duration, s."""
        return float(self.time[-1] - self.time[0])


def steady_runs(
    experiment: Experiment,
    *,
    body: str = "device",
    tolerance: float = 0.05,
    shortest: float = 0.3,
    settling: float = 0.1,
) -> tuple[SteadyRun, ...]:
    """The runs at constant speed of one body, in all records, in order of time.

    tolerance: relative deviation of the speed from the middle of its range, in either direction
    shortest: of a run, s, without its ends;  settling: s left out at each end
    """
    inertia = Model.from_experiment(experiment).body(body).parameters["inertia"].value
    resolution = experiment.channels[f"{body}.position"].resolution
    runs: list[SteadyRun] = []
    for record in experiment.records:
        bandwidth = min(experiment.bandwidth or BANDWIDTH, 0.2 / record.sample_time)
        for motion in motions(record, body, bandwidth=bandwidth, resolution=resolution):
            rows = max(round(settling / motion.sample_time), 1)
            least = max(round(shortest / motion.sample_time), 10) + 2 * rows
            for first, last in _steady(motion.velocity, tolerance, least):
                run = _run(motion, slice(first + rows, last - rows), inertia)
                if np.ptp(run.position) >= STEPS * motion.step:
                    runs.append(run)
    return tuple(runs)


def _run(motion: Motion, rows: slice, inertia: float) -> SteadyRun:
    force = motion.at_rows(motion.command)[rows] + motion.interaction[rows]
    return SteadyRun(
        file=motion.file,
        start=float(motion.time[rows.start]),
        velocity=float(np.mean(motion.velocity[rows])),
        time=motion.time[rows],
        position=motion.position[rows],
        force=force - inertia * motion.acceleration[rows],
    )


def _steady(velocity: Array, tolerance: float, least: int) -> list[tuple[int, int]]:
    """Disjoint ranges of at least `least` rows with steady velocity; longer ranges go first.

    returns: (first, last + 1) in order of time
    """
    earliest = _earliest(velocity, tolerance)
    lengths = np.arange(len(velocity)) - earliest + 1
    free = np.ones(len(velocity), dtype=bool)
    kept: list[tuple[int, int]] = []
    for last in np.argsort(-lengths, kind="stable"):
        if lengths[last] < least:
            break
        first = int(earliest[last])
        if free[first] and free[last] and free[first : last + 1].all():
            kept.append((first, int(last) + 1))
            free[first : last + 1] = False
    return sorted(kept)


def _earliest(velocity: Array, tolerance: float) -> np.ndarray:
    """For each row, the earliest row from which velocity has stayed within the tolerance."""
    values = velocity.tolist()
    high: deque[int] = deque()
    low: deque[int] = deque()
    first, starts = 0, np.zeros(len(values), dtype=np.int64)
    for k, v in enumerate(values):
        while high and values[high[-1]] <= v:
            high.pop()
        while low and values[low[-1]] >= v:
            low.pop()
        high.append(k)
        low.append(k)
        while high and not _is_within(values[low[0]], values[high[0]], tolerance):
            first += 1
            if high[0] < first:
                high.popleft()
            if low[0] < first:
                low.popleft()
        starts[k] = first
    return starts


def _is_within(low: float, high: float, tolerance: float) -> bool:
    middle = (low + high) / 2
    return low * high > 0 and (high - low) / 2 <= tolerance * abs(middle)
