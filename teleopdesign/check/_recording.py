"""What a check looks at, the one list of checks that need no fit, and who asks it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..base.errors import ExperimentError
from ..base.finding import Concern, Finding, Graph, Series
from ..base.folders import Shelf
from ..base.units import unit_of
from ..measurement.channel import BODY_QUANTITIES, Channel
from ..measurement.description import ONE_BODY
from ..measurement.encoder import reading_step
from ..measurement.experiment import Experiment, excerpt
from ..measurement.filtering import Array
from ..measurement.prepare import Prepared, prepare
from ..measurement.record import Record

if TYPE_CHECKING:
    from ..model import Model

#: most samples from which the smallest step of a channel is determined
ENOUGH = 200_000
CHECKS: Mapping[str, RecordingCheck] = Shelf(
    __package__,
    Path(__file__).parent,
    lambda module: module.CHECK,
    "check",
    defined_in=__name__,
)


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
    def quantity(self) -> str:
        """Of the channel: "position", "actuator_force" ..."""
        return self.channel.quantity

    @property
    def is_force(self) -> bool:
        """Whether it is one of the forces on the body."""
        return self.quantity in ("actuator_force", "interaction_force")

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

    def finding(
        self,
        topic: str,
        concern: Concern,
        words: str,
        numbers: Mapping[str, float],
        graph: Graph | None = None,
    ) -> Finding:
        """A finding about this channel;  words: of the sentence, after the channel's name."""
        return Finding(topic, concern, f"{self.name}{words}", numbers, self.record.file, graph)

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


