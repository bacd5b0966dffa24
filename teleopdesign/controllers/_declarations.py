"""What a control law declares, held against its equations, on which claims and forms depend.

The checks are symbolic: whether a law is linear, only a dead time, a smoothed level, a bristle or a
low-pass. A stated transfer function, in s or in z, is checked at the values of a stage. The largest
force of a law (`bound`) is a matter of intervals: see `passivity.declarations`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import lru_cache
from importlib import import_module

import sympy as sp

from ..base.errors import ModelError
from ..effects import delayed, is_linear
from ._controller import Controller, ControllerEquation, parameter_symbol
from ._exact import exact_decimal
from ._law import SIGNALS, Ability, ControlLaw, Stage
from ._state_space import is_of_matrices

_S = sp.Symbol("s")
_Symbols = Mapping[str, sp.Symbol]
#: period of the law as it is written for continuous time, and for a computer of any period
CONTINUOUS, SAMPLED = sp.S(0), SIGNALS["period"]


@lru_cache(maxsize=256)
def equation_of(law: ControlLaw, period: sp.Expr) -> ControllerEquation | None:
    """The equations of a law in the block "law", on the symbols of its signals and parameters.

    period: CONTINUOUS, SAMPLED, or a number, s
    returns: None for a law that is only code or measured, or has no form in continuous time
    """
    if law.system is not None or law.response is not None:
        return None
    stage = Stage(law, _any_values(law))
    try:
        return Controller((stage,)).equation("law", {**SIGNALS, "period": period})
    except ModelError:
        if period == 0:
            return None  # a state exists only in a computer
        raise


def symbols_of(law: ControlLaw) -> _Symbols:
    """Parameter -> its symbol in `equation_of`."""
    return {n: parameter_symbol("law", f"{law.name}.{n}") for n in law.parameters}


def _any_values(law: ControlLaw) -> dict[str, float]:
    return {n: p.lower if p.lower > 0 else min(1.0, p.upper) for n, p in law.parameters.items()}


@lru_cache(maxsize=256)
def has_shape(law: ControlLaw, ability: Ability, period: sp.Expr) -> bool:
    """Whether a law is that of the catalogue with this ability, for all parameters.

    period: CONTINUOUS, or SAMPLED: in a computer of any period
    """
    module = import_module(f".{_SHAPES[ability]}", __package__)
    model: ControlLaw = module.CONTROLLER.named(_SHAPES[ability], "")
    made, shape = equation_of(law, period), equation_of(model, period)
    if made is None or shape is None or made.steps or len(made.rates) != len(shape.rates):
        return False
    same: dict[sp.Symbol, sp.Expr] = dict(zip(shape.rates, made.rates, strict=True))
    for one in (ability, "bound"):
        if parameter := getattr(model, one):
            if not getattr(law, one):
                return False
            same[symbols_of(model)[parameter]] = symbols_of(law)[getattr(law, one)]
    speed = {SIGNALS["speed"]: sp.Abs(SIGNALS["velocity"])}
    of_model, of_law = ((x.output, *x.rates.values()) for x in (shape, made))
    pairs = zip(of_model, of_law, strict=True)
    return all(_is_zero(a.xreplace(same | speed) - b.xreplace(speed)) for a, b in pairs)


def broken_declarations(law: ControlLaw, stage: Stage | None = None) -> tuple[str, ...]:
    """Declarations of a law that its equations do not keep, in words; () if there are none.

    Shapes and linearity are those of continuous time.

    stage: with the values for which a stated transfer function is checked; None: some values
    """
    if law.system is not None or law.response is not None:
        return ()  # no law that is written down: claims leave these out
    if is_of_matrices(law):
        return ()
    stage = stage or Stage(law, _any_values(law))
    broken = [_WORDS[a] for a in _SHAPES if getattr(law, a) and not has_shape(law, a, CONTINUOUS)]
    if law.linear and not _acts_linearly(stage):
        broken.append("linear = True, but is not linear in its input, velocity and states")
    if law.transfer is not None and not _keeps_transfer(stage):
        broken.append("a transfer function, but its states have another one")
    if law.shift is not None and not _keeps_shift(stage):
        broken.append("shift, but its steps have another transfer function in z")
    return tuple(broken)


def require_kept(stages: Iterable[Stage]) -> None:
    """Refuse a law whose linear form would be one that it declares and does not have.

    raises ModelError: with the declaration that its equations do not keep at these values
    """
    for stage in stages:
        if broken := broken_declarations(stage.law, stage):
            raise ModelError(f"{stage.name}: at these values it declares {broken[0]}")


def require_exact_steps(stages: Iterable[Stage]) -> None:
    """Refuse a law whose rates have no exact step in a computer that holds its inputs.

    raises ModelError: with the state, whose rate must be affine in it and in no other rate's state
    """
    for stage in stages:
        made = equation_of(stage.law, SAMPLED)
        rates = {} if made is None else made.rates
        for z, rate in rates.items():
            others = rate.free_symbols & (rates.keys() - {z})
            if others or sp.diff(rate, z).has(z):
                why = "depends on other states" if others else "is not affine in it"
                raise ModelError(
                    f"{stage.name}: {z} has no exact step in a computer, for its rate {why}: give "
                    "its ControllerState a step, or a linear law by `from_control`"
                )


def unknown_symbols(law: ControlLaw) -> list[sp.Symbol]:
    """Symbols in the equations of a law that are no signal, state or parameter of it."""
    used: set[sp.Symbol] = set()
    known = {*SIGNALS.values(), *symbols_of(law).values()}
    for made in (equation_of(law, CONTINUOUS), equation_of(law, SAMPLED)):
        if made is None:
            continue
        known |= {*made.rates, *made.steps}
        laws = (made.output, *made.rates.values(), *made.steps.values())
        used = used.union(*(e.free_symbols for e in laws))
    return sorted(used - known, key=str)


@lru_cache(maxsize=256)
def _acts_linearly(stage: Stage) -> bool:
    """Whether a law is linear at all values, but for a constant that is zero at those of the stage.

    So is a force that counts from a reading of the position, where this reading is zero.
    """
    made, symbols = equation_of(stage.law, CONTINUOUS), symbols_of(stage.law)
    if made is None:
        return False
    driving = [*(SIGNALS[n] for n in ("input", "velocity", "travel_rate")), *made.rates]
    laws = (made.output, *made.rates.values())
    if is_linear(laws, driving):
        return True
    zero = {symbols[n]: sp.S(0) for n, value in stage.values.items() if value == 0}
    constants = [
        x.replace(delayed, lambda signal, _: signal).xreplace(dict.fromkeys(driving, sp.S(0)))
        for x in laws
    ]
    if any(constant.xreplace(zero) != 0 for constant in constants):
        return False
    return is_linear((x - c for x, c in zip(laws, constants, strict=True)), driving)


def _keeps_transfer(stage: Stage) -> bool:
    """Whether the stated transfer function, from the input alone, holds at the stage's values."""
    made, stated = equation_of(stage.law, CONTINUOUS), stage.law.transfer
    if made is None or stated is None:
        return False
    output = made.output.replace(delayed, lambda signal, time: signal * sp.exp(-_S * time))
    return _is_response(stage, output, made.rates, _S, stated(stage.values, _S))


