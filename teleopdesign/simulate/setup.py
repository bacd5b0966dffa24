"""A simulation that is ready to run: program, time grid, tables of inputs, and its step control."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ..base.errors import ModelError, UnknownSignal, unknown
from ..diagrams import Diagram, with_shared_states
from ..realise.signal_symbols import delay_in_samples, is_whole
from ..realise.simulated import prepare_for_simulation, realise_in_computer, refuse_massless
from ..realise.steps import StepLadder
from . import on_grid
from .on_grid import (
    Input,
    delay_in_steps,
    input_table,
    refuse_results,
    samples_of,
    whole_steps,
    with_recorded,
)
from .sampling import SAMPLED, Sampling
from .trajectory import Trajectory

if TYPE_CHECKING:
    from ..realise.kernel import Timing
    from ..realise.program import Program

#: most numbers that one simulation may hold, 2 GB
MOST_NUMBERS = 250_000_000
#: largest divisor of the step, so that every delay becomes a whole number of steps
_MOST_DIVIDED = 20


def prepare(
    diagram: Diagram,
    *,
    duration: float,
    inputs: Mapping[str, Input] | None = None,
    motion: Mapping[str, Trajectory] | None = None,
    initial: Mapping[str, float] | None = None,
    computer: Sampling | Literal["continuous"] = SAMPLED,
    step: float = 1e-4,
    give: float = 1e-5,
    jit: bool = True,
) -> Setup:
    """Check the arguments of `simulate` and compile the diagram, without running the simulation.

    The arguments are those of `simulate`.
    """
    motion, initial = dict(motion or {}), dict(initial or {})
    inputs = with_recorded(inputs or {}, duration)
    for name in inputs:
        if name not in diagram.outside:
            wrong = unknown("signal from outside", name, diagram.outside)
            raise UnknownSignal(f"{diagram.name}: {wrong}")
    refuse_results(diagram, inputs, motion)
    positive = {"duration": duration, "step": step, "give": give}
    for name, value in positive.items():
        if not 0 < value < float("inf"):
            raise ModelError(f"{name}: found {value:g}, expected more than 0")
    setting = Sampling() if isinstance(computer, str) else computer
    body, made = _form_and_program(_Same(diagram), tuple(motion), computer, give, jit)
    states = (*made.layout.states, *made.layout.computer_states)
    for name in initial:
        if name not in states:
            raise UnknownSignal(f"initial: {unknown('state', name, states)}")
    return Setup(body, made, setting, duration, step, give, inputs, motion, initial)


@dataclass(frozen=True, eq=False)
class _Same:
    """A diagram compared by identity; it is frozen, so cached results remain valid."""

    diagram: Diagram

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Same) and self.diagram is other.diagram

    def __hash__(self) -> int:
        return id(self.diagram)


@lru_cache(maxsize=64)
def _form_and_program(
    same: _Same,
    motion: tuple[str, ...],
    computer: Sampling | Literal["continuous"],
    give: float,
    jit: bool,
) -> tuple[Diagram, Program]:
    """The simulated form of a diagram, and the compiled program for its structure."""
    from ..realise.program import program

    body = simulated_form(same.diagram, motion=motion, computer=computer, give=give)
    sampled, observer = False, 0
    if not isinstance(computer, str):
        sampled, observer = True, computer.observer
    return body, program(body, prescribed=motion, sampled=sampled, observer=observer, jit=jit)


def simulated_form(
    diagram: Diagram,
    *,
    motion: Iterable[str],
    computer: Sampling | Literal["continuous"],
    give: float,
) -> Diagram:
    """The form of a diagram that is simulated; the arguments are those of `simulate`."""
    body = prepare_for_simulation(diagram, give, motion)
    if isinstance(computer, str):
        return with_shared_states(body)
    return realise_in_computer(body, computer.period)


@dataclass(frozen=True)
class Setup:
    """A simulation that is ready to run, with its step or a shorter one.

    duration, step: s;  give: m or rad;  inputs: signal -> values;  motion: prescribed motions
    initial: state -> start value, SI
    """

    diagram: Diagram
    program: Program
    sampling: Sampling
    duration: float
    step: float
    give: float
    inputs: Mapping[str, Input]
    motion: Mapping[str, Trajectory]
    initial: Mapping[str, float]

    @property
    def samples(self) -> int:
        """Number of samples of a run."""
        return samples_of(self.duration, self.sampling.period)

    @cached_property
    def delays(self) -> list[float]:
        """Delay (s) of each delayed signal: of analog signals, then of signals in the computer."""
        values, parameters = self.diagram.values, self.program.equations.parameters
        at = {x: values[n] for x, n in parameters.items()}
        return [float(d.subs(at)) for d in self.program.equations.delays]

    @cached_property
    def _of_blocks(self) -> list[bool]:
        """For each delayed analog signal: whether a delay block delays it, not an actuator."""
        e, names = self.program.equations, {c.name for c in self.diagram.controls}
        late = (d.free_symbols for _, d in e.late.values())
        return [any(e.parameters[x].partition(".")[0] in names for x in d) for d in late]

    @property
    def whole_step_delays(self) -> frozenset[str]:
        """Delay parameters that are rounded to whole steps: signals jump when they change."""
        e, smooth = self.program.equations, self.program.functions["SMOOTH"]
        flags = zip(self._of_blocks, smooth, strict=False)
        whole = [not (of_block and is_smooth) for of_block, is_smooth in flags]
        late = [delay for _, delay in e.late.values()]
        jumping = [d for d, is_whole in zip(late, whole, strict=True) if is_whole]
        return frozenset(e.parameters[x] for d in jumping for x in d.free_symbols)

    def inner(self, delays: Sequence[float] | None = None) -> int:
        """Steps per sample: as requested, or the next number at which delay blocks are whole steps.

        If no number up to `_MOST_DIVIDED` times the requested one suits, delays are interpolated.
        """
        least = max(-int(-self.sampling.period * (1 - 1e-9) // self.step), 1)
        delays = self.delays if delays is None else delays
        late = [d for d, of_block in zip(delays, self._of_blocks, strict=False) if of_block]
        for inner in range(least, _MOST_DIVIDED * least + 1):
            if all(is_whole(d * inner / self.sampling.period) for d in late):
                return inner
        return least

    def ladder(
        self, long_step: Literal["refine", "refuse"], delays: Sequence[float] | None = None
    ) -> StepLadder:
        """The steps that a run may take;  delays: s, by default `self.delays`."""
        return StepLadder(self.step, self.sampling.period, self.inner(delays), long_step)

    def timing(self, inner: int, delays: Sequence[float] | None = None) -> Timing:
        """The grid with `inner` steps per sample;  delays: s, by default `self.delays`."""
        from ..realise.kernel import Timing, velocity_smoothing

        s = self.sampling
        step = s.period / inner
        delays = self.delays if delays is None else delays
        of_blocks, smooth = self._of_blocks, self.program.functions["SMOOTH"]
        analog = len(of_blocks)
        late = [
            delay_in_steps(d, step, can_be_between=of_block and is_smooth)
            for d, of_block, is_smooth in zip(delays, of_blocks, smooth, strict=False)
        ]
        return Timing(
            step,
            inner,
            self.samples,
            whole_steps(s.delay, step, "the computer's delay"),
            tuple(late),
            s.encoder_step,
            velocity_smoothing(s.velocity_bandwidth, s.period),
            tuple(delay_in_samples(d, s.period, what="simulate") for d in delays[analog:]),
        )

    @cached_property
    def _signals(self) -> dict[str, Input]:
        """Inputs and prescribed motions by their signals."""
        signals: dict[str, Input] = dict(self.inputs)
        for name, motion in self.motion.items():
            signals |= zip(
                (name, f"{name}_velocity", f"{name}_acceleration"), motion.all, strict=True
            )
        return signals

    @cached_property
    def _varying(self) -> bool:
        """Whether an input of the loop varies over time."""
        listed = (self._signals.get(name, 0.0) for name in self.program.layout.inputs)
        return any(callable(x) or np.ndim(x) > 0 for x in listed)

    def arguments(self, timing: Timing) -> dict[str, Any]:
        """Inputs on the grid of a timing, in the form that the kernel takes."""
        layout = self.program.layout
        signals = on_grid.tables_as_functions(
            layout.inputs, self._signals, lambda: on_grid.half_steps(self.timing(self.inner()))
        )
        # a fine grid has 10^7 rows: one column is what is held throughout
        half = on_grid.half_steps(timing) if self._varying else np.zeros(1)
        samples = timing.period * np.arange(timing.samples + 1)
        return {
            "inputs": input_table(layout.inputs, signals, half),
            "sampled": input_table(layout.sampled_inputs, signals, samples),
            "start": self.initial,
        }

    def run(
        self, timing: Timing, *, every_step: bool = False, limit: float = math.inf
    ) -> tuple[np.ndarray, float]:
        """Rows of the program's columns, and the measure of how well bristles are resolved.

        limit: a run whose measure exceeds this value may stop early, see `StepLadder`
        """
        from ..realise.kernel import execute

        self.check_size(timing, every_step=every_step)
        return execute(
            self.program,
            self.diagram.values,
            timing,
            every_step=every_step,
            limit=limit,
            **self.arguments(timing),
        )

    def table_size(self, timing: Timing) -> int:
        """Number of values in the table of inputs of one run."""
        return 2 * timing.steps * len(self.program.layout.inputs) if self._varying else 0

    def check_size(self, timing: Timing, *, every_step: bool = False) -> None:
        """Raise ModelError if the tables of one run could hold more than `MOST_NUMBERS` values.

        Constant inputs count as well; a run of so many steps would not end.
        """
        layout = self.program.layout
        numbers = timing.steps * (2 * len(layout.inputs) + len(layout.columns) * every_step)
        if numbers > MOST_NUMBERS:
            raise ModelError(
                f"{timing.steps:.2g} steps of {timing.step:.2g} s need "
                f"{8e-9 * numbers:.2g} GB: use a longer step, a shorter time or more give"
            )

    def run_resolved(
        self, *, long_step: Literal["refine", "refuse"], every_step: bool = False
    ) -> tuple[np.ndarray, Timing]:
        """Run with a step that resolves oscillations and bristles; refine or refuse a longer step.

        raises ModelError: the step is refused, or no step resolves the signals
        """
        from ..realise.kernel import fastest_rate

        refuse_massless(self.diagram, self.motion)
        ladder = self.ladder(long_step)
        inner = ladder.first(*fastest_rate(self.program, self.diagram.values))
        limit = math.inf
        while True:
            timing = self.timing(inner)
            rows, worst = self.run(timing, every_step=every_step, limit=limit)
            if not np.isfinite(rows[0]).all():
                raise ModelError(
                    f"{self.diagram.name}: signals are no finite numbers at the start: a loop "
                    "without delay has no solution at these values, or a parameter makes no sense"
                )
            finer = ladder.next(inner, worst, bool(np.isfinite(rows).all()))
            if finer == inner:
                return rows, timing
            inner, limit = finer, ladder.limit(finer)