@dataclass(frozen=True, eq=False)
class CheckedRecording:
    """An experiment as checks look at it.

    model: of the user, with the inertias that are known
    prepared: the motion at the bandwidth of the comparison, of windows where the records are long
    refused: why the records cannot be compared with a model, so that `prepared` is None
    seed: of the random numbers for a noise floor
    """

    experiment: Experiment
    model: Model | None = None
    prepared: Prepared | None = None
    refused: Finding | None = None
    seed: int = 0

    @property
    def compared(self) -> tuple[Model, Prepared]:
        """The model and the prepared records, where they can be compared."""
        assert self.model is not None and self.prepared is not None
        return self.model, self.prepared

    @cached_property
    def signals(self) -> tuple[Signal, ...]:
        """Every channel of every body in every record."""
        return tuple(
            self._signal(record, key, values)
            for record in self.experiment.records
            for key, values in record.signals.items()
            if key in self.experiment.channels  # of one joint of an arm, its own
        )

    @cached_property
    def varying(self) -> tuple[Signal, ...]:
        """The channels that change; without a velocity, which takes no part in a comparison."""
        return tuple(s for s in self.signals if np.ptp(s.values) > 0 and s.quantity != "velocity")

    def beside(self, signal: Signal) -> list[Signal]:
        """The other channels of the same record."""
        return [s for s in self.signals if s.record is signal.record and s is not signal]

    @property
    def is_of_an_arm(self) -> bool:
        """Whether the bodies are the joints of an arm, or the body is one of them."""
        arm = self.experiment.arm is not None
        return arm or (self.prepared is not None and self.prepared.is_linked)

    @property
    def lone_body(self) -> str | None:
        """The body, where there is one; None: bodies or links beside it do work on it as well."""
        bodies = tuple(self.experiment.bodies)
        return bodies[0] if len(bodies) == 1 and not self.is_of_an_arm else None

    def label(self, key: str) -> str:
        """A channel's name as the user writes it: without "device." where there is one body."""
        alone = tuple(self.experiment.bodies) == ONE_BODY
        return key.removeprefix("device.") if alone else key

    def _signal(self, record: Record, key: str, values: Array) -> Signal:
        channel = self.experiment.channels[key]
        assert channel.body is not None
        axis = self.experiment.axis(channel.body)
        middle = max(0, (len(values) - ENOUGH) // 2)
        step = reading_step(values[middle : middle + ENOUGH])
        unit = unit_of(BODY_QUANTITIES[channel.quantity], axis)
        return Signal(self.label(key), unit, channel, record, values, step, axis)


def look_at(
    experiment: Experiment, model: Model | None = None, *, seed: int = 0
) -> CheckedRecording:
    """The recording of an experiment, prepared for comparison where that can be.

    model: None: that of the experiment
    """
    # effects need sympy: a recording without a model is looked at faster
    from ..model import Model

    if experiment.is_curve:
        model = model or Model.from_experiment(experiment)
        return CheckedRecording(experiment, model, prepare(experiment), seed=seed)
    resting = [
        body
        for body in experiment.bodies
        if all(np.ptp(r.signals[f"{body}.position"]) == 0 for r in experiment.fit_records)
    ]
    try:
        model = model or Model.from_experiment(experiment)
        if resting:
            why = not_checked(f"{' and '.join(resting)} never moves", "note")
            return CheckedRecording(experiment, model, refused=why, seed=seed)
        return CheckedRecording(experiment, model, prepare(excerpt(experiment)), seed=seed)
    except ExperimentError as problem:
        return CheckedRecording(
            experiment, model, refused=not_checked(str(problem), "warning"), seed=seed
        )


def not_checked(why: str, concern: Concern) -> Finding:
    """A finding that nothing is said of what a recording can show."""
    sentence = f"not checked which effects the record can show: {why}."
    return Finding("what the record can show", concern, sentence)


@dataclass(frozen=True, eq=False)
class RecordingCheck:
    """One check of recordings; `find` says what it finds.

    order: its place in the list
    in_order: what is in order where it gives no warning, in words for a line about the channels
    may_stop: whether a finding of it may end a diagnosis (`Finding.stops`)
    kind: of the experiments that it looks at: "" for records over time, "friction curve"
    unless: topic -> what to do first: the check is not asked after a warning of that topic
    """

    order: int
    find: Callable[[CheckedRecording], Iterable[Finding]]
    in_order: str = ""
    may_stop: bool = False
    kind: str = ""
    unless: Mapping[str, str] = field(default_factory=dict)


def in_turn(checks: Mapping[str, RecordingCheck], kind: str = "") -> list[RecordingCheck]:
    """Checks of this kind of experiment, in the order in which they are asked."""
    return sorted((c for c in checks.values() if c.kind == kind), key=lambda check: check.order)


def findings_of(recording: CheckedRecording) -> list[Finding]:
    """What all checks of this folder find; also that the channels are in order, where they are."""
    checks = in_turn(CHECKS, recording.experiment.kind)
    by_check = [(check, list(check.find(recording))) for check in checks]
    findings = [f for _, some in by_check for f in some]
    of_channels = [(check, some) for check, some in by_check if check.in_order]
    if of_channels and not any(f.concern == "warning" for _, some in of_channels for f in some):
        names = ", ".join(dict.fromkeys(s.name for s in recording.signals))
        *first, last = (check.in_order for check, _ in of_channels)
        words = f"{', '.join(first)}; {last}"
        samples = float(sum(len(s.values) for s in recording.signals))
        findings.append(Finding("channels", "fine", f"{names}: {words}.", {"samples": samples}))
    return findings


def stopping_findings(recording: CheckedRecording) -> Iterator[Finding]:
    """Findings that end a diagnosis: these records tell no effect, whatever is fitted."""
    for check in in_turn(CHECKS, recording.experiment.kind):
        if check.may_stop:
            yield from (f for f in check.find(recording) if f.stops)


def why_silent(recording: CheckedRecording) -> str:
    """Why these records tell no effect, as the end of a verdict; "" where they may tell one."""
    sentence = next((f.sentence for f in stopping_findings(recording)), "")
    return f"{sentence[:1].upper()}{sentence[1:]}"