def _keeps_shift(stage: Stage) -> bool:
    """Whether the stated transfer function in z is that of the steps at the stage's values."""
    z, stated = sp.Symbol("z"), stage.law.shift
    made = equation_of(stage.law, SAMPLED)
    if made is None or stated is None or made.rates or made.before:
        return False
    return _is_response(stage, made.output, made.steps, z, stated(stage.values, z))


def _is_response(
    stage: Stage,
    output: sp.Expr,
    changes: Mapping[sp.Symbol, sp.Expr],
    variable: sp.Symbol,
    stated: sp.Expr,
) -> bool:
    """Whether the output is `stated` times the input where `variable` times each state changes it.

    changes: state -> its rate, or its value at the next sample
    """
    symbols = symbols_of(stage.law)
    numbers = {symbols[n]: exact_decimal(v) for n, v in stage.values.items()}
    output, *after = (sp.sympify(e).subs(numbers) for e in (output, *changes.values()))
    rows = [variable * x - e for x, e in zip(changes, after, strict=True)]
    states = sp.solve(rows, *changes) if rows else {}
    if rows and not isinstance(states, dict):
        return False
    return _is_zero(output.subs(states) - sp.sympify(stated) * SIGNALS["input"])


#: ability -> the law of the catalogue that has it
_SHAPES: Mapping[Ability, str] = {
    "dead_time": "delay",
    "smoothing": "smoothed_coulomb",
    "bristle_stiffness": "dahl",
    "filter_bandwidth": "low_pass",
}
_WORDS: Mapping[Ability, str] = {
    "dead_time": "dead_time, but its output is not its input of that time earlier",
    "smoothing": "smoothing, but is not bound v/(smoothing + abs(v))",
    "bristle_stiffness": "bristle_stiffness, but its law is not that of `dahl`",
    "filter_bandwidth": "filter_bandwidth, but is no low-pass of first order",
}


def _is_zero(expression: sp.Expr) -> bool:
    return bool(expression == 0 or sp.simplify(expression) == 0)
