"""The compiled simulation of a diagram: equations -> generated source -> numba, cached on disk.

Values are arguments: only another structure (other blocks or effects) compiles anew. A step that is
too long is found and said, by two measures that need no second run:

- steps per radian of the fastest oscillation or decay of the equations at rest, friction stuck;
- where a bristle is reloaded after a reversal: that takes the time sqrt(2 lambda / a), lambda its
  length and a the acceleration. One step changes the bristle's decay rate by h a / lambda, so
  N = sqrt(2 / (h * change)) steps fall into that time.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import sympy as sp

from ..blocks import Body, MatrixImpedance
from ..controllers import SIGNALS, ControlLaw, Controller, laws_that_declare
from ..diagrams import Control, Diagram, Kinematics
from ..effects import Effect
from ..errors import ModelError
from ._codegen import Generator, Layout
from ._codegen_loop import loop_source
from .compiled import compiled
from .equations import Equations, equations
from .private_names import PrivateNames, private_names

#: h times the fastest rate of the equations at rest; 0.3: 20 steps a period
FASTEST = 0.3
#: 1/s; a larger rate is no physics but a jump: 1 N at once on 1 kg within 1 nm/s is 1e9
JUMP = 1e7
#: bound of h * (change of a bristle's decay rate in a step); 0.02: 10 steps a reload
RELOAD = 0.02


@dataclass(frozen=True)
class Program:
    """The simulation loop for one structure of a diagram, for any values.

    run: generated loop, compiled or plain Python;  functions: the module's plain functions by name
    equations: on private symbols (`private_names`), their parameters by the user's names
    """

    equations: Equations
    layout: Layout
    run: Callable[..., float]
    functions: Mapping[str, Any]


@dataclass(frozen=True)
class Timing:
    """Grid and sampling of one run.

    step: inner step, s;  inner: steps a sample;  lag: delay of commands in steps
    late: delay of each late signal in steps
    smoothing: factor of the velocity filter a sample, the pole of an observer
    """

    step: float
    inner: int
    samples: int
    lag: int
    late: tuple[int, ...]
    encoder_step: float
    smoothing: float

    @property
    def period(self) -> float:
        return self.step * self.inner

    @property
    def steps(self) -> int:
        return self.inner * self.samples


_programs: dict[Any, Program] = {}


def program(
    diagram: Diagram,
    *,
    prescribed: tuple[str, ...] = (),
    sampled: bool = True,
    observer: int = 0,
    jit: bool = True,
) -> Program:
    """The loop for this diagram's structure, built and compiled where it is not yet.

    observer: its order, where the computer observes velocities in place of filtering differences
    jit: False runs the same generated source in plain Python, some hundred times slower
    """
    names = private_names(diagram)
    motions = tuple(names.private.get(motion, motion) for motion in prescribed)
    key = (_structure(names.diagram), motions, sampled, observer, jit)
    if key not in _programs:
        with names.in_errors():
            private = equations(names.diagram, prescribed=motions, sampled=sampled)
        generator = Generator(private, observer=observer)
        loop = loop_source(generator)
        source = generator.source(jit=jit) + loop
        plain = _executed(generator.source(jit=False) + loop)
        run = compiled(source, "run") if jit else plain["run"]
        _programs[key] = Program(generator.equations, generator.layout(), run, plain)
    return _in_public(_programs[key], names)


def _in_public(private: Program, names: PrivateNames) -> Program:
    """The program with the user's names of signals, states and parameters."""
    layout = private.layout
    named = (*layout.columns, *layout.states, *layout.computer_states, *layout.inputs)
    names.public_names(*named, *layout.sampled_inputs)
    public = {
        field.name: tuple(map(names.public_name, getattr(layout, field.name)))
        for field in fields(layout)
    }
    parameters = private.equations.parameters
    public_parameters = {symbol: names.public_name(name) for symbol, name in parameters.items()}
    equations = replace(private.equations, parameters=public_parameters)
    return replace(private, equations=equations, layout=Layout(**public))


@lru_cache(maxsize=64)
def _executed(source: str) -> Mapping[str, Any]:
    module: dict[str, Any] = {"__name__": "teleopdesign_plain_kernel"}
    exec(compile(source, "<generated>", "exec"), module)
    return module


