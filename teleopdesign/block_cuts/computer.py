"""The computer along recorded readings: its signals at each row, with effects placed in it.

A row: inputs are those read at its time, outputs are computed from them. The velocity is the
difference of two readings over the period, unless the experiment says otherwise.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ..base.errors import ModelError
from ..controllers import Controller
from ..diagrams import Control, Diagram, Junction, Moving
from ..effects.of_blocks.controllers import CONTROL_EFFECTS, ORDER, ControlEffect
from ..measurement.filtering import Array
from ..measurement.prepare import TRIM
from ..realise.controller_along import controller_along
from ..realise.kernel import velocity_smoothing
from .cuts import COMPUTER, Cut
from .diagram_experiment import DiagramExperiment, RecordedLog, StatedComputer

#: part of a period by which stamps of rows may differ from it: the last digit of a stamp
_EVEN = 0.02


@dataclass(frozen=True)
class Placed:
    """An effect at a controller block, or at `COMPUTER`, with its value (SI)."""

    effect: ControlEffect
    at: str
    value: float

    @property
    def key(self) -> tuple[str, str]:
        return self.effect.name, self.at


def free_parameters(diagram: Diagram, blocks: Sequence[str]) -> tuple[Placed, ...]:
    """Parameters of controllers that are not fixed, at their stated values."""
    made = []
    for block in (diagram.block(name) for name in blocks if diagram.has(name)):
        for stage in block.stages if isinstance(block, Control) else ():
            for name in stage.free:
                full, value = f"{stage.name}.{name}", float(stage.values[name])
                free = ControlEffect(
                    act=lambda samples, *_: samples,
                    parameter=full,
                    declared=stage.law.parameters[name],
                    starts=lambda *_: np.array([]),
                    of_law=True,
                    name=full,
                )
                made.append(Placed(free, block.name, value))
    return tuple(made)


class UnevenRows(ModelError):
    """The rows of a log are not those of the computer's passes."""


@dataclass(frozen=True)
class Passes:
    """Recorded signals at the passes of the computer, SI, each (n,).

    lost: passes without a row, filled by straight lines
    """

    file: str
    use: str
    period: float
    signals: Mapping[str, Array]
    lost: Sequence[int] = ()


def passes_of(experiment: DiagramExperiment, log: RecordedLog) -> Passes:
    """The rows of a log at which the computer passed; less than `TRIM` of lost rows is filled.

    raises UnevenRows: rows are further apart than the period, missing, or without a number
    """
    time = experiment.seconds(log)
    gap = float(np.median(np.diff(time)))
    period = experiment.computer.sample_period or gap
    every = round(period / gap)
    if every < 1 or abs(every * gap - period) > _EVEN * period:
        raise UnevenRows(
            f"{log.file}: rows are {gap * 1e3:g} ms apart, the computer passes each "
            f"{period * 1e3:g} ms: log every pass"
        )
    steps = np.round(np.diff(time) / gap)
    for row in np.flatnonzero((steps < 1) | (steps * gap > TRIM))[:1]:
        what = "written twice" if steps[row] < 1 else "missing"
        raise UnevenRows(f"{log.file}: a row is {what} at {time[row]:g} s: log every pass once")
    pass_of_row = np.concatenate([[0], np.cumsum(steps)]).astype(int)
    passes = np.arange(0, pass_of_row[-1] + 1, every)
    kept, signals = np.isin(pass_of_row, passes), {}
    for name in experiment.recorded:
        values = experiment.signal(name, log)[kept]
        if not np.isfinite(values).all():
            raise UnevenRows(f"{log.file}: {name} has cells without a number")
        signals[name] = np.interp(passes, pass_of_row[kept], values)
    lost = tuple(np.flatnonzero(~np.isin(passes, pass_of_row)).tolist())
    return Passes(log.file, log.use, period, signals, lost)


def whole_passes_of(experiment: DiagramExperiment, log: RecordedLog) -> Passes:
    """The rows of a log at which the computer passed, of which none is lost.

    raises UnevenRows: as `passes_of`, or a row is lost
    """
    rows = passes_of(experiment, log)
    if rows.lost:
        at = rows.lost[0] * rows.period
        raise UnevenRows(f"{log.file}: a row is missing at {at:g} s: log every pass once")
    return rows


