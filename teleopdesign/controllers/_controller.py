"""What a control law is: one law, written once with sympy, in a file of its own.

A law sees `now.input` (the signal wired to the block), the motion that it acts along (`velocity`,
`speed` = abs(velocity), `travel_rate`), its hidden states and `now.period`, the duration of a
sample, 0 in continuous time. `speed` is apart from `velocity` so that the linear form can freeze
it; `travel_rate` is the travel of the last sample over its duration, velocity itself in continuous
time. Every form of the law (transfer function, python-control system, sampled step of the kernel)
is derived from it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any, Literal, get_args

import sympy as sp

from ..arguments import checked
from ..effects import Parameter
from ..errors import ModelError, did_you_mean
from ..frozen import Frozen
from ..notebook import html_table
from ..recipes import recipe
from ._by_numbers import by_numbers, has_numbers, is_by_numbers

_MOST_SHOWN = 8  # parameters of a law that one line shows

#: what a law may declare that it can do, by a field of `ControlLaw`
Ability = Literal["bound", "bristle_stiffness", "smoothing", "filter_bandwidth", "dead_time"]

SIGNALS = {
    name: sp.Symbol(name, real=True)
    for name in ("input", "velocity", "speed", "travel_rate", "period")
}


def only_sampled(now: Any, p: Any) -> sp.Expr:
    """Stands for the rate of a state that exists in a computer only."""
    return sp.nan


@checked
@dataclass(frozen=True)
class ControllerState:
    """A hidden state of a control law, whose `now` also carries the states of the law.

    rate(now, p): rate of change, or `only_sampled`
    step(now, p): value at the next sample, `now.period` later;  None: the step that is exact for
    the rate, which is affine in the state, with all else held
    """

    quantity: str
    rate: Callable[[Any, Any], sp.Expr]
    step: Callable[[Any, Any], sp.Expr] | None = None


@checked
@dataclass(frozen=True, repr=False)
class ControlLaw:
    """A control law: law(now, p) is its output; see the package's folder for examples.

    linear: declares that, at frozen `speed`, the law is linear in its input and in velocity;
    False: the LTI form leaves the block out, and says so.
    States whose rate or step uses `travel_rate` are brought up to a sample before its output is
    taken, all others are carried from it to the next with their inputs held.
    takes: "force" where the input must not be the motion itself; "": anything
    transfer(values, s): transfer function from the input, where not to be found from the states
    shift(values, z): transfer function in z of a law that exists in a computer only, stepped each
        `period` (a parameter of it, s); its output is held in between
    sampled(values, period): the stage that takes the place of this one in a computer of that
    period (s); None: this one, its states stepped as they say
    system: a python-control system that the law calls: known as code only, it has no equation
    response: a sympy function of s in place of a law, known on the axis at measured frequencies

    What the law can do, each by the name of the parameter that says how much; "": it cannot.
    bound: its force is never more than that, whatever the motion
    bristle_stiffness: its force is that of a Dahl bristle of that stiffness, level `bound`
    smoothing: its force is bound v/(a + abs(v)) with that a
    filter_bandwidth: its output follows its input through a low-pass of first order
    dead_time: its output is its input, late by that
    """

    law: Callable[[Any, Any], sp.Expr]
    parameters: Mapping[str, Parameter]
    states: Mapping[str, ControllerState] = field(default_factory=dict)
    linear: bool = False
    takes: Literal["", "force"] = ""
    transfer: Callable[[Mapping[str, float], sp.Symbol], sp.Expr] | None = None
    shift: Callable[[Mapping[str, float], sp.Symbol], sp.Expr] | None = None
    sampled: Callable[[Mapping[str, float], float], Stage] | None = None
    system: Any = None
    response: Any = None
    bound: str = ""
    bristle_stiffness: str = ""
    smoothing: str = ""
    filter_bandwidth: str = ""
    dead_time: str = ""
    source: str = ""
    name: str = ""
    text: str = ""

    def __post_init__(self) -> None:
        for ability in get_args(Ability):
            parameter = getattr(self, ability)
            if parameter and parameter not in self.parameters:
                raise ModelError(
                    f'{self.name or "control law"}: {ability}: no parameter "{parameter}", has '
                    f"{', '.join(self.parameters)}{did_you_mean(parameter, self.parameters)}"
                )

    def __hash__(self) -> int:
        return hash((self.name, self.law))  # what is equal has these in common

    def __copy__(self) -> ControlLaw:
        return self  # frozen: a copy could never differ

    def __deepcopy__(self, memo: object) -> ControlLaw:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        if self.response is not None:
            raise ModelError(
                f"{self.name}: a measured frequency response has no form in a file and is not "
                "sent to another process"
            )
        if self.system is not None:
            raise ModelError(
                f"{self.name}: a nonlinear system of python-control is code, which cannot be "
                "written to a file or sent to another process"
            )
        return recipe(self)

    def __repr__(self) -> str:
        return f"ControlLaw {self.name or '(no name)'}: {', '.join(self.parameters)}"

    def named(self, name: str, text: str) -> ControlLaw:
        """The law under the name of its file, with the file's docstring as its text."""
        return replace(self, name=name, text=text)