def _structure(diagram: Diagram) -> tuple[Any, ...]:
    """What the equations depend on apart from values; laws compare by identity."""
    out: list[Any] = [tuple(diagram.outside.items()), diagram.measured]
    for part in diagram.parts:
        wires = (part.name, part.inputs, part.outputs)
        terms = tuple(getattr(part, "terms", getattr(part, "loads", {})).items())
        block = getattr(part, "controller", getattr(part, "body", None))
        laws: tuple[Any, ...] = ()
        if isinstance(block, Controller):
            laws = tuple((g.name, g.law.law, _states(g.law)) for g in block.stages)
        elif isinstance(block, Body):
            laws = tuple((e.name, e.role, e.law, _states(e)) for e in block.effects)
        elif isinstance(block, MatrixImpedance):
            laws = tuple(block.parameters)
        elif isinstance(part, Kinematics):
            laws = (part.expression,)
        sign = getattr(part, "sign", 1)
        motion = (part.motion, part.analog) if isinstance(part, Control) else ()
        out.append((type(part).__name__, wires, terms, sign, motion, laws))
    return tuple(out)


def _states(law: Effect | ControlLaw) -> tuple[Any, ...]:
    return tuple(law.states.items())


def velocity_smoothing(bandwidth: float, period: float) -> float:
    """Factor by which the velocity filter keeps its last output over a sample.

    The filter is the control law that declares to be one, its rate's own slope stepped exactly.
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
) -> tuple[np.ndarray, float]:
    """Run the loop.

    inputs: (inputs, 2 steps + 1), at every half step;  sampled: (sampled inputs, samples + 1)
    start: state -> value, 0 where not given
    returns: rows of the columns of the layout, and the measure of the reload (see module)
    """
    layout, n = made.layout, timing.steps
    rows = (n if every_step else timing.samples) + 1
    out = np.zeros((rows, len(layout.columns)))
    with np.errstate(all="ignore"):  # plain Python warns where compiled code gives inf
        worst = made.run(
            timing.samples,
            timing.inner,
            timing.step,
            timing.period,
            timing.lag,
            np.array(timing.late or (0,), dtype=np.int64),
            float(timing.encoder_step),
            float(timing.smoothing),
            np.array([values[p] for p in layout.parameters] or [0.0]),
            inputs,
            sampled,
            np.array([start.get(s, 0.0) for s in layout.states] or [0.0]),
            np.array([start.get(s, 0.0) for s in layout.computer_states] or [0.0]),
            every_step,
            np.zeros((timing.samples + 1, max(len(layout.commands), 1))),
            np.zeros((n + 1, max(len(layout.late), 1))),
            out,
        )
    return out, float(worst)


def fastest_rate(made: Program, values: Mapping[str, float]) -> tuple[float, str]:
    """Largest rate (1/s) of the equations at rest and the state that takes part in it most.

    Hidden states stepped exactly by themselves count only through what they couple to.
    """
    layout = made.layout
    if not layout.states:
        return 0.0, ""
    parameters = [values[p] for p in layout.parameters]
    inputs = [0.0] * (len(layout.inputs) + len(layout.commands) + len(layout.late))

    def rates(x: np.ndarray) -> np.ndarray:
        with np.errstate(all="ignore"):  # a contact's law is evaluated where nothing touches too
            return np.array(made.functions["rates"](0.0, *x, *inputs, *parameters))

    n = len(layout.states)
    small = 1e-9  # at rest: below every smoothing velocity and bristle length
    jacobian = np.empty((n, n))
    for i in range(n):
        d = np.zeros(n)
        d[i] = small
        jacobian[:, i] = (rates(d) - rates(-d)) / (2 * small)
    for i, name in enumerate(layout.states):
        if name in layout.exponential:
            jacobian[i, i] = 0.0
    if not np.isfinite(jacobian).all():
        return 0.0, ""
    values_, vectors = np.linalg.eig(jacobian)
    k = int(np.argmax(np.abs(values_)))
    return float(abs(values_[k])), layout.states[int(np.argmax(np.abs(vectors[:, k])))]


def refine_factor(measure: float, bound: float, power: float) -> int:
    """By how much to divide a step whose measure, of that power in the step, is above the bound."""
    return math.ceil(math.pow(measure / bound, 1 / power) * 1.0001)


def too_long(step: float, use: float, why: str) -> ModelError:
    """The error for a step that is refused, with the step to use."""
    return ModelError(f"simulate: step {step * 1e3:.4g} ms {why}: use {use * 1e3:.3g} ms or less")