@dataclass(frozen=True)
class ComputerPart:
    """The controllers of a diagram along recorded rows.

    cuts: at signals that the computer makes;  zero: outside signals at zero
    kept: outputs of laws that no effect changes, by file and block
    """

    diagram: Diagram
    cuts: tuple[Cut, ...]
    zero: tuple[str, ...]
    computer: StatedComputer
    kept: dict[tuple[str, str], Array] = field(default_factory=dict)

    @property
    def places(self) -> tuple[str, ...]:
        """Blocks at which an effect may act, `COMPUTER` last."""
        names = dict.fromkeys(name for cut in self.cuts for name in cut.blocks)
        return tuple(sorted(names, key=lambda name: name == COMPUTER))

    def uses_velocity(self, at: str) -> bool:
        """Whether the law of a block uses the velocity that a filter would make late."""
        if at == COMPUTER:
            return False
        block = self.diagram.block(at)
        assert isinstance(block, Control) and isinstance(block.controller, Controller)
        names = [x.name for x in _symbols(block.controller)]
        return bool(block.motion) and ("velocity" in names or "speed" in names)

    def predict(self, rows: Passes, placed: Sequence[Placed] = ()) -> dict[str, Array]:
        """Signals of the cuts as the computer makes them of the other recorded signals, (n,) each.

        raises ModelError: a law is known as code only, or its motion is no sum of signals
        """
        return {cut.signal: self.signal(cut, rows, placed) for cut in self.cuts}

    def signal(self, cut: Cut, rows: Passes, placed: Sequence[Placed] = ()) -> Array:
        """The signal of one cut, (n,)."""
        value = _Evaluation(self, rows, placed, cut.inputs).make(cut.signal)
        if not any(isinstance(b, Moving) and b.command == cut.signal for b in self.diagram.blocks):
            return value
        if self.computer.delay:
            value = CONTROL_EFFECTS["delay"].act(value, self.computer.delay, rows.period)
        return apply(value, COMPUTER, placed, rows.period)

    def value(self, rows: Passes, name: str, placed: Sequence[Placed] = ()) -> Array:
        """A signal that the computer makes, without effects of the computer as a whole, (n,)."""
        inputs = [s for cut in self.cuts for s in cut.inputs]
        return _Evaluation(self, rows, placed, inputs).make(name)


def apply(
    samples: Array, at: str, placed: Sequence[Placed], period: float, *, on_velocity: bool = False
) -> Array:
    """The samples with the effects at a place, in the order in which they act."""
    here = [p for p in placed if p.at == at and p.effect.on_velocity == on_velocity]
    here = [p for p in here if not p.effect.of_law]
    for one in sorted(here, key=lambda p: ORDER.index(p.effect.name)):
        samples = one.effect.act(samples, one.value, period)
    return samples


def velocity_of(positions: Array, period: float) -> Array:
    """Difference of two readings over the period; zero at the first row."""
    return np.diff(positions, prepend=positions[:1]) / period


class _Evaluation:
    """Signals of one cut at the rows of one log."""

    def __init__(
        self, part: ComputerPart, rows: Passes, placed: Sequence[Placed], inputs: Sequence[str]
    ) -> None:
        self.part, self.rows, self.placed = part, rows, placed
        self.known: dict[str, Array] = {s: rows.signals[s] for s in inputs}
        count = len(next(iter(rows.signals.values())))
        self.known |= {s: np.zeros(count) for s in part.zero}
        self.makers = {s: p for p in part.diagram.parts for s in p.outputs}
        self.changed: set[str] = set()

    def make(self, signal: str) -> Array:
        """A signal that the computer makes."""
        part = self.makers[signal]
        if isinstance(part, Control):
            self.known[signal] = self._control(part)
        elif isinstance(part, Junction) and not part.arms:
            terms = [float(w) * self.value(s) for s, w in part.terms.items()]
            self.known[signal] = np.sum(terms, axis=0)
            if self.changed & set(part.terms):
                self.changed.add(signal)
        else:
            raise ModelError(f"{part.name}: is no sum with constant weights")
        return self.known[signal]

    def value(self, signal: str) -> Array:
        return self.known[signal] if signal in self.known else self.make(signal)

    def _control(self, block: Control) -> Array:
        source = self.value(block.input)
        here = [p.effect for p in self.placed if p.at == block.name]
        same = not any(e.on_velocity or e.of_law for e in here)
        same = same and not self.changed & {block.input, block.motion, *block.others}
        key = (self.rows.file, block.name)
        law = self.part.kept.get(key) if same else None
        if law is None:
            law = self._law_along(block, source)
        if same:
            self.part.kept[key] = law
        out = apply(law, block.name, self.placed, self.rows.period)
        if out is not law or not same:
            self.changed.add(block.output)
        return out

    def _law_along(self, block: Control, source: Array) -> Array:
        """Output of the law of a block, with the velocity that the computer has."""
        period, computer = self.rows.period, self.part.computer
        velocity = travel = np.zeros_like(source)
        if block.motion:
            readings = self.value(block.motion)
            if computer.encoder_step:
                readings = np.round(readings / computer.encoder_step) * computer.encoder_step
            velocity = travel = velocity_of(readings, period)
        if np.isfinite(computer.velocity_bandwidth):
            from scipy.signal import lfilter

            keeps = velocity_smoothing(computer.velocity_bandwidth, period)
            velocity = np.asarray(lfilter([1.0 - keeps], [1.0, -keeps], travel))
        velocity = apply(velocity, block.name, self.placed, period, on_velocity=True)
        assert isinstance(block.controller, Controller)
        here = [p for p in self.placed if p.at == block.name and p.effect.of_law]
        law = block.controller.with_values({p.effect.parameter: p.value for p in here})
        return controller_along(
            law,
            input=source,
            velocity=velocity,
            travel_rate=travel,
            period=period,
            command=self.value(block.others[0]) if law.reads_command else None,
        )


def _symbols(controller: Controller) -> set:  # type: ignore[type-arg]  # of sympy symbols
    from ..controllers import SIGNALS

    equation = controller.equation("law", SIGNALS)
    changes = (equation.output, *equation.rates.values(), *equation.steps.values())
    return set().union(*(e.free_symbols for e in changes))
