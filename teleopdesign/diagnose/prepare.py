"""An experiment made ready for comparison: smoothed, differentiated, cut, at one bandwidth."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..by_value import ByValue
from ..errors import ExperimentError
from ..measurement.experiment import Experiment
from ..measurement.filtering import Array
from ..measurement.motion import Motion, motions
from .bandwidth import default_bandwidth
from .shared_links import Shared, share_again

#: seconds at each end of a stretch where the low-pass has not settled
TRIM = 0.25
#: samples kept per second and hertz of bandwidth after the low-pass (2 would be Nyquist's)
OVERSAMPLING = 5.0
#: blocks of the fit records that are held out in turn where there is no check record
FOLDS = 4


@dataclass(frozen=True, eq=False)
class Stretch(ByValue):
    """One body along one segment with its use, and the rows that count.

    keep: the rows that count, thinned to what the low-pass leaves
    weight: rows that each of them stands for
    measured: sum of squares of the low-passed measured force over the rows that count
    offset_names: in which the record may differ from the others
    shared: of an arm's joint, what takes the freedom of the links out of residuals; None: nothing
    """

    motion: Motion
    use: str
    keep: NDArray[np.intp]
    weight: float
    measured: float
    offset_names: frozenset[str] = frozenset()
    shared: Shared | None = None

    @property
    def has_zero_offset(self) -> bool:
        """Whether the encoder's zero of this record differs from that of other records."""
        return "position_zero" in self.offset_names


@dataclass(frozen=True, eq=False)
class Prepared(ByValue):
    """An experiment made ready for comparison at one bandwidth (Hz)."""

    experiment: Experiment
    bandwidth: float
    stretches: tuple[Stretch, ...]

    def of(self, use: str) -> tuple[Stretch, ...]:
        """The stretches of one use."""
        return tuple(s for s in self.stretches if s.use == use)


def prepare(experiment: Experiment, *, bandwidth: float | None = None) -> Prepared:
    """Smooth, differentiate and cut the records of an experiment for comparison.

    bandwidth: Hz; default: the experiment's, or chosen from the record
    raises ExperimentError: bandwidth too high for the sample rate, or no stretch long enough
    """
    if experiment.arm is not None:
        raise ExperimentError(
            f"{experiment.folder.name}/experiment.toml: model.arm: found an arm, expected one body "
            "or two: only `teleopdesign diagnose` (find_missing_in_arm) compares an arm"
        )
    chosen = bandwidth or experiment.bandwidth or default_bandwidth(experiment)
    stretches = []
    for record in experiment.records:
        if chosen > 0.4 / record.sample_time:
            raise ExperimentError(
                f"{experiment.folder.name}/experiment.toml: comparison.bandwidth: {chosen:g} Hz is "
                f"too high for {record.file} at {1 / record.sample_time:g} Hz, expected below "
                f"{0.4 / record.sample_time:g} Hz"
            )
        for body in experiment.bodies:
            channel = experiment.channels[f"{body}.position"]
            for motion in motions(record, body, bandwidth=chosen, resolution=channel.resolution):
                stretches.append(stretch_of(motion, record.use, chosen, record.offset_names))
    if not any(s.use == "fit" for s in stretches):
        raise ExperimentError(f"{experiment.folder.name}: fit records: no stretch of 0.6 s or more")
    return Prepared(experiment, chosen, tuple(stretches))


def stretch_of(motion: Motion, use: str, bandwidth: float, offset_names: frozenset[str]) -> Stretch:
    """A motion with the rows of it that count at this bandwidth (Hz).

    offset_names: in which its record may differ from the others
    """
    n, rate = len(motion.time), 1.0 / motion.sample_time
    trim = min(int(TRIM * rate), n // 3)
    stride = max(1, int(rate / (OVERSAMPLING * bandwidth)))
    keep = np.arange(trim, n - trim, stride)
    return Stretch(
        motion, use, keep, float(stride), _squares(motion, keep, float(stride)), offset_names
    )


def folds(
    stretches: Sequence[Stretch],
) -> list[tuple[tuple[Stretch, ...], tuple[Stretch, ...]]]:
    """The stretches with `FOLDS` blocks of each held out in turn: (seen, held out)."""
    pairs = []
    for i in range(FOLDS):
        kept, held_out = [], []
        for s in stretches:
            part = np.arange(len(s.keep)) * FOLDS // len(s.keep) == i
            kept.append(replace(_cut(s, s.keep[~part]), shared=s.shared))
            held_out.append(_cut(s, s.keep[part]))
        pairs.append((share_again(kept), tuple(held_out)))
    return pairs


def _cut(stretch: Stretch, keep: NDArray[np.intp]) -> Stretch:
    measured = _squares(stretch.motion, keep, stretch.weight)
    return replace(stretch, keep=keep, measured=measured, shared=None)


def measured_force(stretch: Stretch) -> Array:
    """The low-passed measured force on the rows that count."""
    motion = stretch.motion
    return motion.lowpassed(motion.at_rows(motion.command) + motion.interaction)[stretch.keep]


def _squares(motion: Motion, keep: NDArray[np.intp], weight: float) -> float:
    measured = motion.lowpassed(motion.at_rows(motion.command) + motion.interaction)
    return weight * float(np.sum(measured[keep] ** 2))
