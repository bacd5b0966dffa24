"""A recording with a compensation on: the command that the computer makes, the force that is left.

Both along the recorded motion. The computer's laws run on the recorded readings, as in its own
cut. The body's force is the residual of a diagnosis: while the body rests, friction balances the
hand, and these moments test nothing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ..block_cuts.computer import ComputerPart, Passes
from ..block_cuts.cuts import COMPUTER, Cut
from ..block_cuts.diagram_experiment import StatedComputer
from ..blocks import Body
from ..controllers import Controller, controller
from ..diagrams import Diagram, Moving
from ..effects import Parameter
from ..measurement.experiment import Experiment
from ..measurement.filtering import Array
from ..measurement.motion import Motion
from ..measurement.prepare import Prepared, Stretch, prepare
from ..realise.along_motion import residual_along
from ..simulate import Sampling

#: a number of the design: its block, or `COMPUTER`, and its name there
Key = tuple[str, str]
DELAY, FILTER = (COMPUTER, "delay"), (COMPUTER, "velocity_bandwidth")
#: name of a factor of all that a controller commands
GAIN = "gain"
#: scale of the sensor of the hand's force
SENSOR = ("force sensor", "scale")


#: quantities of parameters that give a law its shape; all others are strengths
SHAPE = ("angle", "position", "velocity", "time")


def force_like(parameter: Parameter) -> bool:
    """Whether the output of a law grows with the parameter as with its force."""
    return parameter.quantity not in (*SHAPE, "dimensionless")


@dataclass(frozen=True)
class SecondRecording:
    """The stretches of one body, with the diagram whose computer was on.

    rows: of each stretch, what the computer read;  prepared: of the recording
    """

    diagram: Diagram
    sampling: Sampling
    stretches: tuple[Stretch, ...]
    rows: tuple[Passes, ...]
    prepared: Prepared

    @classmethod
    def of(
        cls, diagram: Diagram, sampling: Sampling, experiment: Experiment, place: str
    ) -> SecondRecording:
        """Of the body at `place`.

        raises ExperimentError: no stretch is long enough
        """
        prepared = prepare(experiment)
        stretches = tuple(s for s in prepared.stretches if s.motion.body == place)
        rows = tuple(_rows(diagram, experiment, place, s.motion) for s in stretches)
        return cls(diagram, sampling, stretches, rows, prepared)

    @property
    def mover(self) -> Moving:
        """The block of the body."""
        (block,) = self.diagram.moving
        return block

    @property
    def body(self) -> Body:
        """The body as designed for."""
        assert isinstance(self.mover.body, Body)
        return self.mover.body

    @property
    def has_command(self) -> bool:
        """Whether the command with C was recorded: a column that is constant is none."""
        return any(np.ptp(s.motion.command) > 0 for s in self.stretches)

    def commands(self, changes: Mapping[Key, float] | None = None) -> list[Array]:
        """What the computer commands in each stretch as designed, but for the changes, (n,)."""
        changes = changes or {}
        computer = StatedComputer(
            velocity_bandwidth=changes.get(FILTER, self.sampling.velocity_bandwidth),
            delay=max(changes.get(DELAY, self.sampling.delay), 0.0),
        )
        diagram, mover = self.diagram, self.mover
        for block in diagram.controls:
            new = {n: v for (at, n), v in changes.items() if at == block.name}
            if new:
                assert isinstance(block.controller, Controller)
                diagram = diagram.with_block(block.name, _with_changes(block.controller, new))
        known = (mover.motion, *mover.loads)
        cut = Cut(mover.command, mover.command, "computer", (COMPUTER,), known)
        outside = tuple(s for s in diagram.outside if s not in known)
        part = ComputerPart(diagram, (cut,), outside, computer)
        return [part.predict(rows)[mover.command] for rows in self.rows]

    def changed_body(self, changes: Mapping[Key, float]) -> Body:
        """The body as designed for, but for the changes."""
        here = self.mover.name
        return self.body.with_values(
            {n: v for (at, n), v in changes.items() if at == here and n in self.body.parameters}
        )

    @property
    def travel(self) -> float:
        """Range of the position, m or rad."""
        return float(max(np.ptp(s.motion.position) for s in self.stretches))

    def along(self, name: str) -> Array:
        """ "time" or another signal of the motions, on the samples that count."""
        return np.concatenate([getattr(s.motion, name)[s.keep] for s in self.stretches])

    def low(self, number: int, samples: Array) -> Array:
        """A signal (n,) of one stretch, low-passed, on the samples that count."""
        stretch = self.stretches[number]
        return stretch.motion.lowpassed(samples)[stretch.keep]

    def left_by(
        self,
        commands: list[Array],
        body: Body | None = None,
        *,
        late: float = 0.0,
        scale: float = 1.0,
    ) -> list[Array]:
        """Force that body and command leave unexplained, low-passed, on the samples that count.

        late: s from the rows of the commands to the force;  scale: of the sensor of the hand
        """
        made = []
        for i, command in enumerate(commands):
            motion = self.stretches[i].motion
            hand = motion.interaction / scale
            motion = replace(motion, command=command, command_late=-late, interaction=hand)
            made.append(self.low(i, residual_along(body or self.body, motion).residual.value))
        return made

    def hand(self) -> list[Array]:
        """The recorded force of the hand, low-passed, on the samples that count."""
        return [self.low(i, s.motion.interaction) for i, s in enumerate(self.stretches)]


def _with_changes(changed: Controller, new: Mapping[str, float]) -> Controller:
    """The controller with other numbers, and all that it commands times a gain."""
    values = {n: v for n, v in new.items() if n != GAIN}
    changed = changed.with_values(changed.names() | values)
    return changed.then(controller("gain", {"gain": new[GAIN]})) if GAIN in new else changed


def _rows(diagram: Diagram, experiment: Experiment, place: str, motion: Motion) -> Passes:
    """What the computer read in a stretch; forces have the signs of the diagram."""
    (block,) = diagram.moving
    record = next(
        r
        for r in experiment.records
        if r.file == motion.file and np.array_equal(r.time[motion.rows], motion.time)
    )
    read = {block.motion: record.signals[f"{place}.position"][motion.rows]}
    for signal, weight in block.loads.items():
        hand = record.signals[f"{place}.interaction_force"][motion.rows]
        read[signal] = float(weight) * hand
    start = f"{motion.file} from {motion.time[0]:g} s"
    return Passes(start, "fit", motion.sample_time, read)
