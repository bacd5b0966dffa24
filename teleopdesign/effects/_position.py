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
#: digits of the values, and relative difference of two values of one law that is rounding
_DIGITS, _SAME = 30, 1e-20


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
    hidden = effect.state_symbols().items()
    moving = [symbol for name, symbol in hidden if effect.states[name].start == "position"]
    laws = (effect.expression(), *effect.rates().values())
    return all(_is_unmoved(law, {SIGNALS["position"], *moving}, offset) for law in laws)


def _is_unmoved(law: sp.Expr, moving: set[sp.Symbol], offset: sp.Expr) -> bool:
    """Whether a law has the same values where these symbols are larger by an offset."""
    import mpmath  # of sympy

    if not law.free_symbols & moving:
        return True
    symbols = sorted(law.free_symbols | offset.free_symbols, key=str)
    value = sp.lambdify(symbols, law, "mpmath", cse=True)
    shift = sp.lambdify(symbols, offset, "mpmath")
    with mpmath.workdps(_DIGITS):
        for first, step in _POINTS:
            # parameters may be bounded from below by zero: all points but signals' are positive
            point = [
                (first if s in SIGNALS.values() else abs(first)) + step * (k + 1) ** 2 / 97
                for k, s in enumerate(symbols)
            ]
            here = [mpmath.mpf(x.p) / x.q for x in point]
            pairs = zip(symbols, here, strict=True)
            there = [x + shift(*here) if s in moving else x for s, x in pairs]
            before, after = value(*here), value(*there)
            if abs(after - before) > _SAME * (1 + abs(before)):
                return False
    return True