@checked
@dataclass(frozen=True)
class Stage:
    """A control law with a value (SI) for every parameter.

    name: in the names of its parameters; that of its law, numbered where a controller has it twice
    """

    law: ControlLaw
    values: Mapping[str, float]
    name: str = ""

    def __post_init__(self) -> None:
        if not self.name:
            object.__setattr__(self, "name", self.law.name)
        law, declared = self.law, self.law.parameters
        for name in self.values:
            if name not in declared:
                raise ModelError(
                    f'{law.name}: no parameter "{name}", has {", ".join(declared)}'
                    f"{did_you_mean(name, declared)}"
                )
        for name, parameter in declared.items():
            if name not in self.values:
                raise ModelError(f'{law.name}: parameter "{name}" has no value')
            if math.isinf(self.values[name]):
                raise ModelError(f"{law.name}: {name} is infinite, expected a number (SI)")
            if not parameter.lower <= self.values[name] <= parameter.upper:
                raise ModelError(
                    f"{law.name}: {name} = {self.values[name]:g} is outside "
                    f"{parameter.lower:g} .. {parameter.upper:g}"
                )
        object.__setattr__(self, "values", Frozen(self.values))

    def value_of(self, ability: Ability) -> float | None:
        """Value (SI) of the parameter that the law declares for this ability; None without one."""
        parameter = getattr(self.law, ability)
        return float(self.values[parameter]) if parameter else None


@dataclass(frozen=True)
class ControllerEquation:
    """Output and states of a controller placed under a name, on the signals given to it.

    rates: state -> rate;  steps: state -> value at the next sample, for those that state it
    before: states that are brought up to a sample before its output is taken
    """

    output: sp.Expr
    rates: Mapping[sp.Symbol, sp.Expr]
    steps: Mapping[sp.Symbol, sp.Expr]
    before: frozenset[sp.Symbol]


