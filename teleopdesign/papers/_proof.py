"""Proofs as steps of sympy expressions; each step is checked exactly, without a float.

A function only writes down the steps; this module decides whether they hold. A step may use the
assumptions of the proof, the assumptions of the symbols (positive, real), and facts that an earlier
step has established. The words of the steps say how the steps make up the statement.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import sympy as sp

from ..derive import counterexample, proved_equal

_LONGEST = 48  # characters of an expression that a line of a proof shows


class NotProved(Exception):
    """A step is false, or could not be shown to be true; the message says which step and why."""


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


def _show_sign(sign: str, expression: sp.Expr) -> str:
    text = str(expression).replace("**", "^")
    return f"  [{sign} {text}]" if len(text) <= _LONGEST else ""


@dataclass(frozen=True)
class ProofStep:
    """One exact fact; words: its meaning in the chain of the proof."""

    words: str

    def check(self, known: Sequence[sp.Expr]) -> list[sp.Expr]:
        """Check the step; returns expressions that it shows to be >= 0.

        known: expressions that are assumed, or were shown, to be >= 0
        raises NotProved: the step is not shown to hold
        """
        raise NotImplementedError

    def as_text(self) -> str:
        """The words of the step, with expressions that are short enough to print."""
        return self.words


@dataclass(frozen=True)
class Equal(ProofStep):
    """left = right for all values of the symbols (commuting)."""

    left: sp.Expr
    right: sp.Expr

    def check(self, known: Sequence[sp.Expr]) -> list[sp.Expr]:
        """Check by sympy's exact zero test; returns no expressions."""
        _without_floats(self.left, self.right)
        if not vanishes(sp.sympify(self.left) - self.right):
            raise NotProved(f"{self.words}: no proof that {self.left} = {self.right}")
        return []

    def as_text(self) -> str:
        """The words with the right side."""
        return self.words + _show_sign("=", self.right)


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

    def check(self, known: Sequence[sp.Expr]) -> list[sp.Expr]:
        """Check the sign by sympy's assumptions, and the equality exactly."""
        form = sp.sympify(self.form)
        _without_floats(self.expression, form, *self.signs.values())
        for symbol, used in self.signs.items():
            if not symbol.is_nonnegative:
                raise NotProved(f"{self.words}: {symbol} is not declared >= 0")
            if not any(vanishes(used - k) for k in known):
                raise NotProved(f"{self.words}: {used} >= 0 is neither assumed nor shown")
        if not (form.is_positive if self.strictly else form.is_nonnegative):
            raise NotProved(f"{self.words}: the sign of {form} does not show")
        if not vanishes(self.expression - form.subs(dict(self.signs))):
            raise NotProved(f"{self.words}: no proof that {self.expression} = {form}")
        return [sp.sympify(self.expression)]


@dataclass(frozen=True)
class Grows(ProofStep):
    """expression >= 0 for variable > 0: its start and its derivative `slope` are >= 0.

    slope: a form of the derivative whose sign sympy knows, as in NotNegative
    """

    expression: sp.Expr
    variable: sp.Symbol
    slope: sp.Expr
    signs: Mapping[sp.Symbol, sp.Expr] = field(default_factory=dict)

    def check(self, known: Sequence[sp.Expr]) -> list[sp.Expr]:
        """Check the start by an exact limit from the right, the derivative as in NotNegative."""
        start = sp.limit(self.expression, self.variable, 0, "+")
        if not start.is_nonnegative:
            raise NotProved(f"{self.words}: starts at {start}")
        derivative = sp.diff(self.expression, self.variable)
        NotNegative(self.words, derivative, self.slope, self.signs).check(known)
        return [sp.sympify(self.expression)]


@dataclass(frozen=True)
class Limit(ProofStep):
    """expression -> value as variable -> at (from the right if `at` is finite)."""

    expression: sp.Expr
    variable: sp.Symbol
    at: sp.Expr
    value: sp.Expr

    def check(self, known: Sequence[sp.Expr]) -> list[sp.Expr]:
        """Check by sympy's limit; returns no expressions."""
        _without_floats(self.expression, self.value)
        limit = sp.limit(self.expression, self.variable, self.at, "+")
        if limit != self.value and not vanishes(limit - self.value):
            raise NotProved(f"{self.words}: the limit is {limit}, not {self.value}")
        return []

    def as_text(self) -> str:
        """The words with the value of the limit."""
        return self.words + _show_sign("->", self.value)


@dataclass(frozen=True)
class Holds(ProofStep):
    """A relation between exact numbers is true: an example that a case can occur.

    relation: "==", "!=", "<", "<=", ">" or ">="
    """

    left: sp.Expr
    relation: str
    right: sp.Expr

    def check(self, known: Sequence[sp.Expr]) -> list[sp.Expr]:
        """Check by sympy; returns no expressions."""
        left, right = sp.sympify(self.left), sp.sympify(self.right)
        _without_floats(left, right)
        if left.free_symbols or right.free_symbols:
            raise NotProved(f"{self.words}: {left} or {right} is no number")
        relation = sp.Rel(left, right, self.relation)
        if sp.simplify(relation) != sp.true:
            raise NotProved(f"{self.words}: {relation} is not true")
        return []


@dataclass(frozen=True)
class BlocksEqual(ProofStep):
    """left = right for blocks that need not commute."""

    left: sp.Expr
    right: sp.Expr

    def check(self, known: Sequence[sp.Expr]) -> list[sp.Expr]:
        """Check by exact rewriting, see `derive.proved_equal`."""
        _without_floats(self.left, self.right)
        if not proved_equal(self.left, self.right):
            raise NotProved(f"{self.words}: no proof that {self.left} = {self.right}")
        return []


@dataclass(frozen=True)
class BlocksDiffer(ProofStep):
    """left != right for some blocks: rational matrices on which they differ exactly."""

    left: sp.Expr
    right: sp.Expr

    def check(self, known: Sequence[sp.Expr]) -> list[sp.Expr]:
        """Check by a counterexample, see `derive.counterexample`."""
        _without_floats(self.left, self.right)
        if counterexample(self.left, self.right) is None:
            raise NotProved(f"{self.words}: no counterexample found")
        return []


@dataclass(frozen=True)
class ProofSteps:
    """Steps of a proof, in order.

    assuming: expressions that the statement assumes to be >= 0, beyond the assumptions of symbols
    """

    steps: tuple[ProofStep, ...]
    assuming: tuple[sp.Expr, ...] = ()

    def verify(self) -> tuple[str, ...]:
        """The words of every step; raises NotProved at the first step that does not hold."""
        if not self.steps:
            raise NotProved("a proof without steps")
        known: list[sp.Expr] = [sp.sympify(a) for a in self.assuming]
        _without_floats(*known)
        for step in self.steps:
            known += step.check(known)
        return tuple(step.as_text() for step in self.steps)


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

    def verify(self) -> tuple[str, ...]:
        """The words of all steps; raises NotProved if one does not hold."""
        against = tuple(f"against the print: {w}" for w in self.printed.verify())
        return against + self.corrected.verify()
