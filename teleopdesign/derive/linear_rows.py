"""Laws and effects as rows of coefficients, and symbols for dead times."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache, reduce

import sympy as sp

from ..controllers import SIGNALS, ControlLaw, Controller, Stage
from ..effects import Effect, delayed
from ..realise.lti import S

#: e^(-s T) of a dead time T, before the dead times are known as numbers
LATE = sp.Function("late")
DRIVE, MOVED, SPEED = sp.symbols("drive moved frozen_speed")

#: a dead time is a power of one symbol up to this exponent, else a symbol of its own
_MOST_POWERS = 100


def late_symbols(
    delays: Iterable[sp.Expr],
) -> tuple[dict[sp.Symbol, sp.Expr], dict[sp.Expr, sp.Expr]]:
    """Symbols of e^(-s T) with their dead times, and e^(-s T) of each delay in these symbols.

    Dead times that are small multiples of one time are powers of one symbol, because their phases
    go together.
    delays: numbers, or symbols of values
    """
    times: dict[sp.Symbol, sp.Expr] = {}
    powers: dict[sp.Expr, sp.Expr] = {}
    fixed = sorted({t for t in delays if t.is_Rational})
    base = reduce(sp.gcd, fixed) if fixed else sp.S(1)
    if fixed and fixed[-1] / base <= _MOST_POWERS:
        times[mark := sp.Dummy("late")] = base
        powers |= {t: mark ** (t / base) for t in fixed}
    for t in delays:
        if t not in powers:
            times[mark := sp.Dummy(f"late_{len(times)}")] = t
            powers[t] = mark
    return times, powers


@dataclass(frozen=True)
class OfLaw:
    """A stage, equal to every stage of the same law: its values are symbols in the rows."""

    law: ControlLaw
    stage: Stage = field(compare=False)


_Rows = tuple[tuple[str, ...], tuple[tuple[sp.Expr, ...], ...], tuple[sp.Expr, ...]]


@lru_cache(maxsize=512)
def rows_of_law(of: OfLaw) -> _Rows:
    """States of a law; for the rate of each, and for the output, coefficients in continuous time.

    Coefficients are those of the states, of the input and of the motion.
    """
    velocity = S * MOVED
    signals = {"input": DRIVE, "velocity": velocity, "speed": SPEED, "travel_rate": velocity}
    alone = Controller((replace(of.stage, name="law"),))
    made = alone.equation("law", {**SIGNALS, **signals, "period": sp.S(0)})
    unknown = (*made.rates, DRIVE, MOVED)
    names = tuple(x.name.removeprefix("law_law_") for x in made.rates)
    return names, tuple(_row(e, unknown) for e in made.rates.values()), _row(made.output, unknown)


@lru_cache(maxsize=512)
def rows_of_effect(effect: Effect) -> _Rows:
    """As `rows_of_law`, for an effect: its input is the command, or the position of the body."""
    motion = {"position": MOVED, "velocity": S * MOVED, "acceleration": S**2 * MOVED}
    signals = {**motion, "command": DRIVE, "interaction_force": sp.S(0)}
    rates, output = effect.rates(signals, {}), effect.expression(signals, {})
    states = effect.state_symbols()
    unknown = (*(states[n] for n in rates), DRIVE, MOVED)
    return tuple(rates), tuple(_row(e, unknown) for e in rates.values()), _row(output, unknown)


def _row(expression: sp.Expr, unknown: Sequence[sp.Symbol]) -> tuple[sp.Expr, ...]:
    """Coefficients of the unknowns in an expression that is linear in them."""
    placed = expression.replace(delayed, lambda signal, time: signal * LATE(time))
    return tuple(sp.diff(placed, x) for x in unknown)
