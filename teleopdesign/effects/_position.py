"""Whether a law depends on position or time, and whether it is periodic in position."""

from __future__ import annotations

from functools import lru_cache

import sympy as sp

from ._effect import SIGNALS, Effect

#: points at which two laws are compared: laws that agree at all of them are the same
_POINTS = (
    (sp.Rational(3, 7), sp.Rational(11, 13)),
    (sp.Rational(-17, 19), sp.Rational(5, 23)),
    (sp.Rational(29, 31), sp.Rational(-2, 37)),
)
#: relative difference of two values of one law that is rounding (30 digits are computed)
_SAME = sp.Float("1e-20")


@lru_cache(maxsize=256)
def depends_on_position(effect: Effect) -> bool:
    """Whether the effect changes if the position and all hidden positions are moved together."""
    return not _is_same_at(effect, sp.Rational(41, 43))


def depends_on_time(effect: Effect) -> bool:
    """Whether an effect depends on time itself, so that it may describe an external tone."""
    return bool(effect.expression().has(SIGNALS["time"]))


@lru_cache(maxsize=256)
def period(effect: Effect) -> str | float | None:
    """The period of an effect in position: name of a parameter, one turn (rad), or None: no period.

    None also for an effect that does not depend on position.
    """
    if not depends_on_position(effect):
        return None
    lengths = [n for n, p in effect.parameters.items() if p.quantity == "position"]
    offsets: list[tuple[str | float, sp.Expr]] = [(n, effect.symbols()[n]) for n in lengths]
    offsets.append((float(2 * sp.pi), 2 * sp.pi))
    return next((name for name, offset in offsets if _is_same_at(effect, offset)), None)


def _is_same_at(effect: Effect, offset: sp.Expr) -> bool:
    """Whether the effect is unchanged if its position and hidden positions move by `offset`."""
    moved = {SIGNALS["position"]: SIGNALS["position"] + offset}
    for name, symbol in effect.state_symbols().items():
        if effect.states[name].start == "position":
            moved[symbol] = symbol + offset
    laws = (effect.expression(), *effect.rates().values())
    return all(_is_same(law, law.xreplace(moved)) for law in laws)


def _is_same(one: sp.Expr, other: sp.Expr) -> bool:
    if one == other:
        return True
    symbols = sorted(one.free_symbols | other.free_symbols, key=str)
    for first, step in _POINTS:
        # parameters may be bounded from below by zero: all points but signals' are positive
        values = {
            s: (first if s in SIGNALS.values() else abs(first)) + step * (k + 1) ** 2 / 97
            for k, s in enumerate(symbols)
        }
        a, b = (_value_at(law, values) for law in (one, other))
        if a != b and not (
            (a - b).is_number and abs(sp.N(a - b, 30)) <= _SAME * (1 + abs(sp.N(a, 30)))
        ):
            return False
    return True


def _value_at(law: sp.Expr, values: dict[sp.Symbol, sp.Rational]) -> sp.Expr:
    """The law with numbers in place of all symbols, to 30 digits.

    First as inexact numbers: in exact ones, sympy would look for the exact sine of each angle.
    """
    return sp.N(law.evalf(30, subs=values).xreplace(values), 30)
