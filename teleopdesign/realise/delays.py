"""Delayed signals of a law: the simulation reads each from its history, under a symbol.

On a grid a delay is whole steps or samples where possible, otherwise between two of them.
"""

from __future__ import annotations

from collections.abc import Mapping

import sympy as sp

from ..base.errors import ModelError
from ..controllers import ControllerEquation
from ..effects import delayed

#: late signal -> what it was, and how much earlier
LateSignals = dict[sp.Symbol, tuple[sp.Expr, sp.Expr]]


def without_delays(
    equation: ControllerEquation, name: str, late: LateSignals
) -> ControllerEquation:
    """The equation with a symbol for each delayed signal; these signals are put into `late`."""

    def replaced(changes: Mapping[sp.Symbol, sp.Expr]) -> dict[sp.Symbol, sp.Expr]:
        return {x: replace_delays(name, change, late) for x, change in changes.items()}

    return ControllerEquation(
        replace_delays(name, equation.output, late),
        replaced(equation.rates),
        replaced(equation.steps),
        equation.before,
    )


def replace_delays(name: str, expression: sp.Expr, late: LateSignals) -> sp.Expr:
    """The expression with a symbol for each delayed(x, tau), which is put into `late`."""
    while calls := expression.atoms(delayed):
        innermost = (c for c in calls if not any(x.has(delayed) for x in c.args))
        for call in sorted(innermost, key=str):
            symbol = sp.Symbol(f"{name}_late_{len(late)}", real=True)
            symbol = {c: s for s, c in late.items()}.get(call.args, symbol)
            late[symbol] = call.args
            expression = expression.xreplace({call: symbol})
    return expression


#: distance of a delay from a whole number of steps or samples that is rounding of the division
_WHOLE = 1e-9


def is_whole(count: float) -> bool:
    """Whether a delay of `count` steps or samples is whole, except for rounding."""
    return abs(count - round(count)) <= _WHOLE * max(count, 1.0)


def delay_in_samples(delay: float, period: float, *, what: str) -> float:
    """The delay of a computer's signal in samples, at least one.

    delay, period: s;  what: first words of the error
    raises ModelError: the delay is below the period
    """
    count = delay / period
    if is_whole(count) and round(count) >= 1:
        return float(round(count))
    if count < 1:
        raise ModelError(
            f"{what}: a delay of {delay * 1e3:g} ms is below the computer's period of "
            f"{period * 1e3:g} ms: make the block analog, or the period shorter"
        )
    return count
