"""An experiment prepared for comparison: smoothed, differentiated and cut, at one bandwidth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ExperimentError
from ..base.frozen import ByValue
from .bandwidth import HIGHEST, LARGEST, bandwidth_of, scales
from .experiment import Experiment
from .filtering import Array, spectrum
from .friction_curve import CHANNELS, FOLDS, points_as_motion
from .motion import SHORTEST, SMOOTHING, Motion, motions
from .record import Record
from .shared_links import Shared

#: seconds at each end of a stretch where the low-pass is not yet in steady state
TRIM = 0.25
#: samples kept per second and hertz of bandwidth after the low-pass (2 would be Nyquist's)
OVERSAMPLING = 5.0
#: samples per second and hertz of bandwidth, at least, for the search for effects. The motion is
#: smooth to 1.5 times the bandwidth, so only the place of a reversal between two samples is lost:
#: on simulated records 0.2 to 0.8 % more of the force was left than with all samples. With fewer
#: samples the search is faster, but this loss may hide small effects
SOUGHT = 6.0
#: edge of the low-pass of the command before samples are thinned out, over the bandwidth: above the
#: edge of the smoothing (`SMOOTHING`), and below half of `SOUGHT`
PASSED = 2.0
#: fewest remaining samples of a stretch that is thinned out
FEWEST = 16


@dataclass(frozen=True, eq=False)
class Stretch(ByValue):
    """One body along one segment of a record, with the rows that count.

    use: "fit" or "check"
    keep: the rows that count, thinned to the samples that the low-pass requires
    weight: number of rows that each of them represents
    measured: sum of squares of the low-passed measured force over the rows that count
    offset_names: quantities in which the record may have an offset against the others
    shared: for an arm's joint: removes the estimated link parameters from residuals; else None
    force_is_sensed: whether the actuator force was measured, not commanded
    below: whether command and interaction force stand below the line of the error
    one_pass: whether command and position have one clock
    """

    motion: Motion
    use: str
    keep: NDArray[np.intp]
    weight: float
    measured: float
    offset_names: frozenset[str] = frozenset()
    shared: Shared | None = None
    force_is_sensed: bool = False
    below: tuple[bool, bool] = (True, True)
    one_pass: bool = False

    @property
    def counted_time(self) -> float:
        """Seconds of the record that the rows which count stand for."""
        return len(self.keep) * self.weight * self.motion.sample_time

    @property
    def row(self) -> float:
        """Seconds between rows of the record."""
        return self.motion.sample_time / self.motion.merged

    @property
    def has_zero_offset(self) -> bool:
        """Whether the encoder's zero of this record differs from that of other records."""
        return "position_zero" in self.offset_names


@dataclass(frozen=True, eq=False)
class Prepared(ByValue):
    """An experiment prepared for comparison at one bandwidth (Hz).

    late_beside: s by which the logs of the arm's other joints are late; None: not known
    """

    experiment: Experiment
    bandwidth: float
    stretches: tuple[Stretch, ...]
    late_beside: float | None = None

    def of(self, use: str) -> tuple[Stretch, ...]:
        """The stretches of one use."""
        return tuple(s for s in self.stretches if s.use == use)

    @property
    def is_curve(self) -> bool:
        """Whether the records are points of a friction curve, without time."""
        return self.bandwidth == np.inf

    @property
    def is_linked(self) -> bool:
        """Whether the records are of an arm's joint, whose link parameters are estimated too.

        Effects at such a joint are tested where all joints are estimated together, by the error of
        the whole arm and by the noise that they weaken (`held_against_others.py`).
        """
        return any(s.motion.links is not None or s.shared is not None for s in self.stretches)

    @cached_property
    def scales(self) -> dict[str, float]:
        """Quantity -> its typical size along the fit records (SI)."""
        return scales([s.motion for s in self.of("fit")], self.bandwidth)

    @cached_property
    def coarse(self) -> Prepared:
        """The fit records with few samples, for the search; unchanged where none can be dropped.

        The effects are then estimated and judged on all samples of the records.
        """
        stretches = self.of("fit")
        if self.is_linked:
            return self
        thin = tuple(_thin(s) for s in stretches)
        if all(one is other for one, other in zip(thin, stretches, strict=True)):
            return self
        return Prepared(self.experiment, self.bandwidth, thin)


