"""Bound and shape of a control law, derived from the equations that run.

A law runs in continuous time, in the computer of one period, or of any. Its states stay within the
ranges that their rates or their steps never leave, from zero at the start; its force stays within
what its output then is, for all signals. A declaration says only what is to be derived.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import product

import sympy as sp

from ..base.errors import ModelError
from ..controllers import (
    SIGNALS,
    Ability,
    Controller,
    ControllerEquation,
    Stage,
    equation_of,
    exact_decimal,
    has_shape,
    make_exact,
    symbols_of,
)
from .inequalities import ANY, POSITIVE, Ranges, is_never_negative, least_bound, range_of

#: periods in which a law runs, s: in continuous time alone, or there and in every computer
CONTINUOUS, ANY_TIME = (0.0, 0.0), (0.0, math.inf)
Periods = tuple[float, float]
_PERIOD = SIGNALS["period"]
#: speed of the motion, and of its travel over the last sample, in the direction of a case
_SPEED, _TRAVEL = sp.symbols("speed_here travel_here", positive=True)
_SAMPLE = sp.Symbol("sample", positive=True)


@dataclass(frozen=True)
class LawFacts:
    """Properties of a law that follow from its equations; None: not declared, or not derived.

    bound: largest force, N;  bristle_stiffness: of a Dahl bristle of this level, N/m
    smoothing: a of the force bound v/(a + abs(v)), m/s
    missing: the step of the derivation that is missing, in words; "" where none is
    """

    bound: float | None = None
    bristle_stiffness: float | None = None
    smoothing: float | None = None
    missing: str = ""


@lru_cache(maxsize=1024)
def law_facts(stage: Stage, periods: Periods) -> LawFacts:
    """Bound and shape of a law in all these periods.

    periods: CONTINUOUS, ANY_TIME, or twice the period of one computer, s
    """
    name, bound = stage.law.name, stage.value_of("bound")
    if bound is None:
        return LawFacts(missing=f"{name} declares no bound of its force")
    if bound <= 0:
        return LawFacts(missing=f"{name}: its bound is {bound:g}, expected more than 0")
    try:
        forms = list(_forms(stage, periods))
        stiffness, smoothing = (
            _value_of_shape(stage, ability, forms) for ability in ("bristle_stiffness", "smoothing")
        )
        if stiffness is None and smoothing is None:  # a law of either shape keeps its level
            for form in forms:
                form.check_bound(bound)
    except ModelError as problem:
        return LawFacts(missing=f"{name}: {problem}")
    return LawFacts(bound, stiffness, smoothing)


def _value_of_shape(stage: Stage, ability: Ability, forms: list[_Form]) -> float | None:
    """The value of a shape that the law has in all its forms; None where it has not."""
    value = stage.value_of(ability)
    if value is None or value < 0:
        return None
    shaped = (f.stage.law is stage.law and has_shape(stage.law, ability, f.kind) for f in forms)
    return value if all(shaped) else None


def _forms(stage: Stage, periods: Periods) -> Iterator[_Form]:
    """The law as it runs in continuous time, in a computer, or in both.

    raises ModelError: a form that has no equations
    """
    low, high = periods
    if low == 0:
        yield _Form(stage, sp.S(0), sp.S(0))
    if high == 0:
        return
    if stage.law.sampled is not None:
        if low != high:
            raise ModelError("in a computer it becomes another law, one for each period")
        (stage,) = Controller((stage,)).sampled(high).stages
    yield _Form(stage, _PERIOD, _SAMPLE if low != high else exact_decimal(high))


@dataclass(frozen=True)
class _Form:
    """A law with its values as it runs in continuous time or in a computer.

    kind: period of its equations, 0 or a symbol;  period: which stands for it
    """

    stage: Stage
    kind: sp.Expr
    period: sp.Expr

    def check_bound(self, bound: float) -> None:
        """Prove that the force stays within its bound, N.

        raises ModelError: the step that is missing
        """
        made = equation_of(self.stage.law, self.kind)
        if made is None:
            raise ModelError("has no equations in continuous time" if self.kind == 0 else "is code")
        within = self._bounded_states(made, bound)
        for force in self._cases(made.output, within):
            if not _stays_within_one(_scale(force, 1 / exact_decimal(bound))):
                free = ", ".join(sorted(z.name for z, x in within.items() if x.is_Dummy))
                beside = f", with any value of {free}" if free else ""
                raise ModelError(f"its force could not be shown to stay within {bound:g}{beside}")

    def _cases(self, law: sp.Expr, within: Mapping[sp.Symbol, sp.Expr]) -> set[sp.Expr]:
        """The law with its values, for every direction of its signals and for rest.

        within: state -> its size times a share of it
        """
        symbols = symbols_of(self.stage.law)
        numbers = {symbols[n]: exact_decimal(x) for n, x in self.stage.values.items()}
        law = make_exact(law).subs({**numbers, _PERIOD: self.period, **within})
        cases = set()
        for way, moved in product((1, -1, 0), (1, -1, 0)):
            if self.kind == 0 and way != moved:
                continue
            travel = moved * (_SPEED if self.kind == 0 else _TRAVEL)
            signals = {"velocity": way * _SPEED, "speed": abs(way) * _SPEED, "travel_rate": travel}
            cases.add(law.subs({SIGNALS[n]: x for n, x in signals.items()}))
        return cases

    def _bounded_states(self, made: ControllerEquation, bound: float) -> dict[sp.Symbol, sp.Expr]:
        """State -> the size that it never exceeds, from zero at the start, times a share of it.

        A state of which no such size is known may be any number.
        """
        changes = {**made.rates, **made.steps}
        within: dict[sp.Symbol, sp.Expr] = {}
        for _ in changes:  # a state may follow one that was bounded before
            for z, change in changes.items():
                if z not in within and not (change.free_symbols & changes.keys()) - {z, *within}:
                    cases = self._cases(change, within)
                    steps = z in made.steps
                    if self.kind != 0 and not steps and any(sp.diff(c, z).has(z) for c in cases):
                        raise ModelError(f"{z} has no exact step: its rate is not affine in it")
                    size = _size(z, cases, bound, steps=steps)
                    share = sp.Symbol(f"share_{len(within)}", real=True)
                    within[z] = sp.Dummy(real=True) if size is None else size * share
        return within


def _size(z: sp.Symbol, cases: set[sp.Expr], bound: float, *, steps: bool) -> sp.Expr | None:
    """Size that a state never exceeds: the bound of the force, or its largest equilibrium.

    cases: its rate, whose exact step keeps what the rate keeps, or (steps) its next value
    returns: None where neither could be shown
    """
    largest = max(_equilibrium(z, case - z * int(steps)) for case in cases)
    share = sp.Symbol("share_here", real=True)

    def keeps(case: sp.Expr, size: sp.Expr) -> bool:
        """Whether the next value is within a size, or the rate leads inward at both its ends."""
        if steps:
            return _stays_within_one(_scale(case.subs(z, size * share), 1 / size))
        ends = (-way * case.subs(z, way * size) for way in (1, -1))
        return all(is_never_negative(end, _ranges(end)) for end in ends)

    for size in sorted({largest, exact_decimal(bound)}):
        if 0 < size < sp.oo and all(keeps(case, size) for case in cases):
            return size
    return None


def _ranges(law: sp.Expr) -> Ranges:
    """Ranges of the symbols of a case: shares of a state, positive numbers, or any."""
    return {
        x: (-1.0, 1.0) if x.name.startswith("share_") else POSITIVE if x.is_positive else ANY
        for x in law.free_symbols
    }


def _equilibrium(z: sp.Symbol, change: sp.Expr) -> sp.Expr:
    """Largest size of a state at which it does not change; oo where none is known."""
    slope = sp.diff(change, z)
    if slope.has(z):
        return sp.oo
    if slope == 0:
        return sp.S(0)
    rest = sp.simplify(-change.subs(z, 0) / slope)
    size = max(map(abs, range_of(rest, _ranges(rest))))
    if size.is_infinite:
        size = -min(least_bound(way * rest, _ranges(rest)) for way in (1, -1))
    return sp.Rational(size) if math.isfinite(size) else sp.oo


def _scale(law: sp.Expr, factor: sp.Expr) -> sp.Expr:
    """The law times a factor > 0, with the limits within it scaled too, so that they stay exact."""
    if isinstance(law, sp.Max | sp.Min):
        return law.func(*(_scale(part, factor) for part in law.args))
    if isinstance(law, sp.Piecewise):
        return sp.Piecewise(*((_scale(part, factor), where) for part, where in law.args))
    return law * factor


def _stays_within_one(share: sp.Expr) -> bool:
    """Whether abs(share) <= 1 is proved."""
    return all(is_never_negative(e, _ranges(e)) for e in (1 - share, 1 + share))
