"""Properties that follow from the laws of an effect, computed once for each effect."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import sympy as sp

from ..base.recipes import remember
from ._signals import FURTHER, SIGNALS, delayed

if TYPE_CHECKING:
    from ._effect import Effect


@lru_cache(maxsize=256)
def channels(effect: Effect) -> frozenset[str]:
    """Additional channels of a record that the laws need."""
    laws = (effect.expression(), *effect.rates().values())
    used = {n for n in FURTHER if any(law.has(SIGNALS[n]) for law in laws)}
    return frozenset(FURTHER[n] for n in used)


@lru_cache(maxsize=256)
def strength(effect: Effect) -> str | None:
    """The parameter that the law is linear in, and that is zero at absence; None: there is none."""
    if len(effect.absent) != 1 or effect.states:
        return None
    ((name, value),) = effect.absent.items()
    if value != 0.0:
        return None
    symbol = effect.symbols()[name]
    slope = sp.diff(effect.expression(), symbol)
    # most slopes show it, and the fit needs them anyway; a second derivative is simplified too
    linear = symbol not in slope.free_symbols or sp.diff(slope, symbol) == 0
    return name if linear else None


@lru_cache(maxsize=256)
def phase(effect: Effect) -> str | None:
    """Name of the angle phi in a law strength * sin(... + phi); None for other laws."""
    angles = [n for n, p in effect.parameters.items() if p.quantity == "angle"]
    if effect.strength is None or len(angles) != 1:
        return None
    wave = sp.diff(effect.expression(), effect.symbols()[effect.strength])
    turned = sp.diff(wave, effect.symbols()[angles[0]], 2)
    return angles[0] if sp.simplify(wave + turned) == 0 else None


@lru_cache(maxsize=256)
def led_momentum(effect: Effect) -> sp.Expr:
    """Momentum of the body that corrections of hidden states move; 0 without corrections."""
    if effect.led is None:
        return sp.S(0)
    led = effect.led(SimpleNamespace(**effect.symbols()))
    return led * sum(effect.corrections().values(), sp.S(0))


@lru_cache(maxsize=64)
def fix_at_zero(effect: Effect, parameter: str) -> Effect:
    """The effect with an optional parameter set to zero in all its laws."""

    def at_zero(law: Callable[[Any, Any], sp.Expr]) -> Callable[[Any, Any], sp.Expr]:
        return lambda now, p: law(now, SimpleNamespace(**{**vars(p), parameter: sp.S(0)}))

    def if_any(law: Callable[[Any, Any], sp.Expr] | None) -> Callable[[Any, Any], sp.Expr] | None:
        return None if law is None else at_zero(law)

    less = replace(
        effect,
        law=at_zero(effect.law),
        coupling=if_any(effect.coupling),
        states={
            n: replace(
                s,
                rate=at_zero(s.rate),
                correction=if_any(s.correction),
                dry=if_any(s.dry),
                stop=if_any(s.stop),
            )
            for n, s in effect.states.items()
        },
        parameters={n: p for n, p in effect.parameters.items() if n != parameter},
    )
    return remember(less, fix_at_zero, effect, parameter)


def linear_form(effect: Effect, s: sp.Symbol, values: Mapping[str, Any] | None) -> sp.Expr:
    """The law in the Laplace variable s, per position or per command, with states eliminated."""
    drive = sp.Symbol("drive")
    signals = dict(position=drive, velocity=s * drive, acceleration=s**2 * drive, command=drive)
    signals |= dict(interaction_force=sp.S(0))
    states = effect.state_symbols()
    law, rates = effect.expression(signals, values), effect.rates(signals, values)
    states_in_s = sp.solve([s * states[n] - rate for n, rate in rates.items()], *states.values())
    law = law.subs(states_in_s) if rates else law
    law = law.replace(delayed, lambda signal, delay: signal * sp.exp(-s * delay))
    form = law / drive
    # where the drive has cancelled, the form is simple; `simplify` would load the units of sympy
    return sp.simplify(form) if form.has(drive) else form