def prepare(experiment: Experiment, *, bandwidth: float | None = None) -> Prepared:
    """Smooth, differentiate and cut the records of an experiment for comparison.

    bandwidth: Hz; None: the experiment's, or chosen from the records
    raises ExperimentError: an arm, a bandwidth too high for the sample rate, or no fit stretch that
        is long enough
    """
    if experiment.arm is not None:
        raise ExperimentError(
            f"{experiment.folder.name}/experiment.toml: model.arm: found an arm, expected one body "
            "or two: only `teleopdesign diagnose` (find_missing) compares an arm"
        )
    if experiment.is_curve:
        return prepare_curve(experiment)
    chosen = bandwidth or bandwidth_of(experiment)
    stretches = []
    for record in experiment.records:
        _refuse_huge(experiment, record)
        if chosen > (highest := HIGHEST / record.sample_time):
            raise ExperimentError(
                f"{experiment.folder.name}/experiment.toml: comparison.bandwidth: {chosen:g} Hz is "
                f"too high for {record.file} at {1 / record.sample_time:g} Hz, expected below "
                f"{highest:g} Hz"
            )
        for body in experiment.bodies:
            channel = experiment.channels[f"{body}.position"]
            force = experiment.channels[f"{body}.actuator_force"]
            other = experiment.channels.get(f"{body}.interaction_force")
            below = not force.beside, other is None or not other.beside
            for motion in motions(record, body, bandwidth=chosen, resolution=channel.resolution):
                stretch = stretch_of(motion, record.use, chosen, record.offset_names)
                stretch = replace(
                    stretch, force_is_sensed=force.measured, one_pass=force.one_pass, below=below
                )
                stretches.append(_with_squares(stretch))
    if not any(s.use == "fit" for s in stretches):
        why = _why_too_short([r for r in experiment.records if r.use == "fit"])
        raise ExperimentError(
            f"{experiment.folder.name}: fit records: no stretch of {SHORTEST:g} s or more{why}"
        )
    if all(s.use == "fit" for s in stretches):  # each then has blocks that are held out in turn
        stretches = [s for s in stretches if len(s.keep) >= FOLDS]
        if not stretches:
            raise ExperimentError(
                f"{experiment.folder.name}: fit records: fewer than {FOLDS} samples count at a "
                f"bandwidth of {chosen:.3g} Hz: use longer records, or a larger bandwidth"
            )
    _refuse_without_force(experiment, stretches)
    return Prepared(experiment, chosen, tuple(stretches))


def prepare_curve(experiment: Experiment) -> Prepared:
    """The points of a friction curve; its bandwidth is inf, for nothing is filtered.

    raises ExperimentError: a record has fewer points than blocks that are held out
    """
    (body,) = experiment.bodies
    stretches = []
    for record in experiment.records:
        _refuse_huge(experiment, record)
        velocity, force = (record.signals[f"{body}.{name}"] for name in CHANNELS)
        motion = points_as_motion(body, record.file, velocity, force)
        if len(motion.time) < FOLDS:
            raise ExperimentError(
                f"{experiment.folder.name}/{record.file}: found {len(motion.time)} points with a "
                f"speed, expected {FOLDS} or more"
            )
        keep = np.arange(len(motion.time))
        stretches.append(_with_squares(Stretch(motion, record.use, keep, 1.0, 0.0)))
    _refuse_without_force(experiment, stretches)
    return Prepared(experiment, np.inf, tuple(stretches))


def _why_too_short(records: Sequence[Record]) -> str:
    """The cause where no segment of records counts, for a message; "": the records are short."""
    lengths = [(s.stop - s.start) * r.sample_time for r in records for s in r.segments]
    if len(lengths) == len(records):
        return ""
    return (
        f": pauses and new trials cut them into {len(lengths)} segments, of which the longest "
        f"lasts {max(lengths):.2g} s"
    )


