"""A simulation ready to run: program, grid, tables of inputs, and the guard of its step."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ..diagrams import Diagram
from ..errors import ModelError, did_you_mean
from ..realise.simulated import in_computer, simulated
from .sampling import SAMPLED, Sampling
from .trajectory import Trajectory

if TYPE_CHECKING:
    from ..realise.kernel import Program, Timing

Input = float | np.ndarray | Callable[[np.ndarray], np.ndarray]
#: most numbers that one simulation may hold, 2 GB
MOST_NUMBERS = 250_000_000
_MOST_REFINED = 200  # inner steps a default one may become


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
    """Everything that `simulate` does before it runs; arguments as there."""
    from ..realise.kernel import program

    motion, inputs, initial = dict(motion or {}), dict(inputs or {}), dict(initial or {})
    for name in inputs:
        if name not in diagram.outside:
            raise ModelError(
                f'{diagram.name}: "{name}" is not from outside, inputs are '
                f"{', '.join(diagram.outside)}{did_you_mean(name, diagram.outside)}"
            )
    positive = {"duration": duration, "step": step, "give": give}
    for name, value in positive.items():
        if not 0 < value < float("inf"):
            raise ModelError(f"simulate: {name}: found {value:g}, expected more than 0")
    body = simulated(diagram, give, motion)
    sampled = not isinstance(computer, str)
    setting = Sampling() if isinstance(computer, str) else computer
    if sampled:
        body = in_computer(body, setting.period)
    made = program(
        body,
        prescribed=tuple(motion),
        sampled=sampled,
        observer=setting.observer if sampled else 0,
        jit=jit,
    )
    states = (*made.layout.states, *made.layout.computer_states)
    for name in initial:
        if name not in states:
            raise ModelError(
                f'initial: no state "{name}", has {", ".join(states)}{did_you_mean(name, states)}'
            )
    return Setup(body, made, setting, duration, step, inputs, motion, initial)


@dataclass(frozen=True)
class Setup:
    """A simulation ready to run, also with other steps."""

    diagram: Diagram
    program: Program
    sampling: Sampling
    duration: float
    step: float
    inputs: Mapping[str, Input]
    motion: Mapping[str, Trajectory]
    initial: Mapping[str, float]

    def timing(self, inner: int) -> Timing:
        """The grid with that many inner steps a sample."""
        from ..realise.kernel import Timing, velocity_smoothing

        s = self.sampling
        step = s.period / inner
        values = self.diagram.values
        delays = [
            float(delay.subs({x: values[n] for x, n in self.program.equations.parameters.items()}))
            for _, delay in self.program.equations.late.values()
        ]
        late = [_steps(d, step, "an actuation delay") for d in delays]
        if min(late, default=1) < 1:
            raise ModelError(
                f"simulate: a delay of {min(delays):g} s is below the step, {step:g} s"
            )
        return Timing(
            step,
            inner,
            max(round(self.duration / s.period), 1),
            _steps(s.delay, step, "the computer's delay"),
            tuple(late),
            s.encoder_step,
            velocity_smoothing(s.velocity_bandwidth, s.period),
        )

    def arguments(self, timing: Timing) -> dict[str, Any]:
        """Inputs on the grid of that timing, as the kernel takes them."""
        layout, n = self.program.layout, 2 * timing.steps + 1
        half = 0.5 * timing.step * np.arange(n)
        signals: dict[str, Input] = dict(self.inputs)
        for name, motion in self.motion.items():
            signals |= zip(
                (name, f"{name}_velocity", f"{name}_acceleration"), motion.all, strict=True
            )
        samples = timing.period * np.arange(timing.samples + 1)
        return {
            "inputs": _table(layout.inputs, signals, half),
            "sampled": _table(layout.sampled_inputs, signals, samples),
            "start": self.initial,
        }

    def run(self, timing: Timing, *, every_step: bool = False) -> tuple[np.ndarray, float]:
        """Rows of the program's columns and the measure of how well bristles are resolved."""
        from ..realise.kernel import execute

        layout = self.program.layout
        numbers = timing.steps * (2 * len(layout.inputs) + len(layout.columns) * every_step)
        if numbers > MOST_NUMBERS:
            raise ModelError(
                f"simulate: {timing.steps:.2g} steps of {timing.step:.2g} s need "
                f"{8e-9 * numbers:.2g} GB: use a longer step, a shorter time or more give"
            )
        return execute(
            self.program,
            self.diagram.values,
            timing,
            every_step=every_step,
            **self.arguments(timing),
        )

    def checked(
        self, *, long_step: Literal["refine", "refuse"], every_step: bool = False
    ) -> tuple[np.ndarray, Timing]:
        """Run with a step that resolves oscillations and bristles, or refuse the one given."""
        from ..realise.kernel import FASTEST, JUMP, RELOAD, fastest_rate, refine_factor, too_long

        inner = max(-int(-self.sampling.period * (1 - 1e-9) // self.step), 1)
        most = inner * _MOST_REFINED
        rate, state = fastest_rate(self.program, self.diagram.values)
        if rate > JUMP:
            raise ModelError(
                f"simulate: a force on {state} jumps with the sign of a velocity: no step resolves "
                "that in continuous time; sample the controller, or take a law that is rounded off"
            )
        timing = self.timing(inner)
        if rate * timing.step > FASTEST:
            if long_step == "refuse":
                turns = 2 * np.pi / (rate * timing.step)
                why = f"is {turns:.2g} steps per period of {state}"
                raise too_long(timing.step, FASTEST / rate, why)
            inner *= refine_factor(rate * timing.step, FASTEST, 1)
        while inner <= most:
            timing = self.timing(inner)
            rows, worst = self.run(timing, every_step=every_step)
            if not np.isfinite(rows).all():
                raise ModelError(
                    f"simulate: signals grow beyond all bounds at a step of {timing.step:g} s: the "
                    "loop is unstable or a parameter makes no sense"
                )
            if worst <= RELOAD:
                return rows, timing
            factor = refine_factor(worst, RELOAD, 2)
            if long_step == "refuse":
                steps = np.sqrt(2 / worst)
                why = f"is {steps:.2g} steps for the bristle's reload after a reversal"
                raise too_long(timing.step, timing.step / factor, why)
            inner *= factor
        raise too_long(self.step, self.sampling.period / inner, "is far too long")


def _steps(delay: float, step: float, what: str) -> int:
    """The delay in steps; if no whole number of them, the force would be silently late."""
    count = round(delay / step)
    if abs(count * step - delay) > 0.02 * delay + 1e-12:
        raise ModelError(
            f"simulate: {what} of {delay * 1e3:g} ms is no whole number of steps of "
            f"{step * 1e3:g} ms: use a step that divides it"
        )
    return count


def _table(names: tuple[str, ...], signals: Mapping[str, Input], time: np.ndarray) -> np.ndarray:
    table = np.zeros((max(len(names), 1), len(time)))
    for i, name in enumerate(names):
        value = signals.get(name, 0.0)
        row = np.asarray(value(time) if callable(value) else value, dtype=float)
        if row.ndim and row.shape != time.shape:
            raise ModelError(
                f'simulate: input "{name}" has {len(row)} samples, expected {len(time)}'
            )
        table[i] = row
    return table
