"""One channel of one record for the checks, and the ordinary scale of its values."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d
from scipy.special import ndtri

from ...base.finding import Graph, Series
from ...base.units import unit_of
from ..channel import BODY_QUANTITIES, Channel
from ..description import ONE_BODY
from ..encoder import reading_step
from ..experiment import Experiment
from ..filtering import Array
from ..record import Record

#: probability of a false warning about one channel of one record
FALSE_ALARM = 1e-3
#: most samples from which the smallest step of a channel is determined
ENOUGH = 200_000


@dataclass(frozen=True, eq=False)
class Signal:
    """One channel of one record.

    name: as the user writes it ("position", "slave.position");  unit: SI
    values: (n,);  step: smallest step between values, 0 where the channel is constant
    axis: of the body
    """

    name: str
    unit: str
    channel: Channel
    record: Record
    values: Array
    step: float
    axis: str = "prismatic"

    @property
    def rounded_to(self) -> float:
        """Rounding of the values, SI: the stated resolution, or the step if that is larger.

        A log that was averaged or resampled holds values between the steps of its encoder.
        """
        return max(self.step, self.channel.resolution or 0.0)

    @property
    def stretches(self) -> Iterator[tuple[int, Array]]:
        """(first row, samples) of each uninterrupted stretch."""
        for rows in self.record.segments:
            yield rows.start, self.values[rows]

    def time(self, row: int) -> float:
        """Time of a row (counted from 0), s."""
        return float(self.record.time[row])

    def around(self, row: int, odd: NDArray[np.intp], *, name: str, span: int = 100) -> Graph:
        """A graph of the samples near a row, with the rows `odd` marked.

        odd: row numbers;  name: of the marked samples in the graph;  span: samples to either side
        """
        first, last = max(0, row - span), min(len(self.values), row + span)
        near = odd[(odd >= first) & (odd < last)]
        time = self.record.time
        return Graph(
            "time (s)",
            f"{self.name} ({self.unit})",
            (
                Series("recorded", time[first:last], self.values[first:last]),
                Series(name, time[near], self.values[near], "rest"),
            ),
        )


def channel_label(experiment: Experiment, key: str) -> str:
    """A channel's name as the user writes it: without "device." where there is one body."""
    return key.removeprefix("device.") if tuple(experiment.bodies) == ONE_BODY else key


def signals(experiment: Experiment) -> list[Signal]:
    """Every channel of every body in every record."""
    rows = []
    for record in experiment.records:
        for key, values in record.signals.items():
            channel = experiment.channels[key]
            assert channel.body is not None
            unit = unit_of(BODY_QUANTITIES[channel.quantity], experiment.axis(channel.body))
            middle = max(0, (len(values) - ENOUGH) // 2)
            step = reading_step(values[middle : middle + ENOUGH])
            rows.append(
                Signal(
                    channel_label(experiment, key),
                    unit,
                    channel,
                    record,
                    values,
                    step,
                    experiment.axis(channel.body),
                )
            )
    return rows


def local_scale(e: Array, floor: float) -> Array:
    """Standard deviation expected of each of n values, from the values nearby; shape (n,).

    The larger of two estimates, from the middle and from the tail of the nearby values, so that a
    signal with heavy tails is judged by its tails. A few outliers do not count.

    floor: least value
    """
    scale = np.full(len(e), max(floor, 1e-300))
    for size, part in ((256, 0.5), (1024, 0.99)):
        size = min(size, len(e))
        count = len(e) // size
        blocks = np.abs(e[: count * size]).reshape(count, size)
        each = np.quantile(blocks, part, axis=1) / ndtri(0.5 + 0.5 * part)
        each = maximum_filter1d(each, 3, mode="nearest")
        rest = np.full(len(e) % size, each[-1])
        scale = np.maximum(scale, np.concatenate([np.repeat(each, size), rest]))
    return scale


def largest_by_chance(count: int) -> float:
    """Largest of `count` normal values by chance, in standard deviations, at `FALSE_ALARM`."""
    return float(-ndtri(0.5 * FALSE_ALARM / max(count, 1)))