def _refuse_huge(experiment: Experiment, record: Record) -> None:
    """Squares and cubes of signals must be numbers: raises ExperimentError where they are not."""
    for name, signal in record.signals.items():
        largest = float(np.max(np.abs(signal), initial=0.0, where=np.isfinite(signal)))
        if largest > LARGEST:
            raise ExperimentError(
                f"{experiment.folder.name}/{record.file}: channels.{name}: found {largest:.3g} "
                f"(SI), expected at most {LARGEST:g}"
            )


def _refuse_without_force(experiment: Experiment, stretches: Sequence[Stretch]) -> None:
    """The force error is relative to the measured force: raises ExperimentError where that is 0."""
    for use in ("fit", "check"):
        there = [s for s in stretches if s.use == use]
        if there and not sum(s.measured for s in there) > 0.0:
            raise ExperimentError(
                f"{experiment.folder.name}: {use} records: the measured force, of actuator and "
                "interaction together, is 0, expected a force"
            )


def stretch_of(motion: Motion, use: str, bandwidth: float, offset_names: frozenset[str]) -> Stretch:
    """A motion with those of its rows that count at this bandwidth (Hz).

    offset_names: quantities in which its record may have an offset against the others
    """
    n, rate = len(motion.time), 1.0 / motion.sample_time
    trim = min(int(TRIM * rate), n // 3)
    stride = max(1, int(rate / (OVERSAMPLING * bandwidth)))
    keep = np.arange(trim, n - trim, stride)
    return _with_squares(Stretch(motion, use, keep, float(stride), 0.0, offset_names))


def _thin(stretch: Stretch) -> Stretch:
    """The stretch with `SOUGHT` samples per second and hertz; unchanged where it has fewer."""
    motion, keep = stretch.motion, stretch.keep
    every = int(1.0 / (SOUGHT * motion.bandwidth * motion.sample_time))
    if every < 2:
        return stretch
    kept = np.arange(-(-keep[0] // every), keep[-1] // every + 1)
    if len(kept) < FEWEST:
        return stretch
    rows = len(keep) * stretch.weight
    thin = replace(stretch, motion=_thin_motion(motion, every), keep=kept, weight=rows / len(kept))
    return _with_squares(thin)


def _thin_motion(motion: Motion, count: int) -> Motion:
    """A motion at every `count`-th sample; its held command is the same at those samples."""
    at = slice(None, None, count)
    fine = motion.spectrum
    coarse = spectrum(len(motion.time[at]), count * motion.sample_time)
    # removed before the decimation: else these frequencies would alias
    gain = fine.hold() * fine.lowpass(PASSED * motion.bandwidth, order=16)
    force = fine.multiply(motion.command, gain)[at]
    below = coarse.frequency <= PASSED * motion.bandwidth
    unheld = np.where(below, 1.0 / np.where(below, coarse.hold(), 1.0), 0.0)
    edge = min(SMOOTHING * motion.bandwidth, 0.45 / coarse.sample_time)
    # copied: kernels of hidden states are compiled, and loaded, for signals without gaps in memory
    signals = ("time", "position", "velocity", "acceleration", "interaction", "direction")
    return replace(
        motion,
        **{name: getattr(motion, name)[at].copy() for name in signals},
        command=coarse.multiply(force, unheld),
        spectrum=coarse,
        smoothing=coarse.lowpass(edge, order=8),
        merged=count,
        further={name: signal[at].copy() for name, signal in motion.further.items()},
    )


def measured_force(stretch: Stretch) -> Array:
    """The low-passed measured force on the rows that count."""
    motion = stretch.motion
    forces = (motion.at_rows(motion.command), motion.interaction)
    whole = np.sum([f for f, counts in zip(forces, stretch.below, strict=True) if counts], axis=0)
    return motion.lowpassed(whole)[stretch.keep]


def _with_squares(stretch: Stretch) -> Stretch:
    """The stretch with the squares of its measured force."""
    return replace(stretch, measured=stretch.weight * float(np.sum(measured_force(stretch) ** 2)))
