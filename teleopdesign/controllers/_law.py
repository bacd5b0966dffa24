"""What a control law is: one law, written once with sympy, in a separate file.

A law sees `now.input` (the signal wired to the block), the motion that it acts along (`velocity`,
`speed` = abs(velocity), `travel_rate`), its hidden states and `now.period`, the duration of a
sample, 0 in continuous time. `speed` is apart from `velocity` so that the linear form can freeze
it; `travel_rate` is the travel of the last sample over its duration, velocity itself in continuous
time; `command` is the force commanded without this law, for laws that declare to read it. Every
form of the law (transfer function, python-control system, sampled step of the kernel) is derived
from it.

`store_input` and `zero_rate` serve laws that keep a value from one sample to the next.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal, get_args

import sympy as sp
from sympy import S

from ..base.arguments import check_types
from ..base.errors import ModelError, did_you_mean, unknown
from ..base.frozen import Frozen
from ..base.recipes import recipe
from ..effects import Parameter

#: a property that a law may declare, by its field of `ControlLaw`
Ability = Literal["bound", "bristle_stiffness", "smoothing", "filter_bandwidth", "dead_time"]


SIGNALS = {
    name: sp.Symbol(name, real=True)
    for name in ("input", "velocity", "speed", "travel_rate", "period", "command")
}


def mark_sampled_rate(now: Any, p: Any) -> sp.Expr:
    """Placeholder for the rate of a state that exists only in a computer."""
    return sp.nan


@check_types
@dataclass(frozen=True)
class ControllerState:
    """A hidden state of a control law, whose `now` also contains the states of the law.

    rate(now, p): rate of change, or `mark_sampled_rate`
    step(now, p): value at the next sample, `now.period` later; None: the exact step for the rate,
        which is affine in the state, with all other signals held
    """

    quantity: str
    rate: Callable[[Any, Any], sp.Expr]
    step: Callable[[Any, Any], sp.Expr] | None = None


@check_types
@dataclass(frozen=True, repr=False)
class ControlLaw:
    """A control law: law(now, p) is its output; see the package's folder for examples.

    linear: declares that, at constant `speed`, the law is linear in its input and in velocity;
        False: the LTI form leaves the block out and names it
    States whose rate or step uses `travel_rate` are updated at a sample before the output is
    computed; all others advance from one sample to the next with their inputs held.
    takes: "force" if the input must not be the motion itself; "": any input
    reads_command: whether the law uses `now.command`
    transfer(values, s): transfer function from the input, if the states do not determine it
    shift(values, z): transfer function in z of a law that exists only in a computer, stepped each
        `period` (a parameter of the law, s); its output is held in between. A law that is linear,
        or has no such parameter, has no form in z
    sampled(values, period): the stage that replaces this one in a computer of that period (s);
        None: this stage, with the steps of its states
    system: a python-control system that the law calls; it is only code and has no equation
    response: a sympy function of s in place of a law, known on the axis at measured frequencies
    Abilities of the law, each as the name of the parameter with its value; "": none.
    bound: the force never exceeds this value, for any motion
    bristle_stiffness: the force is that of a Dahl bristle of this stiffness, with level `bound`
    smoothing: the force is bound v/(a + abs(v)) with this a
    filter_bandwidth: the output follows the input through a first-order low-pass
    dead_time: the output is the input, delayed by this time
    raises ModelError: an ability names no parameter
    """

    law: Callable[[Any, Any], sp.Expr]
    parameters: Mapping[str, Parameter]
    states: Mapping[str, ControllerState] = field(default_factory=dict)
    linear: bool = False
    takes: Literal["", "force"] = ""
    reads_command: bool = False
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
        if hidden := set(self.states) & {"input", "command", "period"}:
            name = self.name or "control law"
            raise ModelError(f"{name}: state {min(hidden)} has the name of a signal of laws")
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

    @property
    def in_z(self) -> Callable[[Mapping[str, float], sp.Symbol], sp.Expr] | None:
        """The transfer function in z of a law that exists only in a computer; None for others."""
        return None if self.linear or "period" not in self.parameters else self.shift

    def named(self, name: str, text: str) -> ControlLaw:
        """The law under the name of its file, with the file's docstring as its text."""
        return replace(self, name=name, text=text)


@check_types
@dataclass(frozen=True)
class Stage:
    """A control law with a value (SI) for every parameter.

    name: used in the names of its parameters; that of its law, numbered if a controller has it
        twice
    free: parameters that a comparison with a record estimates; all others are as programmed
    raises ModelError: a value is missing, unknown, infinite or out of bounds
    """

    law: ControlLaw
    values: Mapping[str, float]
    name: str = ""
    free: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not self.name:
            object.__setattr__(self, "name", self.law.name)
        law, declared = self.law, self.law.parameters
        for name in (*self.values, *self.free):
            if name not in declared:
                raise ModelError(f"{law.name}: {unknown('parameter', name, declared)}")
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
        """Value (SI) of the parameter that the law declares for an ability; None without it."""
        parameter = getattr(self.law, ability)
        return float(self.values[parameter]) if parameter else None


def store_input(now, p):
    """The input, for the next sample."""
    return now.input


def zero_rate(now, p):
    """Rate 0: in continuous time there is no last sample."""
    return S.Zero
