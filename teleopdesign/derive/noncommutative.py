"""Identities between rational expressions of blocks that need not commute, proved exactly.

An expression becomes a polynomial in words over letters: the blocks, their inverses, and a letter
d = D^-1 for every inverse of a sum D. The letters obey exact rules,

    X X^-1 = X^-1 X = 1,     w d = (1 - (D - c w) d)/c,     d w = (1 - d (D - c w))/c

with c w the leading word of D, so whatever reduces to 0 is proven to be 0. What is left is
multiplied by D from the left or the right, which changes nothing about being 0 where D is
invertible. A search that ends without 0 proves nothing: `counterexample` then tries exact rational
matrices.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from random import Random

import sympy as sp

from ..base.errors import ModelError
from ..realise.lti import S

Word = tuple[str, ...]
WordPolynomial = dict[Word, Fraction]
_DEEPEST = 4  # denominators multiplied out, one inside the other


@dataclass
class _Algebra:
    """Letters for inverses of sums and their rules, collected while expressions are read."""

    denominators: dict[str, WordPolynomial] = field(default_factory=dict)
    names: dict[sp.Expr, str] = field(default_factory=dict)

    def read(self, expression: sp.Expr) -> WordPolynomial:
        """The sympy expression as a polynomial in words."""
        if expression.is_Rational:
            return {(): Fraction(int(expression.p), int(expression.q))} if expression else {}
        if expression.is_Symbol:
            return {(expression.name,): Fraction(1)}
        if expression.is_Add:
            return self.reduce(_sum([self.read(a) for a in expression.args]))
        if expression.is_Mul:
            product: WordPolynomial = {(): Fraction(1)}
            for factor in expression.args:
                product = self.times(product, self.read(factor))
            return product
        if expression.is_Pow and expression.exp.is_Integer:
            base = expression.base
            one = self.read(base) if expression.exp > 0 else self.inverse(base)
            product = {(): Fraction(1)}
            for _ in range(abs(int(expression.exp))):
                product = self.times(product, one)
            return product
        raise TypeError(f"no rational expression of blocks: {expression}")

    def inverse(self, base: sp.Expr) -> WordPolynomial:
        polynomial = self.read(base)
        if len(polynomial) == 1:
            ((word, factor),) = polynomial.items()
            return self.reduce({tuple(_inverse_letter(x) for x in reversed(word)): 1 / factor})
        if base not in self.names:
            letter = f"|{len(self.names)}|"  # no name of a block
            self.names[base] = letter
            self.denominators[letter] = polynomial
        return {(self.names[base],): Fraction(1)}

    def times(self, left: WordPolynomial, right: WordPolynomial) -> WordPolynomial:
        out: WordPolynomial = {}
        for a, x in left.items():
            for b, y in right.items():
                out[a + b] = out.get(a + b, Fraction(0)) + x * y
        return self.reduce(out)

    def reduce(self, polynomial: WordPolynomial) -> WordPolynomial:
        """Apply the rules until none applies."""
        done: WordPolynomial = {}
        todo = dict(polynomial)
        while todo:
            word, factor = todo.popitem()
            if not factor:
                continue
            step = self._step(word)
            if step is None:
                done[word] = done.get(word, Fraction(0)) + factor
            else:
                for other, c in step.items():
                    todo[other] = todo.get(other, Fraction(0)) + factor * c
        return {w: c for w, c in done.items() if c}

    def _step(self, word: Word) -> WordPolynomial | None:
        for i in range(len(word) - 1):
            if word[i + 1] == _inverse_letter(word[i]):
                return {word[:i] + word[i + 2 :]: Fraction(1)}
        for letter, denominator in self.denominators.items():
            lead = max(denominator, key=_order)
            c, n = denominator[lead], len(lead)
            rest = {w: f for w, f in denominator.items() if w != lead}
            for i, x in enumerate(word):
                if x != letter:
                    continue
                if n and word[max(i - n, 0) : i] == lead:
                    head, tail = word[: i - n], word[i + 1 :]
                    out = {head + w + (letter, *tail): -f / c for w, f in rest.items()}
                    return _sum([out, {head + tail: 1 / c}])
                if n and word[i + 1 : i + 1 + n] == lead:
                    head, tail = word[:i], word[i + 1 + n :]
                    out = {(*head, letter) + w + tail: -f / c for w, f in rest.items()}
                    return _sum([out, {head + tail: 1 / c}])
        return None

    def vanishes(self, polynomial: WordPolynomial, depth: int = _DEEPEST) -> bool:
        """Whether the polynomial is proven 0, with denominators multiplied out from both sides."""
        polynomial = self.reduce(polynomial)
        if not polynomial:
            return True
        if depth == 0:
            return False
        for letter in sorted({x for word in polynomial for x in word}):
            one = self.denominators.get(letter)
            if one is None and letter.endswith("^-1"):
                one = {(_inverse_letter(letter),): Fraction(1)}
            if one is None:
                continue
            starts = any(w and w[0] == letter for w in polynomial)
            ends = any(w and w[-1] == letter for w in polynomial)
            if starts and self.vanishes(self.times(one, polynomial), depth - 1):
                return True
            if ends and self.vanishes(self.times(polynomial, one), depth - 1):
                return True
        return False


def _inverse_letter(letter: str) -> str:
    return letter.removesuffix("^-1") if letter.endswith("^-1") else f"{letter}^-1"


def _order(word: Word) -> tuple[int, bool, Word]:
    # words with unique letters (no inverses) lead: their rules shorten most
    return len(word), not any(x.endswith("^-1") for x in word), word


def _sum(parts: Sequence[WordPolynomial]) -> WordPolynomial:
    out: WordPolynomial = {}
    for part in parts:
        for word, factor in part.items():
            out[word] = out.get(word, Fraction(0)) + factor
    return out


def proved_equal(left: sp.Expr, right: sp.Expr) -> bool:
    """Whether left = right is proven, for all blocks for which the inverses exist.

    True is an exact proof. False means only that no proof was reached.
    """
    algebra = _Algebra()
    a, b = algebra.read(sp.sympify(left, strict=True)), algebra.read(sp.sympify(right, strict=True))
    return algebra.vanishes(_sum([a, {w: -c for w, c in b.items()}]))


def insert_matrices(
    expression: sp.Expr, blocks: dict[sp.Symbol, sp.Matrix], *, size: int | None = None
) -> sp.Matrix:
    """The expression with matrices in place of its symbols, exact if they are rational.

    Floating-point numbers in the expression are converted to exact fractions, so that a zero stays
    zero. A dead time becomes a number: the first entry of the matrix of its symbol, plus 15.

    size: rows of each matrix; default: those of the first block
    raises ModelError: there is no block, and no size
    """
    if size is None:
        if not blocks:
            raise ModelError(f"{expression}: no block is given, expected a size beside it")
        size = next(iter(blocks.values())).shape[0]
    if expression.is_Number:
        exact = sp.Rational(expression) if expression.is_Float else expression
        return exact * sp.eye(size)
    if expression.is_Symbol:
        return blocks[expression]
    if isinstance(expression, sp.exp):
        return _scalar(expression, blocks) * sp.eye(size)
    if expression.is_Pow:
        return insert_matrices(expression.base, blocks, size=size) ** int(expression.exp)
    parts = [insert_matrices(a, blocks, size=size) for a in expression.args]
    if expression.is_Add:
        return sum(parts[1:], parts[0])
    product = sp.eye(size)
    for part in parts:
        product = product * part
    return product


def _scalar(late: sp.Expr, blocks: dict[sp.Symbol, sp.Matrix]) -> sp.Expr:
    """A number in place of the dead time e^(-s T); a sum of dead times becomes a product."""
    times = sp.Poly(-late.args[0] / S, *(late.free_symbols - {S}))
    factors = ((15 + blocks[t][0, 0]) ** n for t, n in zip(times.gens, times.coeffs(), strict=True))
    return sp.Mul(*factors)


def counterexample(
    left: sp.Expr, right: sp.Expr, *, size: int = 2, tries: int = 3, seed: int = 1
) -> dict[sp.Symbol, sp.Matrix] | None:
    """Matrices on which two expressions differ, in exact numbers; None if they agree in all draws.

    size: rows of the matrices;  tries: largest number of draws;  seed: of the draws
    """
    random = Random(seed)
    symbols = sorted(left.free_symbols | right.free_symbols, key=str)
    for _ in range(tries):
        blocks = {
            s: sp.Matrix(size, size, lambda *_: sp.Rational(random.randint(-99, 99), 7))
            for s in symbols
            if s != S
        }
        if insert_matrices(left, blocks, size=size) != insert_matrices(right, blocks, size=size):
            return blocks
    return None
