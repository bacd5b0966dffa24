"""Moments of readings that jitter, and the part of a measured acceleration that they make.

A reading at another moment than its row says errs by the motion in between. Twice differentiated,
this error may be larger than the acceleration itself. A fit then finds an inertia near zero, and
what only weakens this error, such as a tip behind a spring, seems to explain a force.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..measurement.encoder import reading_step, sampling_jitter
from ..measurement.experiment import Experiment
from ..measurement.prepare import Stretch
from .criteria import CRITERIA


def jitter_of(stretch: Stretch, experiment: Experiment) -> float:
    """The rms error (s) of the moments of a stretch's readings, estimated from the readings."""
    motion = stretch.motion
    record = next(r for r in experiment.records if r.file == motion.file)
    longest = max(record.segments, key=lambda rows: rows.stop - rows.start)
    name = f"{motion.body}.position"
    readings = record.signals[name][longest]
    step = experiment.channels[name].resolution or reading_step(readings)
    return sampling_jitter(readings, step, record.sample_time)


def jitter_share(stretches: Sequence[Stretch], experiment: Experiment) -> float:
    """Part of the squares of the low-passed acceleration that jitter makes, 0 or more."""
    of_jitter = whole = 0.0
    for stretch in stretches:
        motion, rows = stretch.motion, len(stretch.keep)
        whole += float(np.sum(motion.lowpassed(motion.acceleration, stretch.keep) ** 2))
        if (jitter := jitter_of(stretch, experiment)) > 0.0:
            spectrum = motion.spectrum
            gain = spectrum.derivative(2) * motion.smoothing * spectrum.lowpass(motion.bandwidth)
            # white noise of the positions, as large as the motion within the jitter
            noise = jitter**2 * float(np.mean(motion.velocity[stretch.keep] ** 2))
            of_jitter += rows * noise * float(np.mean(np.abs(gain) ** 2))
    return of_jitter / whole if whole > 0.0 else 0.0


def is_much_jitter(stretches: Sequence[Stretch], experiment: Experiment) -> bool:
    """Whether jitter makes so much of the measured acceleration of a body that nothing is told."""
    by_body: dict[str, list[Stretch]] = {}
    for stretch in stretches:
        by_body.setdefault(stretch.motion.body, []).append(stretch)
    return any(jitter_share(part, experiment) > CRITERIA.jitter for part in by_body.values())


def describe_jitter() -> str:
    """The end of a verdict where jitter leaves nothing to tell."""
    return (
        "The readings were taken at other moments than their rows say, and more than a quarter of "
        "the measured acceleration comes from that: these records tell no effect at this "
        "bandwidth. Log the time of each reading, or compare at a lower bandwidth."
    )
