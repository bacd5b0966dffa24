"""Exact rational functions of some names, and the small parser that reads their texts."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from operator import add, sub
from typing import Any

from .effort import DEGREE, DIGITS, NAMES, NESTING, Refused, longest, need, spend_from

#: a polynomial: exponents of the names -> coefficient, not 0; {} is the zero polynomial
Poly = dict[tuple[int, ...], Fraction]
_TOKEN = re.compile(r"\s*(?:(\d+(?:\.\d+)?)|([A-Za-z_]\w*)|(\*\*|[-+*/()]))", re.ASCII)


@dataclass(frozen=True)
class Quotient:
    """above over the product of base^power; below: name of a base (not zero) -> power."""

    above: Poly
    below: Mapping[str, int]


class Algebra:
    """Arithmetic of exact rational functions of some names, with a bounded effort.

    left: effort that is left, a list of one number that others may share
    bases: polynomials that may be divisors, by name; with `divides` every divisor becomes a base
    put: polynomials that replace names
    """

    def __init__(self, names: list[str], left: list[int], *, divides: bool = False) -> None:
        self.names, self.left, self.divides = names, left, divides
        self.bases: dict[str, Poly] = {}
        self.put: dict[str, Poly] = {}
        self.unit = (0,) * len(names)

    def spend(self, effort: int) -> None:
        spend_from(self.left, effort)

    def number(self, x: Fraction | int) -> Poly:
        return {self.unit: Fraction(x)} if x else {}

    def name(self, name: str) -> Poly:
        need(name in self.names, f"unknown name {name[:NAMES]}")
        if name in self.put:
            return self.put[name]
        return {tuple(int(n == name) for n in self.names): Fraction(1)}

    def weigh(self, a: Poly, b: Poly) -> int:
        """Effort of a product of coefficients: 1, or by the product of lengths for long ones."""
        return 1 + (longest(a.values()) * longest(b.values()) >> 17)

    def plus(self, a: Poly, b: Poly, factor: Fraction | int = 1) -> Poly:
        """a + factor * b."""
        self.spend((1 + len(a) // 8 + len(b)) * self.weigh(a, b))
        total = dict(a)
        for k, x in b.items():
            total[k] = total.get(k, Fraction(0)) + factor * x
        return {k: x for k, x in total.items() if x}

    def times(self, a: Poly, b: Poly) -> Poly:
        self.spend(1 + len(a) * len(b) * self.weigh(a, b))
        product: Poly = {}
        for (m, x), (n, y) in itertools.product(a.items(), b.items()):
            k = tuple(map(add, m, n))
            product[k] = product.get(k, Fraction(0)) + x * y
        need(max(map(sum, product), default=0) <= DEGREE, "the degree is too large")
        return {k: x for k, x in product.items() if x}

    def power(self, a: Poly, n: int) -> Poly:
        need(n <= DEGREE, "the degree is too large")
        result = self.number(1)
        for bit in f"{n:b}":
            result = self.times(result, result)
            result = self.times(result, a) if bit == "1" else result
        return result

    def divided(self, a: Poly, b: Poly) -> tuple[Poly, Poly]:
        """(quotient, rest) by the highest term of b; the rest is {} if and only if b divides a."""
        quotient: Poly = {}
        high = max(b)
        while a and min(map(sub, max(a), high), default=0) >= 0:
            k = tuple(map(sub, max(a), high))
            quotient[k] = a[max(a)] / b[high]
            a = self.plus(a, self.times({k: quotient[k]}, b), -1)
        return quotient, a

    def invert(self, a: Poly) -> Quotient:
        """1/a, where a is a product of bases and a number other than 0; else raises Refused."""
        below: dict[str, int] = {}
        for name, base in self.bases.items():
            while a and base and {*a} != {self.unit} != {*base}:
                quotient, rest = self.divided(a, base)
                if rest:
                    break
                a, below[name] = quotient, below.get(name, 0) + 1
        if self.divides and a and {*a} != {self.unit}:
            below[name := f"divisor {len(self.bases)}"] = 1
            self.bases[name], a = a, self.number(1)
        need({*a} == {self.unit}, "may divide by zero")
        return Quotient(self.number(1 / a[self.unit]), below)

    def product(self, a: Quotient, b: Quotient) -> Quotient:
        below = {n: a.below.get(n, 0) + b.below.get(n, 0) for n in {**a.below, **b.below}}
        return Quotient(self.times(a.above, b.above), below)

    def sum(self, a: Quotient, b: Quotient, factor: Fraction | int = 1) -> Quotient:
        """a + factor * b."""
        below = {n: max(a.below.get(n, 0), b.below.get(n, 0)) for n in {**a.below, **b.below}}
        above = self.over(a, below, a.below), self.over(b, below, b.below)
        return Quotient(self.plus(*above, factor), below)

    def over(self, a: Quotient, below: Mapping[str, int], present: Mapping[str, int]) -> Poly:
        """a.above times the powers of bases that `below` has more than `present`."""
        above = a.above
        for n in below:
            if below[n] > present.get(n, 0):
                above = self.times(above, self.power(self.bases[n], below[n] - present.get(n, 0)))
        return above

    def read(self, text: object) -> Quotient:
        """The rational function of a text (+ - * / ** ( ), numbers, names), which is never run."""
        need(isinstance(text, str), "expected a text where there is none")
        return _Reader(self, str(text)).whole()

    def value(self, p: Poly, at: Mapping[str, Fraction]) -> Fraction:
        """Value of a polynomial; at: value of each name that the polynomial uses."""
        numbers = [at.get(n, Fraction(0)) for n in self.names]
        size = max(max(map(sum, p), default=0), 1) * longest([*numbers, *p.values()])
        self.spend(len(p) * (1 + (size * size >> 17)))
        terms = (x * math.prod(map(pow, numbers, k)) for k, x in p.items())
        return sum(terms, Fraction(0))

    def uses(self, *quotients: Quotient) -> set[str]:
        """Names that occur in the quotients, denominators included."""
        polys = [p for q in quotients for p in (q.above, *(self.bases[n] for n in q.below))]
        return {self.names[i] for p in polys for k in p for i, power in enumerate(k) if power}


class _Reader:
    """Parser of one text by recursive descent: sum, product, power, atom."""

    def __init__(self, algebra: Algebra, text: str) -> None:
        self.algebra, self.text, at = algebra, text, 0
        self.tokens: list[str] = []
        text = text.rstrip()
        while at < len(text):
            token = _TOKEN.match(text, at)
            if token is None or len(token[0]) > DIGITS:
                raise Refused(f"refused: cannot read {ascii(text[at : at + 20])}")
            self.tokens.append(token[0].strip())
            at = token.end()
        algebra.spend(2 * len(self.tokens))
        self.tokens.reverse()

    def next(self, *expected: str) -> str:
        """Remove and return the next token if it is one of `expected`; else return ""."""
        return self.tokens.pop() if self.tokens and self.tokens[-1] in expected else ""

    def whole(self) -> Quotient:
        result = self.sum(0)
        need(not self.tokens, f"cannot read {ascii(self.text[:60])}")
        return result

    def sum(self, depth: int) -> Quotient:
        need(depth <= NESTING, "nested too deeply")
        total, sign = Quotient({}, {}), self.next("-", "+") or "+"
        while sign:
            total = self.algebra.sum(total, self.product(depth), -1 if sign == "-" else 1)
            sign = self.next("-", "+")
        return total

    def product(self, depth: int) -> Quotient:
        result = self.power(depth)
        while operation := self.next("*", "/"):
            factor = self.power(depth)
            result = self.algebra.product(
                result, self.raised(factor, 1 if operation == "*" else -1)
            )
        return result

    def power(self, depth: int) -> Quotient:
        result = self.atom(depth)
        if self.next("**"):
            inner = self.next("(")
            sign = -1 if self.next("-") else 1
            digits = self.tokens.pop() if self.tokens else ""
            need(digits.isdigit() and len(digits) < 5, "an exponent that is no small integer")
            need(not inner or self.next(")"), "an exponent that is no small integer")
            result = self.raised(result, sign * int(digits))
        return result

    def raised(self, a: Quotient, n: int) -> Quotient:
        if n < 0:
            inverse = self.algebra.invert(a.above)
            a = Quotient(self.algebra.over(inverse, a.below, {}), inverse.below)
        above = a.above if abs(n) == 1 else self.algebra.power(a.above, abs(n))
        return Quotient(above, {name: abs(n) * k for name, k in a.below.items()})

    def atom(self, depth: int) -> Quotient:
        need(self.tokens, f"cannot read {ascii(self.text[:60])}")
        token = self.tokens.pop()
        if token == "(":
            result = self.sum(depth + 1)
            need(self.next(")"), f"cannot read {ascii(self.text[:60])}")
            return result
        if token[0].isdigit():
            return Quotient(self.algebra.number(Fraction(token)), {})
        need(token.isidentifier(), f"cannot read {ascii(self.text[:60])}")
        return Quotient(self.algebra.name(token), {})


_NUMBER = re.compile(r"-?\d+(/0*[1-9]\d*)?", re.ASCII)


def expect(kind: type, value: Any, what: str) -> Any:
    """The value, if it is exactly of that type; else raises Refused. what: name in the message."""
    need(type(value) is kind, f"{what}: expected {kind.__name__}, found {type(value).__name__}")
    return value


def read_words(value: Any, what: str) -> list[str]:
    """A list of names: plain ASCII words, each once, at most NAMES of them; else raises Refused."""
    names: list[str] = expect(list, value, what)
    for n in names:
        fits = type(n) is str and len(n) <= NAMES and re.fullmatch(r"[A-Za-z]\w*", n, re.ASCII)
        need(fits and "__" not in n, f"{what}: a name that is no plain word")
    need(len(set(names)) == len(names) <= NAMES, f"{what}: a name twice, or too many")
    return names


def read_number(text: Any, what: str) -> Fraction:
    """The number of a text such as "-1/2"; raises Refused for any other text."""
    fits = type(text) is str and len(text) <= DIGITS and _NUMBER.fullmatch(text)
    need(fits, f"{what}: expected a fraction such as -1/2")
    return Fraction(text)


def expect_fields(c: dict[str, Any], *names: str) -> None:
    """Raise Refused for a certificate that has not exactly these fields."""
    need({*c} == {*names}, f"expected exactly the fields {', '.join(sorted(names))}")


def flat(text: str) -> str:
    """The text on one line."""
    return " ".join(text.split())
