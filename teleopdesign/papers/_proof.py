"""Proofs as steps of sympy expressions; each step is checked exactly, without a float.

A step is data. This module decides whether it holds. A step may use the assumptions of the proof,
the assumptions of the symbols (positive, real), and facts that an earlier step has established.
The words of the steps say how the steps make up the statement.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar, Literal

import sympy as sp

from ..derive import counterexample, proved_equal

_LONGEST = 48  # characters of an expression that a line of a proof shows


class NotProved(Exception):
    """A step is false, or could not be shown to be true; the message says which step and why."""


@dataclass(frozen=True)
class ProofStep:
    """One exact fact; words: its meaning in the chain of the proof."""

    words: str


@dataclass(frozen=True)
class Equal(ProofStep):
    """left = right for all values of the symbols, or for blocks that need not commute."""

    left: sp.Expr
    right: sp.Expr


@dataclass(frozen=True)
class BlocksDiffer(ProofStep):
    """left != right for some blocks: rational matrices on which they differ exactly."""

    left: sp.Expr
    right: sp.Expr


@dataclass(frozen=True)
class NotNegative(ProofStep):
    """expression >= 0: it equals `form`, whose sign sympy knows.

    form: an expression of symbols whose sign sympy knows, and of the symbols in `signs`
    signs: symbol >= 0 -> expression that the proof assumes, or has shown before, to be >= 0
    strictly: expression > 0
    """

    expression: sp.Expr
    form: sp.Expr
    signs: Mapping[sp.Symbol, sp.Expr] = field(default_factory=dict)
    strictly: bool = False


@dataclass(frozen=True)
class Grows(ProofStep):
    """expression >= 0 for variable > 0: its start and its derivative `slope` are >= 0.

    slope: a form of the derivative whose sign sympy knows, as in NotNegative
    """

    expression: sp.Expr
    variable: sp.Symbol
    slope: sp.Expr
    signs: Mapping[sp.Symbol, sp.Expr] = field(default_factory=dict)


@dataclass(frozen=True)
class Limit(ProofStep):
    """expression -> value as variable -> at (from the right if `at` is finite)."""

    expression: sp.Expr
    variable: sp.Symbol
    at: sp.Expr
    value: sp.Expr


@dataclass(frozen=True)
class Holds(ProofStep):
    """A relation between exact numbers is true: an example that a case can occur.

    relation: "==", "!=", "<", "<=", ">" or ">="
    """

    left: sp.Expr
    relation: str
    right: sp.Expr


def check_step(step: ProofStep, known: Sequence[sp.Expr]) -> list[sp.Expr]:
    """Check a step exactly; returns expressions that it shows to be >= 0.

    known: expressions that are assumed, or were shown, to be >= 0
    raises NotProved: the step is not shown to hold
    """
    _without_floats(*(part for part in vars(step).values() if isinstance(part, sp.Basic)))
    match step:
        case Equal(_, left, right):
            _require(_are_equal(left, right), step, f"no proof that {left} = {right}")
        case BlocksDiffer(_, left, right):
            _require(counterexample(left, right) is not None, step, "no counterexample found")
        case Limit(_, expression, variable, at, value):
            limit = sp.limit(expression, variable, at, "+")
            _require(
                limit == value or vanishes(limit - value),
                step,
                f"the limit is {limit}, not {value}",
            )
        case Holds(_, left, relation, right):
            numbers = not sp.sympify(left).free_symbols | sp.sympify(right).free_symbols
            _require(numbers, step, f"{left} or {right} is no number")
            stated = sp.Rel(left, right, relation)
            _require(sp.simplify(stated) == sp.true, step, f"{stated} is not true")
        case Grows(words, expression, variable, slope, signs):
            start = sp.limit(expression, variable, 0, "+")
            _require(start.is_nonnegative, step, f"starts at {start}")
            derivative = sp.diff(expression, variable)
            _check_sign(NotNegative(words, derivative, slope, signs), known)
            return [sp.sympify(expression)]
        case NotNegative():
            _check_sign(step, known)
            return [sp.sympify(step.expression)]
    return []


def _check_sign(step: NotNegative, known: Sequence[sp.Expr]) -> None:
    """Check the sign of the form by sympy's assumptions, and the equality exactly."""
    form = sp.sympify(step.form)
    _without_floats(*step.signs.values())
    for symbol, used in step.signs.items():
        _require(symbol.is_nonnegative, step, f"{symbol} is not declared >= 0")
        shown = any(vanishes(used - k) for k in known)
        _require(shown, step, f"{used} >= 0 is neither assumed nor shown")
    has_sign = form.is_positive if step.strictly else form.is_nonnegative
    _require(has_sign, step, f"the sign of {form} does not show")
    equal = vanishes(step.expression - form.subs(dict(step.signs)))
    _require(equal, step, f"no proof that {step.expression} = {form}")


