"""One recording: signals in SI units on a uniform time."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import final

import numpy as np
from numpy.typing import NDArray

from ..by_value import ByValue
from ..errors import ExperimentError
from .channel import Channel, factor_of
from .description import BodyDescription
from .tables import read_columns
from .time_grid import counted_time, segments_of, uniform_time

#: what a record may have of its own: "own" at these keys of [[records]]
OWN = ("position_zero", "bias", "friction_level")


@final
@dataclass(frozen=True, eq=False)
class Record(ByValue):
    """n samples; "fit": parameters are estimated on them, "check": never fitted.

    offset_names: of "position_zero", "bias" and "friction_level", those in which this record may
        differ from the others
    time: s, shape (n,), uniform within each segment with step `sample_time` (s)
    segments: stretches without interruption; hidden states start anew at each
    signals: "device.position", "master.actuator_force" ... -> shape (n,), SI, signs of the format
    """

    file: str
    use: str
    offset_names: frozenset[str]
    time: NDArray[np.float64]
    sample_time: float
    segments: tuple[slice, ...]
    signals: Mapping[str, NDArray[np.float64]]

    @property
    def duration(self) -> float:
        """Length of all segments together, s."""
        return len(self.time) * self.sample_time

    def __repr__(self) -> str:
        segments = f", {len(self.segments)} segments" if len(self.segments) > 1 else ""
        return (
            f"Record {self.file} ({self.use}): {len(self.time)} samples, {self.duration:.6g} s "
            f"at {1 / self.sample_time:.6g} Hz{segments}"
        )


def read_record(
    folder: Path,
    file: str,
    *,
    use: str,
    offset_names: frozenset[str],
    channels: Mapping[str, Channel],
    bodies: Mapping[str, BodyDescription],
    sample_rate: float | None,
) -> Record:
    """Read one record file of an experiment's folder.

    sample_rate: Hz; None: the channel "time" says
    raises ExperimentError: see `read_columns` and `uniform_time`
    """
    name = f"{folder.name}/{file}"
    columns = read_columns(
        folder / file,
        name,
        {channel.column: f"channels.{_short(key)}" for key, channel in channels.items()},
    )
    signals = {
        key: columns[channel.column] * factor_of(channel, bodies, f"channels.{key}.unit")
        for key, channel in channels.items()
        if channel.body is not None
    }
    count = len(next(iter(signals.values())))
    segments = segments_of(_labels(columns, channels, name), count)
    if sample_rate is not None:
        time, sample_time = counted_time(count, sample_rate, name)
    else:
        stamps = columns[channels["time"].column] * factor_of(
            channels["time"], bodies, "channels.time"
        )
        time, sample_time = uniform_time(
            stamps, segments, f"{name}: channels.time", labelled="segment" in channels
        )
    return Record(file, use, offset_names, time, sample_time, segments, signals)


def _short(key: str) -> str:
    """A channel's name as a user of one body writes it."""
    return key.removeprefix("device.")


def _labels(
    columns: Mapping[str, NDArray[np.float64]], channels: Mapping[str, Channel], name: str
) -> NDArray[np.float64] | None:
    if "segment" not in channels:
        return None
    labels = columns[channels["segment"].column]
    fractional = np.flatnonzero(labels != np.round(labels))
    if fractional.size:
        raise ExperimentError(
            f"{name}: channels.segment: row {fractional[0] + 1}: found {labels[fractional[0]]:g}, "
            "expected a whole number"
        )
    return labels
