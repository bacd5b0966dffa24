"""Run the loop of a structure (`program.py`) for values, inputs, a grid of steps and samples."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import sympy as sp

from ..controllers import SIGNALS, laws_that_declare
from .program import CompiledLoop, Program

#: m, m/s, ...: size of states near rest, below every smoothing velocity and bristle length
_SMALL = 1e-9


@dataclass(frozen=True)
class Timing:
    """Grid and sampling of one run.

    step: inner step, s;  inner: steps per sample;  lag: delay of commands in steps
    late: delay of each late signal in steps, not always whole
    encoder_step: of the position readings, 0 for none
    smoothing: factor of the velocity filter per sample, or the pole of an observer
    late_samples: delay of each late signal of the computer in samples
    """

    step: float
    inner: int
    samples: int
    lag: int
    late: tuple[float, ...]
    encoder_step: float
    smoothing: float
    late_samples: tuple[float, ...] = ()

    @property
    def period(self) -> float:
        return self.step * self.inner

    @property
    def steps(self) -> int:
        return self.inner * self.samples


def velocity_smoothing(bandwidth: float, period: float) -> float:
    """Factor by which the velocity filter keeps its last output over a sample.

    bandwidth: Hz;  period: s
    The filter is the control law that declares `filter_bandwidth`; its rate is integrated exactly.
    """
    if math.isinf(bandwidth):
        return 0.0
    state = sp.Symbol("state")
    now = SimpleNamespace(input=SIGNALS["input"], output=state)
    law = laws_that_declare("filter_bandwidth")[0]
    rate = law.states["output"].rate(now, SimpleNamespace(**{law.filter_bandwidth: bandwidth}))
    return math.exp(period * float(sp.diff(rate, state)))


def execute(
    made: Program,
    values: Mapping[str, float],
    timing: Timing,
    *,
    inputs: np.ndarray,
    sampled: np.ndarray,
    start: Mapping[str, float],
    every_step: bool,
    limit: float = math.inf,
) -> tuple[np.ndarray, float]:
    """Run the loop.

    inputs: (inputs, 2 steps + 1), at every half step;  sampled: (sampled inputs, samples + 1)
    start: state -> value, 0 by default
    every_step: whether each inner step is a row of the result, not only each sample
    limit: measure of the reload above which the run ends; the remaining rows are zero
    returns: rows of the columns of the layout, and the measure of the reload (see module)
    """
    layout, rows = made.layout, (timing.steps if every_step else timing.samples) + 1
    kept = made.functions["COLUMNS"] + np.arange(len(layout.columns))
    out = np.zeros((rows, len(kept)))
    parameters = np.array([values[p] for p in layout.parameters], dtype=float)
    memory = first_memory(made, 1, parameters, start)
    no_rows = np.zeros(0, dtype=np.int64)
    with np.errstate(all="ignore"):  # plain Python warns where compiled code returns inf
        made.loop.run(
            *grid(made, timing, 1),
            every_step,
            inputs,
            sampled,
            memory,
            kept,
            out.reshape(-1),
            limit,
            rows,
            no_rows,
            no_rows,
            no_rows,
            np.zeros(0),
        )
    worst = made.functions["WORST"] + np.arange(len(layout.exponential))
    return out, float(memory[worst].max(initial=0.0))


def first_memory(
    made: Program, lanes: int, parameters: np.ndarray, start: Mapping[str, float]
) -> np.ndarray:
    """The memory of the loop at its start: rows times lanes, flat.

    parameters: flat, row by row
    """
    layout, at = made.layout, made.functions
    memory = np.zeros((at["ROWS"], lanes))
    many = len(layout.parameters)
    memory[at["PARAMETERS"] : at["PARAMETERS"] + many] = parameters.reshape(many, lanes)
    # states, bristles and the computer's states are the first rows, in this order
    for row, name in enumerate((*layout.states, *layout.computer_states)):
        memory[row] = start.get(name, 0.0)
    return memory.reshape(-1)


class LoopGrid(NamedTuple):
    """The first arguments of the loop: its grid, and ring buffers for delayed signals."""

    samples: int
    inner: int
    step: float
    period: float
    lag: int
    late_steps: np.ndarray
    encoder_step: float
    smoothing: float
    held: np.ndarray
    held_slots: int
    before: np.ndarray
    after: np.ndarray
    late_slots: int
    late_samples: np.ndarray
    past: np.ndarray
    past_slots: int


def grid(made: Program, timing: Timing, lanes: int) -> LoopGrid:
    """The first arguments of the loop for `lanes` simulations."""
    held = timing.lag // timing.inner + 2
    # three nodes before the interpolated one, and the node of the current step
    late = math.ceil(max(timing.late, default=0)) + 4
    past = int(max(timing.late_samples, default=0)) + 2
    nodes, samples = (n * lanes for n in (len(made.layout.late), len(timing.late_samples)))
    return LoopGrid(
        timing.samples,
        timing.inner,
        timing.step,
        timing.period,
        timing.lag,
        np.array(timing.late, dtype=float),
        float(timing.encoder_step),
        float(timing.smoothing),
        np.zeros(held * len(made.layout.commands) * lanes),
        held,
        np.zeros(late * nodes),
        np.zeros(late * nodes),
        late,
        np.array(timing.late_samples, dtype=float),
        np.zeros(past * samples),
        past,
    )


def fastest_rate(made: Program, values: Mapping[str, float]) -> tuple[float, str]:
    """Largest rate (1/s) of the equations at rest, and the state with the largest part in it.

    Hidden states that are integrated exactly count only by their coupling to other states.
    """
    states = made.layout.states
    if not states:
        return 0.0, ""
    parameters = np.array([values[p] for p in made.layout.parameters], dtype=float)
    rate, share = fastest_rates(slopes_at_rest(made, made.loop, parameters))
    return float(rate[0]), states[int(share[0])] if rate[0] else ""


def slopes_at_rest(made: Program, loop: CompiledLoop, parameters: np.ndarray) -> np.ndarray:
    """Derivatives of the rates by the states at rest, 1/s: (lanes, states, states).

    parameters: flat, row by row
    Exactly integrated states have no derivative by themselves here.
    """
    layout, n, lanes = made.layout, len(made.layout.states), loop.lanes
    slopes = np.zeros(n * n * lanes)
    memory = first_memory(made, lanes, parameters, {})
    inputs = np.zeros((max(len(layout.inputs), 1), 1))
    with np.errstate(all="ignore"):  # the law of a contact is also evaluated without contact
        loop.differentiate_at_rest(inputs, memory, _SMALL, slopes)
    jacobian = np.moveaxis(slopes.reshape(n, n, lanes), -1, 0)
    exact = [i for i, name in enumerate(layout.states) if name in layout.exponential]
    jacobian[:, exact, exact] = 0.0
    return jacobian


def fastest_rates(jacobian: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Largest rate of each lane, 0 where it is not finite, and index of the dominant state."""
    usable = np.isfinite(jacobian).all(axis=(1, 2))
    rates, vectors = np.linalg.eig(np.where(usable[:, None, None], jacobian, 0.0))
    sizes = np.abs(rates)
    lane, k = np.arange(len(jacobian)), np.argmax(sizes, axis=1)
    return sizes[lane, k] * usable, np.argmax(np.abs(vectors[lane, :, k]), axis=1)
