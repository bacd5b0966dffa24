"""A diagram with its computer as a python-control system in discrete time.

One step is one sample of the simulation: the computer reads its sensors and acts, then bodies and
analog blocks advance by inner steps of the same loop (`integrator.py`), with all inputs held. All
that a later sample needs is a state: states of bodies and controllers, held commands, last position
readings, and samples of delay blocks.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.errors import ModelError
from ..diagrams import Diagram
from .kernel import fastest_rate, first_memory
from .program import Program, program
from .signal_symbols import delay_in_samples
from .simulated import realise_in_computer
from .steps import StepLadder

if TYPE_CHECKING:
    import control

#: most samples of a delay block, each of them a state: 10 s at 1 kHz, more than any channel has.
#: The memory of a linearisation grows with the square of this number
_MOST_KEPT = 10_000


def sampled_iosystem(diagram: Diagram, dt: float, step: float) -> control.NonlinearIOSystem:
    """The discrete-time system of a diagram whose bodies are ready for simulation.

    diagram: from `prepare_for_simulation`
    dt: s, period of the computer and step of the system;  step: longest inner step, s
    raises ModelError: an analog signal is late, or a delay takes too many samples
    """
    from ..base import python_control as control

    form = realise_in_computer(diagram, dt)
    made = program(form, jit=False)
    if made.layout.late:
        raise ModelError(
            f"{diagram.name}: an analog signal that is late has no state of a fixed size between "
            "samples: use `simulate`, or delay_order for a delay block"
        )
    one = _Sample(made, dt, step, _delays_in_samples(made, form, dt))
    names = (*made.layout.inputs, *made.layout.sampled_inputs)
    inputs = [name for name in diagram.outside if name in names]
    return control.nlsys(
        lambda t, x, u, params: one(t, x, dict(zip(inputs, u, strict=True)), params).after,
        lambda t, x, u, params: one(t, x, dict(zip(inputs, u, strict=True)), params).signals,
        inputs=inputs,
        outputs=[name for name in made.layout.columns if name not in inputs],
        states=one.state_names or None,
        params={name: form.values[name] for name in made.layout.parameters},
        name=diagram.name.replace(" ", "_"),
        dt=dt,
    )


def _delays_in_samples(made: Program, form: Diagram, dt: float) -> tuple[float, ...]:
    """Delay of each late signal of the computer, in samples.

    raises ModelError: a delay takes too many samples
    """
    e, values = made.equations, form.values
    at = {x: values[n] for x, n in e.parameters.items()}
    counts = tuple(
        delay_in_samples(float(d.subs(at)), dt, what=form.name) for _, d in e.computer.late.values()
    )
    if max(counts, default=0.0) > _MOST_KEPT:
        raise ModelError(
            f"{form.name}: a delay of {max(counts):.0f} samples is as many states: expected at "
            f"most {_MOST_KEPT}"
        )
    return counts


@dataclass(frozen=True)
class _Answer:
    """Results of one sample;  signals: outputs at the sample;  after: state at the next one."""

    signals: np.ndarray
    after: np.ndarray


class _Sample:
    """One sample of the loop, as a function of state, inputs and parameters."""

    def __init__(self, made: Program, dt: float, step: float, late: tuple[float, ...]) -> None:
        self.made, self.dt, self.late = made, dt, np.array(late, dtype=float)
        self.ladder = StepLadder(step, dt, max(math.ceil(dt / step * (1 - 1e-9)), 1))
        layout, at = made.layout, made.functions
        self.slots = int(max(late, default=0.0)) + 2
        motions = [f"{name}_read" for name in self._motions()]
        groups = {
            "STATES": layout.states,
            "COMPUTER_STATES": layout.computer_states,
            "COMMANDS": tuple(f"{name}_held" for name in layout.commands),
            "LAST_READING": tuple(motions),
        }
        self.rows = np.concatenate(
            [at[first] + np.arange(len(names)) for first, names in groups.items()]
        ).astype(int)
        kept = [f"late_{i}_{k}" for k in range(1, self.slots) for i in range(len(late))]
        self.state_names = [*(n for names in groups.values() for n in names), *kept]
        self.inner: dict[tuple[float, ...], int] = {}
        self.last: tuple[Any, _Answer] | None = None

    def _motions(self) -> tuple[str, ...]:
        """Motions whose last readings are states, by the user's names."""
        e, layout = self.made.equations, self.made.layout
        if not layout.commands:
            return ()
        # columns begin with position, velocity and acceleration of each motion
        return tuple(layout.columns[3 * i] for i in range(len(e.motions)))

    def __call__(
        self, t: float, x: np.ndarray, inputs: Mapping[str, float], params: Mapping[str, float]
    ) -> _Answer:
        layout = self.made.layout
        values = tuple(float(params[name]) for name in layout.parameters)
        key = (float(t), np.asarray(x, dtype=float).tobytes(), tuple(inputs.values()), values)
        if self.last is None or self.last[0] != key:
            self.last = (key, self._answer(t, np.asarray(x, dtype=float), inputs, values))
        return self.last[1]

    def _answer(
        self, t: float, x: np.ndarray, inputs: Mapping[str, float], values: tuple[float, ...]
    ) -> _Answer:
        if values not in self.inner:
            named = dict(zip(self.made.layout.parameters, values, strict=True))
            self.inner[values] = self.ladder.first(*fastest_rate(self.made, named))
        inner = self.inner[values]
        while True:
            answer, worst = self._advance(t, x, inputs, values, inner)
            finer = self.ladder.next(inner, worst, bool(np.isfinite(answer.after).all()))
            if finer == inner:
                return answer
            inner = finer

    def _advance(
        self,
        t: float,
        x: np.ndarray,
        inputs: Mapping[str, float],
        values: tuple[float, ...],
        inner: int,
    ) -> tuple[_Answer, float]:
        """The sample with `inner` inner steps, and a measure of how well they resolve bristles."""
        at, layout, h = self.made.functions, self.made.layout, self.dt / inner
        memory = first_memory(self.made, 1, np.array(values), {})
        memory[self.rows] = x[: len(self.rows)]
        past = self._ring(x[len(self.rows) :])
        analog = tuple(inputs[name] for name in layout.inputs)
        sampled = tuple(inputs[name] for name in layout.sampled_inputs)
        with np.errstate(all="ignore"):  # plain Python warns where compiled code returns inf
            at["find_inverses"](memory, 0)
            if at["COMPUTER"]:
                at["sample"](
                    *(False, round(t / self.dt), self.slots, t, self.dt, 0.0, 0.0, analog),
                    *(sampled, self.late, past, self.slots, memory, 0),
                )
                new, many = at["NEW_COMMANDS"], len(layout.commands)
                memory[at["COMMANDS"] : at["COMMANDS"] + many] = memory[new : new + many]
            else:
                arguments = (t, at["STATES"], at["BRISTLES"], analog, at["LATE"])
                at["signals"](*arguments, memory, at["NOW"], 0)
            at["record"](analog, memory, at["COLUMNS"], 0)
            rows = memory[at["COLUMNS"] : at["COLUMNS"] + len(layout.columns)]
            signals = np.array(
                [x for x, name in zip(rows, layout.columns, strict=True) if name not in inputs]
            )
            for j in range(inner):
                at["advance"](j == 0, t + j * h, h, analog, analog, analog, memory)
        worst = memory[at["WORST"] : at["WORST"] + len(layout.exponential)].max(initial=0.0)
        after = np.concatenate([memory[self.rows], self._order_ring(past)])
        return _Answer(signals, after), float(worst)

    def _ring(self, kept: np.ndarray) -> np.ndarray:
        """Delayed samples in the ring of the loop; the present sample has the place `slots`."""
        many = len(self.late)
        past = np.zeros((self.slots, many))
        for age in range(1, self.slots):
            past[-age % self.slots] = kept[(age - 1) * many : age * many]
        return past.reshape(-1)

    def _order_ring(self, past: np.ndarray) -> np.ndarray:
        """The samples of the ring by their age at the next sample, starting at 1."""
        ring = past.reshape(self.slots, len(self.late))
        return np.concatenate([ring[-age % self.slots] for age in range(self.slots - 1)])
