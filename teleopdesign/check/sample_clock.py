"""Sample clock: a rate that no logger has, and jitter that no stamp shows.

Reading a record handles and reports what its stamps show: gaps, clocks that were set back, jitter.
A reading at another moment than its row says errs by the motion in between. Twice differentiated,
this error may be larger than the acceleration itself: a fit then finds an inertia near zero, and
what only weakens this error, such as a tip behind a spring, seems to explain a force.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ..base.finding import Finding
from ..base.sentences import percent
from ..measurement.encoder import reading_step, sampling_jitter
from ..measurement.experiment import Experiment
from ..measurement.prepare import Stretch
from ..measurement.record import Record
from ._recording import CheckedRecording, RecordingCheck, Signal

#: Hz: lowest plausible rate of a log, and highest: a scope may have 1 MHz
SLOWEST, FASTEST = 5.0, 1.001e6
#: part of a sample time that readings may be early or late and still count as in time
IN_TIME = 0.02
#: part of the squares of a measured acceleration from which jitter of the clock leaves nothing to
#: tell: an estimated inertia is smaller by this part. Of simulated devices jitter makes 0.01 to
#: 0.20 of them where it is a tenth of a row, 0.28 to 1.04 where it is half a row; 0.003 at most on
#: eight recordings of real machines. Higher: tips are named that weaken the jitter; lower: effects
#: are missed that its floor leaves visible
JITTER = 0.25


def find_clock_errors(recording: CheckedRecording) -> Iterator[Finding]:
    """Errors of the clock, or that it has none; stops where jitter leaves nothing to tell."""
    experiment = recording.experiment
    errors = [f for record in experiment.records for f in _check_rate(experiment, record)]
    for signal in recording.varying:
        if signal.quantity == "position":
            errors += _check_scatter(signal)
    yield from errors
    if not errors and not any(s.topic == "sample clock" for s in experiment.reading):
        yield _clock_in_order(experiment)
    # the accelerations of an arm come from all joints together
    if recording.prepared is not None and not recording.is_of_an_arm:
        yield from _check_jitter(recording.prepared.of("fit"), experiment)


CHECK = RecordingCheck(order=240, find=find_clock_errors, may_stop=True)


def _check_rate(experiment: Experiment, record: Record) -> Iterator[Finding]:
    """A rate that no logger has."""
    h, channel = record.sample_time, experiment.channels.get("time")
    if not SLOWEST <= 1 / h <= FASTEST:
        unit = "s" if channel is None else channel.unit
        smaller = {"s": "ms", "ms": "us", "us": "ns"}.get(unit, "ms")
        larger = {"ms": "s", "us": "ms", "ns": "us"}.get(unit, "s")
        meant = smaller if 1 / h < SLOWEST else larger
        sentence = (
            f"{1 / h:.4g} samples a second: the time is in {meant}, given as {unit}; write "
            f'unit = "{meant}" at channels.time.'
        )
        yield Finding("sample clock", "warning", sentence, {"rate": 1 / h}, record.file)


def jitter_of(experiment: Experiment, body: str, file: str) -> float:
    """The rms error (s) of the moments of the readings of a body's position in one record."""
    record, name = next(r for r in experiment.records if r.file == file), f"{body}.position"
    longest = record.longest
    readings = record.signals[name][longest]
    step = experiment.channels[name].resolution or reading_step(readings)
    return sampling_jitter(readings, step, record.sample_time)


def _check_scatter(signal: Signal) -> Iterator[Finding]:
    """A position that scatters with its speed, as if it were read early or late."""
    h, longest = signal.record.sample_time, signal.values[signal.record.longest]
    jitter = sampling_jitter(longest, signal.channel.resolution or signal.step, h)
    if jitter < IN_TIME * h:
        return
    off = jitter * float(np.sqrt(np.mean((np.diff(longest) / h) ** 2)))
    words = (
        " scatters the more the faster it moves, as if its samples were taken "
        f"{1e3 * jitter:.2g} ms rms early or late ({percent(jitter / h, '.2g')} of a sample), "
        f"{off:.2g} {signal.unit} at its usual speed: compare at low frequency."
    )
    numbers = {"jitter": jitter, "part": jitter / h, "position": off}
    yield signal.finding("sample clock", "warning", words, numbers)


def _check_jitter(stretches: Sequence[Stretch], experiment: Experiment) -> Iterator[Finding]:
    """Bodies of whose measured acceleration jitter makes so much that nothing is told."""
    for body in {s.motion.body: None for s in stretches}:
        share = jitter_share([s for s in stretches if s.motion.body == body], experiment)
        if share > JITTER:
            sentence = (
                "The readings were taken at other moments than their rows say, and more than a "
                "quarter of the measured acceleration comes from that: these records tell no "
                "effect at this bandwidth. Log the time of each reading, or compare at a lower "
                "bandwidth."
            )
            yield Finding("sample clock", "warning", sentence, {"share": share}, body, stops=True)


def jitter_share(stretches: Sequence[Stretch], experiment: Experiment) -> float:
    """Part of the squares of the low-passed acceleration of a body that jitter makes, 0 or more."""
    of_jitter = whole = 0.0
    for stretch in stretches:
        motion, rows = stretch.motion, stretch.keep
        whole += float(np.sum(motion.lowpassed(motion.acceleration, rows) ** 2))
        if (jitter := jitter_of(experiment, motion.body, motion.file)) > 0.0:
            spectrum = motion.spectrum
            gain = spectrum.derivative(2) * motion.smoothing * spectrum.lowpass(motion.bandwidth)
            # white noise of the positions, as large as the motion within the jitter
            noise = jitter**2 * float(np.mean(motion.velocity[rows] ** 2))
            of_jitter += len(rows) * noise * float(np.mean(np.abs(gain) ** 2))
    return of_jitter / whole if whole > 0.0 else 0.0


def _clock_in_order(experiment: Experiment) -> Finding:
    rates = sorted({1 / r.sample_time for r in experiment.records})
    rate = " and ".join(f"{r:.6g}" for r in rates)
    counted = "time" not in experiment.channels
    how = "samples are counted at the stated rate" if counted else "the time stamps are uniform"
    return Finding("sample clock", "fine", f"{how}, {rate} Hz.", {"rate": rates[0]})
