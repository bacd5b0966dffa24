"""Source of the simulation loop, generated from the equations of a diagram.

Inner steps: exponential Runge-Kutta of order four (Cox, Matthews, J. Comput. Phys. 176 (2002) 430,
eqs (26) to (29)), with the rate of a hidden state split as A z + B, A frozen at the start of the
step; A = 0 for the motion, for which it is the classical Runge-Kutta method. At every sample the
computer reads its sensors and steps its states as they say, or exactly for inputs held over the
sample.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import sympy as sp

from .equations import (
    PERIOD,
    TIME,
    Equations,
    acceleration,
    estimate,
    measured,
    signal,
    travel_rate,
    velocity,
)
from .exponentials import PHI, WEIGHTS, head
from .laws import Names, assignments, indented

#: arguments of the generated `run`; arrays: inputs (n, 2 N + 1) on half steps, sampled (n, samples
#: + 1), held (samples + 1, commands), history (N + 1, late), out (rows, columns)
ARGUMENTS = (
    "samples inner h period lag late_steps encoder_step smoothing parameters inputs sampled start "
    "computer_start every_step held history out"
).split()


@dataclass(frozen=True)
class Layout:
    """Order of everything that the generated function takes and gives, as names.

    columns: of a row of the result;  exponential: states stepped exactly in their affine part
    """

    states: tuple[str, ...]
    computer_states: tuple[str, ...]
    inputs: tuple[str, ...]
    sampled_inputs: tuple[str, ...]
    commands: tuple[str, ...]
    late: tuple[str, ...]
    parameters: tuple[str, ...]
    columns: tuple[str, ...]
    exponential: tuple[str, ...]


def slopes(equations: Equations) -> dict[sp.Symbol, sp.Expr]:
    """Hidden state -> A, where its rate is A z + B with A free of the state."""
    moving = {f(m) for m in equations.motions for f in (signal, velocity)}
    by_state = {}
    for state, rate in equations.rates.items():
        # as it stands: simplified, exp(-u) may come out as 1/exp(u), which overflows
        slope = sp.diff(rate, state) if state not in moving else sp.S(0)
        if slope != 0 and not slope.has(state):
            by_state[state] = slope
    return by_state


def needed_steps(
    results: Iterable[sp.Expr], joined: Mapping[sp.Symbol, sp.Expr]
) -> dict[sp.Symbol, sp.Expr]:
    """Those of the named steps that the results are written in, in their order."""
    wanted = set().union(*(sp.sympify(r, strict=True).free_symbols for r in results))
    needed = {}
    for symbol, expression in reversed(list(joined.items())):
        if symbol in wanted:
            needed[symbol] = expression
            wanted |= expression.free_symbols
    return dict(reversed(list(needed.items())))


def _function(
    name: str,
    arguments: Iterable[sp.Symbol],
    results: list[sp.Expr],
    names: Names,
    joined: Mapping[sp.Symbol, sp.Expr] = MappingProxyType({}),
) -> str:
    """Source of a function that returns the results, common parts computed once."""
    if not results:
        return ""
    needed = {names[s]: e for s, e in needed_steps(results, joined).items()}
    out = {f"out{i}": sp.sympify(r, strict=True) for i, r in enumerate(results)}
    lines = [*assignments(needed, names), *assignments(out, names, shared="k")]
    parameters = ", ".join(names[a] for a in arguments)
    body = indented([*lines, f"return ({', '.join(out)},)"], 4)
    return f"@jitted\ndef {name}({parameters}):\n{body}\n\n\n"


class Generator:
    """Names and source for one diagram's equations.

    observer: order of the observer that estimates velocities, 2 or 3; 0: a filtered difference
    """

    def __init__(self, equations: Equations, *, observer: int = 0) -> None:
        e = self.equations = equations
        self.observer = observer
        self.slopes = slopes(e)
        self.states = sorted(e.rates, key=str)
        self.computer_states = sorted((*e.computer.rates, *e.computer.steps), key=str)
        self.motions = [*e.motions, *e.prescribed]
        self.commands = list(e.commands)
        self.late = list(e.late)
        self.sampled_inputs = [signal(s) for s in e.sampled_inputs] if e.commands else []
        used = set().union(*(x.free_symbols for x in self._expressions()))
        self.parameters = sorted(used & set(e.parameters), key=str)
        self.analog = [
            TIME,
            *self.states,
            *e.inputs,
            *(e.commands[c] for c in self.commands),
            *self.late,
            *self.parameters,
        ]
        self.sensors = sorted(
            {s for x in self._computer_expressions() for s in x.free_symbols}
            & {measured(s) for s in (*e.signals, *self.motions)},
            key=str,
        )
        self.reads = [
            *self.sensors,
            *(f(m) for m in self.motions for f in (travel_rate, estimate)),
            *self.sampled_inputs,
            *self.computer_states,
            *self.parameters,
            *({PERIOD} & used),
        ]
        self.motion_signals = [f(m) for m in self.motions for f in (signal, velocity, acceleration)]
        self.variables = self._variables()
        self.names = self._names()

    def _variables(self) -> dict[str, str]:
        """Variable of the source for each quantity by its name; no such name begins another one."""
        e = self.equations
        symbols = [*self.states, *self.computer_states, *e.inputs, *self.late, *self.sensors]
        symbols += [f(m) for m in self.motions for f in (travel_rate, estimate)]
        symbols += [*self.sampled_inputs, *self.motion_signals]
        names = [*map(str, symbols), *self.commands, *e.signals, *e.computer.signals]
        return {name: f"v{i}_" for i, name in enumerate(dict.fromkeys(names))}

    def _names(self) -> dict[sp.Symbol, str]:
        """Private name of every symbol that the equations hold."""
        e = self.equations
        names = {p: f"p{i}" for i, p in enumerate(self.parameters)}
        names |= {s: f"j{i}_" for i, s in enumerate(e.joined)} | {TIME: "time", PERIOD: "period"}
        used = set().union(*(x.free_symbols for x in self._expressions()))
        used |= {*self.analog, *self.reads}
        return names | {s: self.variables[s.name] for s in used if s not in names}

    def variable(self, quantity: sp.Symbol | str) -> str:
        """The variable of the source that holds a quantity."""
        return self.variables[str(quantity)]

    def _computer_expressions(self) -> list[sp.Expr]:
        computer = self.equations.computer
        steps = computer.steps.values()
        return [*computer.rates.values(), *steps, *computer.signals.values()]

    def _expressions(self) -> list[sp.Expr]:
        e = self.equations
        late = [expression for expression, _ in e.late.values()]
        analog = [*e.rates.values(), *e.signals.values(), *late, *e.joined.values()]
        return [*analog, *self._computer_expressions()]

    def layout(self) -> Layout:
        """The order of everything."""
        e = self.equations
        names = [s.name for s in self.motion_signals]
        names += [*e.signals, *e.computer.signals]
        names += [s.name for s in self.states if s.name not in names]
        return Layout(
            states=tuple(s.name for s in self.states),
            computer_states=tuple(s.name for s in self.computer_states),
            inputs=tuple(s.name for s in e.inputs),
            sampled_inputs=tuple(s.name for s in self.sampled_inputs),
            commands=tuple(self.commands),
            late=tuple(s.name for s in self.late),
            parameters=tuple(e.parameters[p] for p in self.parameters),
            columns=tuple(names),
            exponential=tuple(s.name for s in self.slopes),
        )

    def source(self, *, jit: bool) -> str:
        """The module's functions of the equations; the loop over them is `loop_source`."""
        e = self.equations
        rates = [e.rates[s] for s in self.states]
        accelerations = [e.rates[velocity(m)] for m in e.motions]

        def analog(name: str, results: list[sp.Expr]) -> str:
            return _function(name, self.analog, results, self.names, e.joined)

        parts = [
            head("Generated from the laws of the blocks of a diagram; do not edit.", jit=jit),
            PHI,
            WEIGHTS,
            "\n\n",
            analog("rates", rates),
            analog("slopes", list(self.slopes.values())),
            analog("signals", [*accelerations, *e.signals.values()]),
            analog("late_values", [x for x, _ in e.late.values()]),
            self._computer_functions(),
        ]
        return "".join(parts)

    def _computer_functions(self) -> str:
        computer = self.equations.computer
        out = []
        for name, wanted in (("before", True), ("after", False)):
            here = [s for s in self.computer_states if (s in computer.before) is wanted]
            chosen = [s for s in here if s in computer.rates]
            a = [sp.diff(computer.rates[s], s) for s in chosen]
            b = [computer.rates[s].xreplace({s: sp.S(0)}) for s in chosen]
            out.append(_function(f"{name}_rates", self.reads, [*a, *b], self.names))
            steps = [computer.steps[s] for s in here if s in computer.steps]
            out.append(_function(f"{name}_steps", self.reads, steps, self.names))
        out.append(_function("computer", self.reads, list(computer.signals.values()), self.names))
        return "".join(out)
