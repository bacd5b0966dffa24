"""Check of the declarations of a control law, on which claims and linear forms depend.

The check is symbolic; whether a law is linear, only a dead time, a smoothed level, a bristle or a
low-pass. The largest force of a law (`bound`) is a matter of intervals and is not checked here.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import sympy as sp

from ..effects import delayed, is_linear
from ._controller import Controller, ControllerEquation, parameter_symbol
from ._law import SIGNALS, ControlLaw, Stage

_S = sp.Symbol("s")


@lru_cache(maxsize=64)
def broken_declarations(law: ControlLaw) -> tuple[str, ...]:
    """Declarations that are wrong for a law in continuous time, in words; () if there are none."""
    if law.system is not None or law.response is not None or law.shift is not None:
        return ()  # no law that is written down: claims leave these out
    stage, made = _as_written(law, sp.S(0))
    symbols = {n: parameter_symbol("law", f"{stage.name}.{n}") for n in law.parameters}
    checks = {
        "dead_time, but its output is not its input of that time earlier": (
            bool(law.dead_time) and made.output != _delay_factor(law, symbols)
        ),
        "linear = True, but is not linear in its input, velocity and states": (
            law.linear and not _keeps_linear(made)
        ),
        "a transfer function, but its states have another one": (
            law.transfer is not None and not law.dead_time and not _keeps_transfer(stage, made)
        ),
        "smoothing, but is not bound v/(smoothing + abs(v))": (
            bool(law.smoothing) and not _keeps_smoothing(law, made.output, symbols)
        ),
        "bristle_stiffness, but its law is not that of `dahl`": (
            bool(law.bristle_stiffness) and not _keeps_bristle(law, made, symbols)
        ),
        "filter_bandwidth, but is no low-pass of first order": (
            bool(law.filter_bandwidth) and not _keeps_bandwidth(law, made, symbols)
        ),
    }
    return tuple(words for words, is_broken in checks.items() if is_broken)


def unknown_symbols(law: ControlLaw) -> list[sp.Symbol]:
    """Symbols in the output and the rates of a law that are no signal, state or parameter of it."""
    if law.system is not None or law.response is not None:
        return []  # no law that is written down
    stage, made = _as_written(law, SIGNALS["period"])
    names = (parameter_symbol("law", f"{stage.name}.{n}") for n in law.parameters)
    known = {*SIGNALS.values(), *made.rates, *names}
    used = set[sp.Symbol]().union(*(e.free_symbols for e in (made.output, *made.rates.values())))
    return sorted(used - known, key=str)


def _as_written(law: ControlLaw, period: sp.Expr) -> tuple[Stage, ControllerEquation]:
    """A stage of the law with any values, and its equations in the block "law"."""
    values = {n: p.lower if p.lower > 0 else 1.0 for n, p in law.parameters.items()}
    stage = Stage(law, values)
    return stage, Controller((stage,)).equation("law", {**SIGNALS, "period": period})


def _delay_factor(law: ControlLaw, symbols: Mapping[str, sp.Symbol]) -> sp.Expr:
    return delayed(SIGNALS["input"], symbols[law.dead_time])


def _keeps_linear(made: ControllerEquation) -> bool:
    driving = [SIGNALS[n] for n in ("input", "velocity", "travel_rate")]
    return is_linear((made.output, *made.rates.values()), [*driving, *made.rates])


def _keeps_transfer(stage: Stage, made: ControllerEquation) -> bool:
    """Whether the stated transfer function, from the input alone, holds at the stage's values."""
    assert stage.law.transfer is not None
    numbers = {parameter_symbol("law", f"{stage.name}.{n}"): v for n, v in stage.values.items()}
    states = sp.solve([_S * x - rate for x, rate in made.rates.items()], *made.rates)
    output = made.output.subs(states if made.rates else {})
    stated = stage.law.transfer(stage.values, _S) * SIGNALS["input"]
    return _is_zero(sp.nsimplify((output - stated).subs(numbers)))


def _keeps_smoothing(law: ControlLaw, output: sp.Expr, symbols: Mapping[str, sp.Symbol]) -> bool:
    if not law.bound:
        return False
    v = SIGNALS["velocity"]
    shape = symbols[law.bound] * v / (symbols[law.smoothing] + sp.Abs(v))
    return _is_zero(output.subs(SIGNALS["speed"], sp.Abs(v)) - shape)


def _keeps_bristle(
    law: ControlLaw, made: ControllerEquation, symbols: Mapping[str, sp.Symbol]
) -> bool:
    if len(made.rates) != 1 or not law.bound:
        return False
    ((z, rate),), moved = made.rates.items(), SIGNALS["travel_rate"]
    stiffness, level = symbols[law.bristle_stiffness], symbols[law.bound]
    bent = moved - stiffness / level * sp.Abs(moved) * z
    return _is_zero(made.output - stiffness * z) and _is_zero(rate - bent)


def _keeps_bandwidth(
    law: ControlLaw, made: ControllerEquation, symbols: Mapping[str, sp.Symbol]
) -> bool:
    if list(made.rates) != [made.output]:
        return False
    corner = 2 * sp.pi * symbols[law.filter_bandwidth]
    return _is_zero(made.rates[made.output] - corner * (SIGNALS["input"] - made.output))


def _is_zero(expression: sp.Expr) -> bool:
    return bool(expression == 0 or sp.simplify(expression) == 0)
