"""Whether laws are linear, as an effect or a control law may declare for its linear form."""

from __future__ import annotations

from collections.abc import Iterable

import sympy as sp

from ._effect import Effect
from ._signals import SIGNALS, delayed

#: signals of a body on which a linear effect may depend; a structure also depends on the tip force
_DRIVING = ("position", "velocity", "acceleration", "command")


def is_linear(laws: Iterable[sp.Expr], signals: Iterable[sp.Symbol]) -> bool:
    """Whether every law is a sum of the signals, each times a constant.

    signals: the variables; all other symbols are constants
    A law with a size, Max or Min of them counts as not linear: a spline takes sympy minutes.
    """
    signals = list(signals)
    for law in laws:
        if any(part.has(*signals) for part in law.atoms(sp.Abs, sp.Max, sp.Min) if signals):
            return False
        if any(late.args[1].has(*signals) for late in law.atoms(delayed) if signals):
            return False
        plain = law.replace(delayed, lambda signal, _: signal)  # late by a constant is linear, too
        slopes = [_simplify_fraction(sp.diff(plain, x)) for x in signals]
        if any(slope.has(*signals) for slope in slopes if signals):
            return False
        rest = plain - sp.Add(*(a * x for a, x in zip(slopes, signals, strict=True)))
        if _simplify_fraction(rest) != 0:
            return False
    return True


def acts_linearly(effect: Effect) -> bool:
    """Whether laws and rates are linear in the body's motion, its command and the states.

    Parameters are constants. An effect file may state `linear` only where this holds.
    """
    driving = [SIGNALS[n] for n in _DRIVING]
    driving += [SIGNALS["interaction_force"]] * (effect.role == "structure")
    laws = (effect.expression(), *effect.rates().values())
    states = effect.state_symbols().values()
    known = {*driving, *states, *effect.symbols().values()}
    if any(law.free_symbols - known for law in laws):
        return False
    return is_linear(laws, [*driving, *states])


def _simplify_fraction(expression: sp.Expr) -> sp.Expr:
    return expression if not expression.args else sp.simplify(expression)
