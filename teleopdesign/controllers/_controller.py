"""A controller: control laws in series, composed into one equation, and their linear form."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from types import SimpleNamespace

import sympy as sp

from ..base.arguments import check_types
from ..base.errors import ModelError, did_you_mean
from ..base.frozen import Frozen
from ..base.shown import html_table
from ._exact import has_numbers, insert_values, is_by_numbers
from ._law import SIGNALS, Ability, ControlLaw, ControllerState, Stage, mark_sampled_rate

#: names that the file of a law may import, those of `_law` included
__all__ = [
    "SIGNALS",
    "Ability",
    "ControlLaw",
    "Controller",
    "ControllerEquation",
    "ControllerState",
    "Stage",
    "mark_sampled_rate",
    "parameter_symbol",
    "state_symbol",
]

_MOST_SHOWN = 8  # most parameters of a law in one line


@dataclass(frozen=True)
class ControllerEquation:
    """Output and states of a controller in a named block, as functions of its input signals.

    rates: state -> rate;  steps: state -> value at the next sample, for laws that state it
    before: states that are updated at a sample before the output is computed
    """

    output: sp.Expr
    rates: Mapping[sp.Symbol, sp.Expr]
    steps: Mapping[sp.Symbol, sp.Expr]
    before: frozenset[sp.Symbol]


@check_types
@dataclass(frozen=True, repr=False)
class Controller:
    """One or more control laws in series; the first one receives the input.

    A law that occurs twice is numbered, as in "low_pass.bandwidth" and "low_pass_2.bandwidth".
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

    @check_types
    def then(self, other: Controller) -> Controller:
        """This controller followed by another one."""
        return Controller((*self.stages, *other.stages))

    @property
    def dead_time(self) -> float | None:
        """Delay (s) of a controller that does nothing else; None for any other."""
        times = [stage.value_of("dead_time") for stage in self.stages]
        known = [t for t in times if t is not None]
        return sum(known) if known and len(known) == len(times) else None

    @property
    def reads_command(self) -> bool:
        """Whether a law reads the force that is commanded without this controller."""
        return any(stage.law.reads_command for stage in self.stages)

    def names(self) -> dict[str, float]:
        """Every parameter as "law.parameter" -> value (SI)."""
        return {f"{g.name}.{n}": float(v) for g in self.stages for n, v in g.values.items()}

    @check_types
    def with_values(self, values: Mapping[str, float]) -> Controller:
        """The controller with other parameter values (SI), by names such as "dahl.level".

        raises ModelError: no parameter of that name
        """
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
        """The controller as a computer with this period (s) realises it.

        Laws that declare a sampled form change: `virtual_admittance`, and continuous systems of
        python-control. The simulation steps all other laws with their inputs held over a period.
        """
        stages = (
            g if g.law.sampled is None else replace(g.law.sampled(g.values, period), name=g.name)
            for g in self.stages
        )
        return Controller(tuple(stages))

    def equation(
        self,
        prefix: str,
        signals: Mapping[str, sp.Expr],
        *,
        others: tuple[sp.Expr, ...] = (),
        code: bool = False,
    ) -> ControllerEquation:
        """The laws composed in series; prefix: name of the block, for its symbols.

        signals: those of `SIGNALS`; a `period` of 0 means continuous time
        others: further signals, read by a law that is only code
        code: whether systems that are only code take part, as calls of their functions
        raises ModelError: a measured response; a system that is only code, without `code`;
            continuous time with a state that exists only in a computer
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
            now, p = _make_symbols(stage, prefix, {**signals, "input": value})
            now.others = others
            probe = SimpleNamespace(**{**vars(now), "travel_rate": SIGNALS["travel_rate"]})
            for name, state in law.states.items():
                symbol, in_computer = getattr(now, name), signals["period"] != 0
                if state.step is not None and in_computer:
                    change, changes = state.step, steps
                else:
                    change, changes = state.rate, rates
                if change is mark_sampled_rate:
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
        """Transfer function at constant speed; None if a law declares no linear form.

        The velocity is that of the input; for the velocity of another motion, see `linear_parts`.

        held: also for measured responses, and for laws in discrete time, from the samples to the
            mean of the held output, as H(e^(s T)) (1 - e^(-s T))/(s T), without copies at other
            multiples of the sampling rate
        """
        if not self._is_linear(held):
            return None
        return _linear_form(self._forms(), prefix, s, speed)

    def linear_parts(
        self, prefix: str, s: sp.Symbol, speed: sp.Expr, *, held: bool = False
    ) -> tuple[sp.Expr, sp.Expr] | None:
        """Transfer functions from the input, and from the position along whose velocity it acts.

        Arguments are those of `linear_form`, which returns the sum of both, for a single signal.
        """
        if not self._is_linear(held):
            return None
        return _linear_parts(self._forms(), prefix, s, speed)

    def _is_linear(self, held: bool) -> bool:
        """Whether every law has a linear form; held: as in `linear_form`."""
        return all(stage.law.linear or (held and has_numbers(stage)) for stage in self.stages)

    def _forms(self) -> tuple[_Form, ...]:
        return tuple(
            _Form(g.law, g.name, g.values if is_by_numbers(g) else None, g) for g in self.stages
        )

    @property
    def sees_velocity(self) -> bool:
        """Whether a law with a linear form uses the velocity itself, not only its magnitude."""
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


@dataclass(frozen=True)
class _Form:
    """A stage, equal to every stage of the same linear form: its values are symbols there.

    numbers: values of a law whose transfer function holds them as numbers; None: any values
    """

    law: ControlLaw
    name: str
    numbers: Mapping[str, float] | None
    stage: Stage = field(compare=False)


@lru_cache(maxsize=512)
def _linear_form(forms: tuple[_Form, ...], prefix: str, s: sp.Symbol, speed: sp.Expr) -> sp.Expr:
    """As `Controller.linear_form`, derived once: a claim asks for it some hundred times."""
    from_input, from_motion = _linear_parts(forms, prefix, s, speed)
    return from_input if from_motion == 0 else sp.simplify(from_input + from_motion)


@lru_cache(maxsize=512)
def _linear_parts(
    forms: tuple[_Form, ...], prefix: str, s: sp.Symbol, speed: sp.Expr
) -> tuple[sp.Expr, sp.Expr]:
    """As `Controller.linear_parts`, derived once."""
    stages = [form.stage for form in forms]
    if all(is_by_numbers(stage) for stage in stages):
        return sp.Mul(*(insert_values(stage, s) for stage in stages)), sp.S(0)
    drive, moved = sp.Symbol("drive"), sp.Symbol("moved")
    motion = {"velocity": s * moved, "speed": speed, "travel_rate": s * moved}
    value: sp.Expr = drive
    for stage in stages:
        if is_by_numbers(stage):
            value *= insert_values(stage, s)
            continue
        signals = {**motion, "input": value, "period": sp.S(0)}
        equation = Controller((stage,)).equation(prefix, signals)
        states = sp.solve([s * x - r for x, r in equation.rates.items()], *equation.rates)
        value = equation.output.subs(states) if equation.rates else equation.output
    return sp.simplify(sp.diff(value, drive)), sp.simplify(sp.diff(value, moved))


def _make_symbols(
    stage: Stage, prefix: str, signals: Mapping[str, sp.Expr]
) -> tuple[SimpleNamespace, SimpleNamespace]:
    """Signals and states that the law reads, and its parameters, as symbols of the block."""
    law = stage.law
    states = {s: state_symbol(prefix, stage.name, s) for s in law.states}
    values = {n: parameter_symbol(prefix, f"{stage.name}.{n}") for n in law.parameters}
    return SimpleNamespace(**{**signals, **states}), SimpleNamespace(**values)


def parameter_symbol(prefix: str, name: str) -> sp.Symbol:
    """Symbol of the parameter "law.parameter" (or "effect.parameter") of the block `prefix`."""
    return sp.Symbol(f"{prefix}_{name.replace('.', '_')}", real=True)


def state_symbol(prefix: str, law: str, state: str) -> sp.Symbol:
    """Symbol of a hidden state of the block `prefix`."""
    return sp.Symbol(f"{prefix}_{law}_{state}", real=True)