@checked
@dataclass(frozen=True, repr=False)
class Controller:
    """One or more control laws in series, the first one next to the input.

    A law that is there twice is numbered: "low_pass.bandwidth" and "low_pass_2.bandwidth".
    """

    stages: tuple[Stage, ...]

    def __post_init__(self) -> None:
        numbered: dict[str, Stage] = {}
        for stage in self.stages:
            name, number = stage.name, 2
            while name in numbered:
                name, number = f"{stage.law.name}_{number}", number + 1
            numbered[name] = stage if name == stage.name else replace(stage, name=name)
        object.__setattr__(self, "stages", tuple(numbered.values()))

    @checked
    def then(self, other: Controller) -> Controller:
        """This controller with another one behind it."""
        return Controller((*self.stages, *other.stages))

    @property
    def dead_time(self) -> float | None:
        """Time (s) by which it is late, where it does nothing else; None of any other."""
        times = [stage.value_of("dead_time") for stage in self.stages]
        known = [t for t in times if t is not None]
        return sum(known) if known and len(known) == len(times) else None

    def names(self) -> dict[str, float]:
        """Every parameter as "law.parameter" -> value (SI)."""
        return {f"{g.name}.{n}": float(v) for g in self.stages for n, v in g.values.items()}

    @checked
    def with_values(self, values: Mapping[str, float]) -> Controller:
        """The controller with other parameter values, by "law.parameter"."""
        known = self.names()
        for name in values:
            if name not in known:
                raise ModelError(f'controller: no parameter "{name}"{did_you_mean(name, known)}')
        known |= values
        return Controller(
            tuple(
                replace(g, values={n: known[f"{g.name}.{n}"] for n in g.values})
                for g in self.stages
            )
        )

    def sampled(self, period: float) -> Controller:
        """The controller as a computer of that period (s) realises it."""
        stages = (
            g if g.law.sampled is None else replace(g.law.sampled(g.values, period), name=g.name)
            for g in self.stages
        )
        return Controller(tuple(stages))

    def equation(
        self, prefix: str, signals: Mapping[str, sp.Expr], *, code: bool = False
    ) -> ControllerEquation:
        """The laws composed in series; prefix: name of the block, in its symbols.

        signals: those of `SIGNALS`; a `period` of 0 is continuous time
        code: whether systems that are known as code take part, as calls of their functions
        raises ModelError: continuous time, and a state that exists in a computer only; a system
            that is known as code only
        """
        value, before = signals["input"], set()
        rates: dict[sp.Symbol, sp.Expr] = {}
        steps: dict[sp.Symbol, sp.Expr] = {}
        for stage in self.stages:
            law = stage.law
            if law.response is not None:
                raise ModelError(
                    f"{prefix}: {law.name} is a measured frequency response, which tells nothing "
                    "of the steps in time: it takes part in frequency responses alone; fit a "
                    "transfer function to it"
                )
            if law.system is not None and not code:
                raise ModelError(
                    f"{prefix}: {law.name} is a nonlinear python-control system, known as code "
                    "only: it takes part in `simulate` and `to_iosystem`, and nowhere else"
                )
            now, p = _placed(stage, prefix, {**signals, "input": value})
            probe = SimpleNamespace(**{**vars(now), "travel_rate": SIGNALS["travel_rate"]})
            for name, state in law.states.items():
                symbol, in_computer = getattr(now, name), signals["period"] != 0
                if state.step is not None and in_computer:
                    change, changes = state.step, steps
                else:
                    change, changes = state.rate, rates
                if change is only_sampled:
                    raise ModelError(
                        f"{prefix}: {law.name} has no form in continuous time: it needs a computer "
                        "that samples it"
                    )
                changes[symbol] = sp.sympify(change(now, p), strict=True)
                if sp.sympify(change(probe, p), strict=True).has(SIGNALS["travel_rate"]):
                    before.add(symbol)
            value = sp.sympify(law.law(now, p), strict=True)
        return ControllerEquation(value, Frozen(rates), Frozen(steps), frozenset(before))

    def linear_form(
        self, prefix: str, s: sp.Symbol, speed: sp.Expr, *, held: bool = False
    ) -> sp.Expr | None:
        """Transfer function at constant speed; None where a law declares no linear form.

        The velocity is that of the input: where it is another motion's, see `linear_parts`.

        held: also of what was measured, and of laws in discrete time, as
            H(e^(s T)) (1 - e^(-s T))/(s T): from the samples to the mean of the held output, copies
            at other multiples of the sampling rate left out
        """
        parts = self.linear_parts(prefix, s, speed, held=held)
        if parts is None or parts[1] == 0:
            return None if parts is None else parts[0]
        return sp.simplify(sp.Add(*parts))

    def linear_parts(
        self, prefix: str, s: sp.Symbol, speed: sp.Expr, *, held: bool = False
    ) -> tuple[sp.Expr, sp.Expr] | None:
        """Transfer functions from the input, and from the position along whose velocity it acts.

        Arguments as of `linear_form`, which is their sum: the two are one signal there
        """
        if not all(stage.law.linear or (held and has_numbers(stage)) for stage in self.stages):
            return None
        if all(is_by_numbers(stage) for stage in self.stages):
            return sp.Mul(*(by_numbers(stage, s) for stage in self.stages)), sp.S(0)
        drive, moved = sp.Symbol("drive"), sp.Symbol("moved")
        motion = {"velocity": s * moved, "speed": speed, "travel_rate": s * moved}
        value: sp.Expr = drive
        for stage in self.stages:
            if is_by_numbers(stage):
                value *= by_numbers(stage, s)
                continue
            signals = {**motion, "input": value, "period": sp.S(0)}
            equation = Controller((stage,)).equation(prefix, signals)
            states = sp.solve([s * x - r for x, r in equation.rates.items()], *equation.rates)
            value = equation.output.subs(states) if equation.rates else equation.output
        return sp.simplify(sp.diff(value, drive)), sp.simplify(sp.diff(value, moved))

    @property
    def sees_velocity(self) -> bool:
        """Whether a law of it that has a linear form takes the velocity itself, not its size."""
        velocities = SIGNALS["velocity"], SIGNALS["travel_rate"]
        for stage in self.stages:
            if is_by_numbers(stage) or not stage.law.linear:
                continue
            equation = Controller((stage,)).equation("law", {**SIGNALS, "period": sp.S(0)})
            if any(e.has(*velocities) for e in (equation.output, *equation.rates.values())):
                return True
        return False

    def __repr__(self) -> str:
        laws = (
            f"{g.name}({', '.join(f'{n} = {v:.5g}' for n, v in g.values.items())})"
            if len(g.values) < _MOST_SHOWN
            else f"{g.name}({len(g.values)} parameters)"
            for g in self.stages
        )
        return f"Controller {', then '.join(laws) or 'without a law'}"

    def _repr_html_(self) -> str:
        rows = [
            (f"{g.name}.{n}", f"{v:.5g}", g.law.parameters[n].meaning)
            for g in self.stages
            for n, v in g.values.items()
        ]
        return html_table("Controller", ("parameter", "value (SI)", "meaning"), rows)


def _placed(
    stage: Stage, prefix: str, signals: Mapping[str, sp.Expr]
) -> tuple[SimpleNamespace, SimpleNamespace]:
    """The signals and states that the law reads, and its parameters, as symbols of that block."""
    law = stage.law
    states = {s: state_symbol(prefix, stage.name, s) for s in law.states}
    values = {n: parameter_symbol(prefix, f"{stage.name}.{n}") for n in law.parameters}
    return SimpleNamespace(**{**signals, **states}), SimpleNamespace(**values)


def parameter_symbol(prefix: str, name: str) -> sp.Symbol:
    """Symbol of parameter "law.parameter" (or "effect.parameter") of the block `prefix`."""
    return sp.Symbol(f"{prefix}_{name.replace('.', '_')}", real=True)


def state_symbol(prefix: str, law: str, state: str) -> sp.Symbol:
    """Symbol of a hidden state of the block `prefix`."""
    return sp.Symbol(f"{prefix}_{law}_{state}", real=True)
