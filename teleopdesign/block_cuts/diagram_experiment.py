"""An experiment of a whole diagram: its file, its signals by name, and the rows of its logs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ..base.errors import quote
from ..base.frozen import ByValue
from ..base.toml import Table
from ..base.units import unit_of
from ..diagrams import Attached, Diagram, Moving
from ..effects.of_blocks.controllers import ControlEffect
from ..measurement.channel import Channel
from ..measurement.description import BodyDescription
from ..measurement.filtering import Array
from ..measurement.tables import LogColumns
from .cuts import Cuts, cuts_of

#: decimals of a column; with more the rounding is none that counts
_MOST_DIGITS = 13
#: significant digits that a program writes at least ("%g" has 6): fewer are a signal of few values
_LEAST_SIGNIFICANT = 4


@dataclass(frozen=True)
class StatedComputer:
    """How the computer reads and acts, SI; what is not stated is that of the diagram's laws.

    sample_period: s; None: that of the rows;  velocity_bandwidth: Hz, inf: no low-pass
    one_pass: all columns of a row were written in one pass of the computer
    """

    sample_period: float | None = None
    velocity_bandwidth: float = float("inf")
    delay: float = 0.0
    encoder_step: float = 0.0
    one_pass: bool = False


@dataclass(frozen=True, eq=False)
class RecordedLog(ByValue):
    """The columns of one record as written;  offset_names: as of a `Record`."""

    file: str
    use: str
    offset_names: frozenset[str]
    columns: LogColumns

    @property
    def count(self) -> int:
        """Number of its rows."""
        return len(next(iter(self.columns.values.values())))


@dataclass(frozen=True, eq=False)
class DiagramExperiment(ByValue):
    """A diagram with values, and records of its signals.

    channels: signal -> its table in the file;  channel: signal -> the channel, SI
    zero: outside signals that are known to be zero
    read_by_computer: signals whose column holds the number that the computer read
    """

    folder: Path
    title: str
    diagram: Diagram
    channels: Mapping[str, Table]
    channel: Mapping[str, Channel]
    zero: tuple[str, ...]
    computer: StatedComputer
    bandwidth: float | None
    logs: tuple[RecordedLog, ...]
    sample_rate: float | None = None
    read_by_computer: frozenset[str] = field(default_factory=frozenset)

    @property
    def recorded(self) -> tuple[str, ...]:
        """Signals of the diagram that the records hold, in the order of the file."""
        return tuple(name for name in self.channels if name != "time")

    @property
    def cuts(self) -> Cuts:
        """What the recorded signals test."""
        return cuts_of(self.diagram, self.recorded, self.zero)

    @property
    def assumed(self) -> dict[str, Any]:
        """What was taken as given: outside signals at zero, and the period where none is stated."""
        assumed: dict[str, Any] = dict.fromkeys(self.zero, 0.0)
        if self.computer.sample_period is None and self.cuts.of("computer"):
            assumed["sample_period"] = "that of the rows"
        return assumed

    def axis(self, signal: str) -> str:
        """Axis of a signal, "prismatic" or "revolute": that of the body that it moves or holds."""
        return axis_of(self.diagram, signal)

    def unit(self, effect: ControlEffect, at: str) -> str:
        """Unit of the parameter of an effect at a block: a force is that of the block's output."""
        blocks = self.diagram.blocks
        outputs = [s for b in blocks if b.name == at for s in b.outputs]
        commands = [b.command for b in blocks if isinstance(b, Moving)]
        return unit_of(effect.declared.quantity, self.axis((outputs or commands)[0]))

    def signal(self, name: str, log: RecordedLog) -> Array:
        """A recorded signal as written, SI, (n,)."""
        return self.channel[name].signal(log.columns.values)

    def digit(self, name: str, log: RecordedLog) -> float:
        """Step of the last digit of a signal's column, SI, rms over its rows; 0: not rounded."""
        values = np.concatenate([log.columns.values[c] for c in self.channel[name].columns])
        values = values[np.isfinite(values)]
        scale = np.ptp(values) if len(values) else 0.0
        signal = self.signal(name, log)
        factor = (np.nanmax(signal) - np.nanmin(signal)) / scale if scale else 0.0
        return last_digit(values) * abs(float(factor))

    def seconds(self, log: RecordedLog) -> Array:
        """Time of the rows, s, (n,)."""
        if self.sample_rate is not None:
            return np.arange(log.count) / self.sample_rate
        return self.signal("time", log)

    def __repr__(self) -> str:
        lines = [f"Experiment {quote(self.title)} of the diagram {self.diagram.name}"]
        lines += [f"  {name}: {self.diagram.texts.get(name, name)}" for name in self.recorded]
        lines += [f"  {log.file} ({log.use}): {log.count} rows" for log in self.logs]
        return "\n".join([*lines, *(f"  {line}" for line in repr(self.cuts).splitlines())])


def last_digit(values: Array) -> float:
    """Step of the last digit of written numbers, rms over them; 0: as many as a number has.

    Numbers have fixed decimals ("%.4f"), fixed significant digits ("%.6g") or single precision: of
    these the coarsest that all numbers fit.
    """
    size = np.abs(values[values != 0.0])
    if not len(size):
        return 0.0
    decade = np.floor(np.log10(size))
    decimals = (np.full(len(size), 10.0**-digits) for digits in range(_MOST_DIGITS))
    significant = (10.0 ** (decade + 1 - n) for n in range(_LEAST_SIGNIFICANT, _MOST_DIGITS))
    single = [np.spacing(size.astype(np.float32)).astype(float)]
    steps = [0.0]
    for kind in (decimals, significant, single):
        fitting = (s for s in kind if _are_multiples(size / s))
        steps += [float(np.sqrt(np.mean(s**2))) for s in fitting][:1]
    return max(steps)


def _are_multiples(steps: Array) -> bool:
    """Whether all numbers are whole numbers of steps, and none of them is a small part of one."""
    whole = np.round(steps)
    return bool(whole.min() > 0.0 and np.abs(whole - steps).max() < 1e-3)


def axis_of(diagram: Diagram, signal: str) -> str:
    """Axis of a signal, "prismatic" or "revolute": that of the body that it moves or holds."""
    bodies = [b for b in diagram.blocks if isinstance(b, Moving | Attached)]
    near = [b for b in bodies if signal in (*b.inputs, *b.outputs)]
    return str(getattr((near or bodies)[0].body, "axis", "prismatic"))


def body_of_axis(axis: str) -> dict[str, BodyDescription]:
    """A body of this axis, by which the units of a signal are read."""
    return {"any": BodyDescription("any", axis, None, {}, "diagram")}