def _require(holds: bool | None, step: ProofStep, why: str) -> None:
    if not holds:
        raise NotProved(f"{step.words}: {why}")


def _are_equal(left: sp.Expr, right: sp.Expr) -> bool:
    """Whether sympy's zero test, or exact rewriting of blocks, shows that both are equal."""
    left, right = sp.sympify(left), sp.sympify(right)
    if left.is_commutative and right.is_commutative:
        return vanishes(left - right)
    return proved_equal(left, right)


def vanishes(expression: sp.Expr) -> bool:
    """Whether sympy shows exactly that the expression is 0; False says only that it did not."""
    expression = sp.sympify(expression)
    if expression == 0 or sp.expand(expression) == 0:
        return True
    if _plainly_not_zero(expression):
        return False
    return bool(
        sp.simplify(expression) == 0 or sp.simplify(sp.expand(expression.rewrite(sp.exp))) == 0
    )


def _plainly_not_zero(expression: sp.Expr) -> bool:
    """Whether the value at one point shows that the expression is not 0; saves a longer search."""
    symbols = sorted(expression.free_symbols, key=str)
    point = {x: sp.Rational(7 + 3 * i, 11 + 2 * i) for i, x in enumerate(symbols)}
    value = sp.N(expression.subs(point), 30)
    return bool(value.is_number and value.is_finite and sp.Abs(value) > sp.Float("1e-20"))


def _without_floats(*expressions: sp.Basic) -> None:
    for expression in expressions:
        if sp.sympify(expression).has(sp.Float):
            raise NotProved(f"a float in {expression}: a number proves nothing")


def step_text(step: ProofStep) -> str:
    """The words of a step, with what it shows where that is short enough to print."""
    match step:
        case Equal(words, _, right) if sp.sympify(right).is_commutative:
            sign, shown = "=", right
        case Limit(words, _, _, _, value):
            sign, shown = "->", value
        case _:
            return step.words
    text = str(shown).replace("**", "^")
    return f"{words}  [{sign} {text}]" if len(text) <= _LONGEST else words


@dataclass(frozen=True)
class ProofSteps:
    """Steps of a proof, in order.

    assuming: expressions that the statement assumes to be >= 0, beyond the assumptions of symbols
    """

    steps: tuple[ProofStep, ...]
    assuming: tuple[sp.Expr, ...] = ()
    outcome: ClassVar[Literal["proved"]] = "proved"

    def verify(self) -> tuple[str, ...]:
        """The words of every step; raises NotProved at the first step that does not hold."""
        if not self.steps:
            raise NotProved("a proof without steps")
        known: list[sp.Expr] = [sp.sympify(a) for a in self.assuming]
        _without_floats(*known)
        for step in self.steps:
            known += check_step(step, known)
        return tuple(map(step_text, self.steps))


def proof(*steps: ProofStep | Iterable[ProofStep], assuming: Iterable[sp.Expr] = ()) -> ProofSteps:
    """A proof of these steps; an argument may also be an iterable of steps.

    assuming: expressions that the statement assumes to be >= 0
    """
    flat: list[ProofStep] = []
    for step in steps:
        flat += [step] if isinstance(step, ProofStep) else list(step)
    return ProofSteps(tuple(flat), tuple(assuming))


@dataclass(frozen=True)
class Correction:
    """A printed statement is refuted exactly, and a corrected form is proved.

    printed: steps that show the failure;  corrected: proof of the corrected form
    """

    printed: ProofSteps
    corrected: ProofSteps
    outcome: ClassVar[Literal["refuted"]] = "refuted"

    def verify(self) -> tuple[str, ...]:
        """The words of all steps; raises NotProved if one does not hold."""
        against = tuple(f"against the print: {w}" for w in self.printed.verify())
        return against + self.corrected.verify()
