"""What a control law is: one law, written once with sympy, in a file of its own.

A law sees `now.input` (the signal wired to the block), the motion that it acts along (`velocity`,
`speed` = abs(velocity), `travel_rate`) and its hidden states. `speed` is apart from `velocity` so
that the linear form can freeze it; `travel_rate` is the travel of the last sample over its
duration, velocity itself in continuous time. Every form of the law (transfer function,
python-control system, sampled step of the kernel) is derived from it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType, SimpleNamespace
from typing import Any

import sympy as sp

from ..effects import Parameter, State
from ..errors import ModelError, did_you_mean

SIGNALS = {
    name: sp.Symbol(name, real=True) for name in ("input", "velocity", "speed", "travel_rate")
}


@dataclass(frozen=True)
class ControlLaw:
    """A control law: law(now, p) is its output; see the package's folder for examples.

    linear: declares that, at frozen `speed`, the law is linear in its input and in velocity;
    False: the LTI form leaves the block out, and says so.
    States whose rate uses `travel_rate` are brought up to a sample before its output is taken,
    all others are carried from it to the next with their inputs held. Rates are affine in their
    own state, so both steps are exact.
    """

    law: Callable[[Any, Any], sp.Expr]
    parameters: Mapping[str, Parameter]
    states: Mapping[str, State] = field(default_factory=dict)
    linear: bool = False
    source: str = ""
    name: str = ""
    text: str = ""

    def named(self, name: str, text: str) -> ControlLaw:
        """The law under the name of its file, with the file's docstring as its text."""
        return replace(self, name=name, text=text)


@dataclass(frozen=True)
class Stage:
    """A control law with a value (SI) for every parameter."""

    law: ControlLaw
    values: Mapping[str, float]

    def __post_init__(self) -> None:
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
            if not parameter.lower <= self.values[name] <= parameter.upper:
                raise ModelError(
                    f"{law.name}: {name} = {self.values[name]:g} is outside "
                    f"{parameter.lower:g} .. {parameter.upper:g}"
                )
        object.__setattr__(self, "values", MappingProxyType(dict(self.values)))


@dataclass(frozen=True)
class ControllerEquation:
    """Output and rates of a controller placed under a name, on the signals given to it."""

    output: sp.Expr
    rates: Mapping[sp.Symbol, sp.Expr]
    before: frozenset[sp.Symbol]


@dataclass(frozen=True)
class Controller:
    """One or more control laws in series, the first one next to the input."""

    stages: tuple[Stage, ...]

    def __post_init__(self) -> None:
        names = [stage.law.name for stage in self.stages]
        if doubled := {n for n in names if names.count(n) > 1}:
            raise ModelError(f'controller: law "{min(doubled)}" is there twice')

    def then(self, other: Controller) -> Controller:
        """This controller with another one behind it."""
        return Controller((*self.stages, *other.stages))

    def names(self) -> dict[str, float]:
        """Every parameter as "law.parameter" -> value (SI)."""
        return {f"{g.law.name}.{n}": float(v) for g in self.stages for n, v in g.values.items()}

    def with_values(self, values: Mapping[str, float]) -> Controller:
        """The controller with other parameter values, by "law.parameter"."""
        known = self.names()
        for name in values:
            if name not in known:
                raise ModelError(f'controller: no parameter "{name}"{did_you_mean(name, known)}')
        known |= values
        return Controller(
            tuple(
                replace(g, values={n: known[f"{g.law.name}.{n}"] for n in g.values})
                for g in self.stages
            )
        )

    def equation(self, prefix: str, signals: Mapping[str, sp.Expr]) -> ControllerEquation:
        """The laws composed in series; prefix: name of the block, in its symbols."""
        value, rates, before = signals["input"], {}, set()
        for stage in self.stages:
            law = stage.law
            own = {s: state_symbol(prefix, law.name, s) for s in law.states}
            now = SimpleNamespace(**{**signals, "input": value, **own})
            p = SimpleNamespace(
                **{n: parameter_symbol(prefix, f"{law.name}.{n}") for n in law.parameters}
            )
            for name, state in law.states.items():
                rates[own[name]] = sp.sympify(state.rate(now, p))
                probe = SimpleNamespace(**{**vars(now), "travel_rate": SIGNALS["travel_rate"]})
                if sp.sympify(state.rate(probe, p)).has(SIGNALS["travel_rate"]):
                    before.add(own[name])
            value = sp.sympify(law.law(now, p))
        return ControllerEquation(value, MappingProxyType(rates), frozenset(before))

    def linear_form(self, prefix: str, s: sp.Symbol, speed: sp.Expr) -> sp.Expr | None:
        """Transfer function at frozen speed; None where a law declares no linear form."""
        if not all(stage.law.linear for stage in self.stages):
            return None
        drive = sp.Symbol("drive")
        signals = {"input": drive, "velocity": s * drive, "speed": speed, "travel_rate": s * drive}
        equation = self.equation(prefix, signals)
        settled = sp.solve([s * x - rate for x, rate in equation.rates.items()], *equation.rates)
        output = equation.output.subs(settled) if equation.rates else equation.output
        return sp.simplify(output / drive)


def parameter_symbol(prefix: str, name: str) -> sp.Symbol:
    """Symbol of parameter "law.parameter" (or "effect.parameter") of the block `prefix`."""
    return sp.Symbol(f"{prefix}_{name.replace('.', '_')}", real=True)


def state_symbol(prefix: str, law: str, state: str) -> sp.Symbol:
    """Symbol of a hidden state of the block `prefix`."""
    return sp.Symbol(f"{prefix}_{law}_{state}", real=True)
