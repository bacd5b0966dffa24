"""Check certificates of passivity: `python check_certificate.py FILE ...`, Python's library alone.

Prints the statement that a certificate proves, made from its contents, or one line why it proves
nothing; status 1 if any is refused. Texts are read by the small parser below and never run; all
numbers are fractions; the effort is bounded. Two kinds:

Storage. Names are constants, signals (functions of time), states (with a rate each) and, for each
x in `signs`, abs_x = |x| and sign_x (1 for x > 0, -1 for x < 0, either for x = 0).

Theorem. Let constants and signals be such that every expression in `positive` is > 0 and every one
in `nonnegative` >= 0 at all times, signals and rates of invariants locally bounded. Let the states
be absolutely continuous with x' = rate at almost every time, and every invariant h >= 0 at the
start. Then h >= 0 and V >= 0 at all times, and the integral of the supply is at least the change of
the storage V, where V = 0 at rest. So it is never below -V(start), and from rest never below 0.

Proof. (1) V and h hold constants and states only; assumptions hold constants and signals only.
Division is by products of `positive` expressions, so all is defined, V and h are locally Lipschitz,
and t -> V, h is absolutely continuous. (2) In each combination of signs (x = s X, X = |x| >= 0)
h' + rate h, V and supply - V' are identically sums of weight * factors^powers * square: weights are
rational and >= 0; factors are |x|, assumptions and (not for the h) invariants; powers are integers,
below 0 only for `positive`. So each is >= 0. (3) V and h may depend on |e| or sign_e of a state e
where both sides agree at e = 0 and no rate depends on sign_e. At almost every time with e = 0 also
e' = 0, so that both sides give the same V', the true one. (4) h' >= -rate h keeps h >= 0
(multiply by the exponential of the integral of the rate); V' <= supply is integrated. (5) At x = 0
the supply and all rates are affine in sign_x where the statement says so; then the inequalities
hold for all values between as well (sticking friction), being affine between the two shown.
The example meets all assumptions, as given and at rest: the theorem is not about nothing.

Positive real. S = (Z - 1)/(Z + 1) has a common denominator with all zeros in Re s < 0 (Routh), and
1 - S(-s)^T S(s) has principal minors >= 0 on the axis (Sturm): there, and by the maximum principle
for Re s > 0, |S| <= 1. So Z is analytic for Re s > 0 with Z + Z^H >= 0.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import math
import re
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from operator import add, sub
from typing import Any

#: bounds of what is read (bytes, digits, names, signs, brackets) and computed (degree, bits, and
#: products of terms, some microseconds each): above all the package writes, a few seconds at most
FILE, DIGITS, NAMES, SIGNS, NESTING = 2_000_000, 4000, 60, 4, 40
DEGREE, BITS, EFFORT = 4000, 100_000, 500_000

#: exponents of the names -> coefficient, not 0; {} is 0
Poly = dict[tuple[int, ...], Fraction]
_TOKEN = re.compile(r"\s*(?:(\d+(?:\.\d+)?)|([A-Za-z_]\w*)|(\*\*|[-+*/()]))", re.ASCII)
_NUMBER = re.compile(r"-?\d+(/0*[1-9]\d*)?", re.ASCII)


class Refused(ValueError):
    """What was read proves nothing; the message is one line."""


def _need(condition: object, problem: str) -> None:
    if not condition:
        raise Refused(f"refused: {problem[:200]}")


@dataclass(frozen=True)
class Quotient:
    """above / product of base^power; the bases are not zero."""

    above: Poly
    below: Mapping[str, int]


class Algebra:
    """Exact rational functions of some names, within a bounded effort.

    put: what stands for a name, other than itself;  left: the effort that is left, shared
    bases: what may be divided by, by name; with `divides` every divisor becomes one
    """

    def __init__(self, names: list[str], left: list[int], *, divides: bool = False) -> None:
        self.names, self.left, self.divides = names, left, divides
        self.bases: dict[str, Poly] = {}
        self.put: dict[str, Poly] = {}
        self.unit = (0,) * len(names)

    def spend(self, effort: int) -> None:
        self.left[0] -= effort
        _need(self.left[0] >= 0, "more work than a certificate may ask for")

    def number(self, x: Fraction | int) -> Poly:
        return {self.unit: Fraction(x)} if x else {}

    def name(self, name: str) -> Poly:
        _need(name in self.names, f"unknown name {name[:NAMES]}")
        if name in self.put:
            return self.put[name]
        return {tuple(int(n == name) for n in self.names): Fraction(1)}

    @staticmethod
    def bits(numbers: Iterable[Fraction]) -> int:
        """Length of the longest number."""
        parts = (max(abs(x.numerator), x.denominator).bit_length() for x in numbers)
        longest = max(parts, default=0)
        _need(longest <= BITS, "a number is too long")
        return longest

    def weigh(self, a: Poly, b: Poly) -> int:
        """Effort of one product of coefficients: 1, but quadratic in their length for long ones."""
        return 1 + (self.bits(a.values()) * self.bits(b.values()) >> 17)

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
        _need(max(map(sum, product), default=0) <= DEGREE, "the degree is too large")
        return {k: x for k, x in product.items() if x}

    def power(self, a: Poly, n: int) -> Poly:
        _need(n <= DEGREE, "the degree is too large")
        result = self.number(1)
        for bit in f"{n:b}":
            result = self.times(result, result)
            result = self.times(result, a) if bit == "1" else result
        return result

    def divided(self, a: Poly, b: Poly) -> tuple[Poly, Poly]:
        """(quotient, rest) by the highest power of b; with several names: rest {} iff b divides."""
        quotient: Poly = {}
        high = max(b)
        while a and min(map(sub, max(a), high), default=0) >= 0:
            k = tuple(map(sub, max(a), high))
            quotient[k] = a[max(a)] / b[high]
            a = self.plus(a, self.times({k: quotient[k]}, b), -1)
        return quotient, a

    def invert(self, a: Poly) -> Quotient:
        """1/a for a product of bases and a number other than 0."""
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
        _need({*a} == {self.unit}, "may divide by zero")
        return Quotient(self.number(1 / a[self.unit]), below)

    def product(self, a: Quotient, b: Quotient) -> Quotient:
        below = {n: a.below.get(n, 0) + b.below.get(n, 0) for n in {**a.below, **b.below}}
        return Quotient(self.times(a.above, b.above), below)

    def sum(self, a: Quotient, b: Quotient, factor: Fraction | int = 1) -> Quotient:
        """a + factor * b."""
        below = {n: max(a.below.get(n, 0), b.below.get(n, 0)) for n in {**a.below, **b.below}}
        above = self.over(a, below, a.below), self.over(b, below, b.below)
        return Quotient(self.plus(*above, factor), below)

    def over(self, a: Quotient, below: Mapping[str, int], own: Mapping[str, int]) -> Poly:
        """a.above times the bases of `below` that are missing in `own`."""
        above = a.above
        for n in below:
            if below[n] > own.get(n, 0):
                above = self.times(above, self.power(self.bases[n], below[n] - own.get(n, 0)))
        return above

    def read(self, text: object) -> Quotient:
        """The expression of a text: + - * / ** ( ), numbers and names."""
        _need(isinstance(text, str), "expected a text where there is none")
        return _Reader(self, str(text)).whole()

    def value(self, p: Poly, at: Mapping[str, Fraction]) -> Fraction:
        """At values of the names that it uses."""
        numbers = [at.get(n, Fraction(0)) for n in self.names]
        size = max(max(map(sum, p), default=0), 1) * self.bits([*numbers, *p.values()])
        self.spend(len(p) * (1 + (size * size >> 17)))
        terms = (x * math.prod(map(pow, numbers, k)) for k, x in p.items())
        return sum(terms, Fraction(0))

    def uses(self, *quotients: Quotient) -> set[str]:
        """The names that occur."""
        polys = [p for q in quotients for p in (q.above, *(self.bases[n] for n in q.below))]
        return {self.names[i] for p in polys for k in p for i, power in enumerate(k) if power}


class _Reader:
    """Recursive descent: sum, product, power, atom."""

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
        """The next token if it is one of these, and taken; "" if not."""
        return self.tokens.pop() if self.tokens and self.tokens[-1] in expected else ""

    def whole(self) -> Quotient:
        result = self.sum(0)
        _need(not self.tokens, f"cannot read {ascii(self.text[:60])}")
        return result

    def sum(self, depth: int) -> Quotient:
        _need(depth <= NESTING, "nested too deeply")
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
            _need(digits.isdigit() and len(digits) < 5, "an exponent that is no small integer")
            _need(not inner or self.next(")"), "an exponent that is no small integer")
            result = self.raised(result, sign * int(digits))
        return result

    def raised(self, a: Quotient, n: int) -> Quotient:
        if n < 0:
            inverse = self.algebra.invert(a.above)
            a = Quotient(self.algebra.over(inverse, a.below, {}), inverse.below)
        above = a.above if abs(n) == 1 else self.algebra.power(a.above, abs(n))
        return Quotient(above, {name: abs(n) * k for name, k in a.below.items()})

    def atom(self, depth: int) -> Quotient:
        _need(self.tokens, f"cannot read {ascii(self.text[:60])}")
        token = self.tokens.pop()
        if token == "(":
            result = self.sum(depth + 1)
            _need(self.next(")"), f"cannot read {ascii(self.text[:60])}")
            return result
        if token[0].isdigit():
            return Quotient(self.algebra.number(Fraction(token)), {})
        _need(token.isidentifier(), f"cannot read {ascii(self.text[:60])}")
        return Quotient(self.algebra.name(token), {})


def _is(kind: type, value: Any, what: str) -> Any:
    _need(type(value) is kind, f"{what}: expected {kind.__name__}, found {type(value).__name__}")
    return value


def _words(value: Any, what: str) -> list[str]:
    """Names that may be declared: plain ASCII words, each once."""
    names: list[str] = _is(list, value, what)
    for n in names:
        fits = type(n) is str and len(n) <= NAMES and re.fullmatch(r"[A-Za-z]\w*", n, re.ASCII)
        _need(fits and "__" not in n, f"{what}: a name that is no plain word")
    _need(len(set(names)) == len(names) <= NAMES, f"{what}: a name twice, or too many")
    return names


def _number(text: Any, what: str) -> Fraction:
    fits = type(text) is str and len(text) <= DIGITS and _NUMBER.fullmatch(text)
    _need(fits, f"{what}: expected a fraction such as -1/2")
    return Fraction(text)


def _fields(c: dict[str, Any], *names: str) -> None:
    _need({*c} == {*names}, f"expected exactly the fields {', '.join(sorted(names))}")


@dataclass(frozen=True)
class Meaning:
    """The expressions of a storage certificate, for given signs or in general."""

    algebra: Algebra
    assumed: dict[str, Quotient]
    invariants: dict[str, Quotient]
    decays: dict[str, Quotient]
    rates: dict[str, Quotient]
    storage: Quotient
    supply: Quotient
    signs: dict[str, int]

    @property
    def factors(self) -> dict[str, Quotient]:
        """What is >= 0: assumptions, invariants and sizes."""
        sizes = {f"abs_{x}": Quotient(self.algebra.name(f"abs_{x}"), {}) for x in self.signs}
        return self.assumed | self.invariants | sizes

    @property
    def goals(self) -> dict[str, Quotient]:
        """What has to be shown to be >= 0."""
        algebra = self.algebra
        goals = {"storage": self.storage}
        goals["supply"] = algebra.sum(self.supply, self._change(self.storage), -1)
        for n, h in self.invariants.items():
            goals[n] = algebra.sum(self._change(h), algebra.product(self.decays[n], h))
        return goals

    def _change(self, e: Quotient) -> Quotient:
        """Rate of change: the sum of slope times rate over the states; none stands below."""
        total = Quotient({}, {})
        for x, rate in self.rates.items():
            i = self.algebra.names.index(x)
            slope: Poly = {}
            for k, a in e.above.items():
                if k[i]:
                    slope[(*k[:i], k[i] - 1, *k[i + 1 :])] = k[i] * a
            one = self.algebra.product(Quotient(slope, e.below), rate)
            total = self.algebra.sum(total, one, self.signs.get(x, 1))
        return total


class Storage:
    """The content of a storage certificate, refused here for all but its identities."""

    def __init__(self, c: dict[str, Any]) -> None:
        _fields(c, "kind", "title", "digest", "constants", "signals", "rates", "signs", "positive",
                "nonnegative", "invariant", "supply", "storage", "proofs", "example")  # fmt: skip
        for field in ("positive", "nonnegative", "invariant", "rates", "proofs", "example"):
            _is(dict, c[field], field)
        self.c, self.signs, self.states = (
            c,
            _words(c["signs"], "signs"),
            _words([*c["rates"]], "rates"),
        )
        self.constants, self.signals = (_words(c[k], k) for k in ("constants", "signals"))
        self.words = _words([*self.constants, *self.signals, *self.states], "names")
        _need(not any(n.startswith(("abs_", "sign_")) for n in self.words), "abs_, sign_ declared")
        _need({*self.signs} <= {*self.signals, *self.states}, "signs: neither signal nor state")
        _need(len(self.signs) <= SIGNS, f"signs: more than {SIGNS}")
        factors = [*c["positive"], *c["nonnegative"], *c["invariant"]]
        _words([*factors, "storage", "supply", *(f"abs_{x}" for x in self.signs)], "factors")
        _need(self.states or not c["invariant"], "an invariant without states")
        for n, h in c["invariant"].items():
            _fields(_is(dict, h, n), "expression", "rate")
        self.left = [EFFORT]
        self.affine = self._check_dependence()
        self.cases = [
            self._meaning(dict(zip(self.signs, signs, strict=True)))
            for signs in itertools.product((1, -1), repeat=len(self.signs))
        ]
        for case in self.cases:
            self._check_example(case)

    def _meaning(self, signs: dict[str, int], zero: str = "") -> Meaning:
        """With x = sign * X and X called x, for x in `signs`; with `zero` = 0."""
        c, names = self.c, [*self.words, *(p + x for x in self.signs for p in ("abs_", "sign_"))]
        algebra = Algebra(names, self.left)
        for x, s in signs.items():
            size = {} if x == zero else algebra.name(x)
            algebra.put[x] = {k: s * a for k, a in size.items()}
            algebra.put[f"abs_{x}"], algebra.put[f"sign_{x}"] = size, algebra.number(s)
        if zero:
            algebra.put[zero] = algebra.put[f"abs_{zero}"] = {}
        read = algebra.read
        positive = {n: read(e) for n, e in c["positive"].items()}
        _need(not any(e.below for e in positive.values()), "positive: a division")
        algebra.bases.update({n: e.above for n, e in positive.items()})
        return Meaning(
            algebra,
            positive | {n: read(e) for n, e in c["nonnegative"].items()},
            {n: read(h["expression"]) for n, h in c["invariant"].items()},
            {n: read(h["rate"]) for n, h in c["invariant"].items()},
            {x: read(e) for x, e in c["rates"].items()},
            read(c["storage"]),
            read(c["supply"]),
            signs,
        )

    def _check_dependence(self) -> list[str]:
        """(1) and (3) of the proof; returns the x for which (5) holds."""
        general = self._meaning({})
        uses, inner = general.algebra.uses, [general.storage, *general.invariants.values()]
        free = {*self.constants, *self.signals, *(f"abs_{x}" for x in self.signs)}
        free -= {f"abs_{x}" for x in self.states}
        for n, e in general.assumed.items():
            _need(uses(e) <= free, f"{n}: a state or a sign is assumed")
        bent = [x for x in self.states if {f"abs_{x}", f"sign_{x}"} & uses(*inner)]
        held = {*self.constants, *self.states, *(p + x for x in bent for p in ("abs_", "sign_"))}
        _need(uses(*inner) <= held, "V or h depends on a signal")
        for x in bent:
            _need(f"sign_{x}" not in uses(*general.rates.values()), f"V or h bends, {x}' jumps")
            right, left = (self._meaning({x: s}, zero=x) for s in (1, -1))
            same = (right.storage, right.invariants) == (left.storage, left.invariants)
            _need(same, f"V or h jumps at {x} = 0")
        rest = [
            i for i, n in enumerate(general.algebra.names) if n.removeprefix("abs_") in self.states
        ]
        _need(all(any(k[i] for i in rest) for k in general.storage.above), "V is not 0 at rest")
        return [x for x in self.signs if self._is_affine(x)]

    def _is_affine(self, x: str) -> bool:
        """Whether all that is integrated is affine in sign_x at x = 0."""
        m = self._meaning({}, zero=x)
        i = m.algebra.names.index(f"sign_{x}")
        quotients = [m.supply, *m.rates.values(), *m.decays.values()]
        return all(k[i] < 2 for e in quotients for k in e.above)

    def _check_example(self, case: Meaning) -> None:
        """It meets all that is assumed, as given and at rest."""
        given = {n: _number(x, "example") for n, x in self.c["example"].items()}
        _need({*given} <= {*self.words}, "example: an unknown name")
        _need(all(given.get(x, 0) >= 0 for x in self.signs), "example: a size below 0")
        rest = {x: Fraction(0) for x in (*self.states, *self.signs)}
        for at, (n, e) in itertools.product((rest | given, given | rest), case.factors.items()):
            missing = case.algebra.uses(e) - {*at}
            _need(not missing, f"example: no value of {', '.join(sorted(missing))}")
            value = case.algebra.value(e.above, at)  # what is below is itself shown to be > 0
            holds = value > 0 or (value == 0 and n not in self.c["positive"])
            _need(holds, f"example: {n} does not hold")

    def check_proofs(self) -> None:
        """(2) of the proof: every inequality by an identity."""
        proofs = self.c["proofs"]
        goals = {"storage", "supply", *self.c["invariant"]}
        _need({*proofs} == goals, f"proofs: expected exactly {', '.join(sorted(goals))}")
        cases = {" ".join(map(str, case.signs.values())): case for case in self.cases}
        for goal, by_signs in proofs.items():
            _need({*_is(dict, by_signs, goal)} == {*cases}, f"{goal}: signs missing or unknown")
        for signs, case in cases.items():
            for goal, left in case.goals.items():
                for term in _is(list, proofs[goal][signs], goal):
                    left = case.algebra.sum(left, self._term(case, goal, term), -1)
                _need(not left.above, f"{goal}: no identity")

    def _term(self, case: Meaning, goal: str, term: Any) -> Quotient:
        """weight * factors^powers * square >= 0."""
        _need(type(term) is list and len(term) == 3, f"{goal}: expected weight, powers, square")
        algebra, weight = case.algebra, _number(term[0], goal)
        _need(weight >= 0, f"{goal}: a negative weight")
        square = algebra.read(term[2])
        product = algebra.product(Quotient(algebra.number(weight), {}), square)
        product = algebra.product(product, square)
        known = case.factors
        for n, power in _is(dict, term[1], goal).items():
            fits = n in known and not {n, goal} <= {*case.invariants}
            _need(fits, f"{goal}: a factor that is not known to be >= 0")
            _need(abs(_is(int, power, goal)) <= DEGREE, f"{goal}: a power too large")
            _need(power >= 0 or n in self.c["positive"], f"{goal}: divides by what may be 0")
            below = {b: k * power for b, k in known[n].below.items()} if power > 0 else {n: -power}
            above = algebra.power(known[n].above, max(power, 0))
            product = algebra.product(product, Quotient(above, below if power else {}))
        return product

    def statement(self) -> str:
        """What is proved, from the content alone."""
        c = self.c
        supply = _flat(c["supply"])
        assumed = [f"{_flat(e)} > 0" for _, e in sorted(c["positive"].items())]
        assumed += [f"{_flat(e)} >= 0" for _, e in sorted(c["nonnegative"].items())]
        invariants = [h for _, h in sorted(c["invariant"].items())]
        start = ", ".join(f"{_flat(h['expression'])} >= 0" for h in invariants)
        decays = ", ".join(sorted({_flat(h["rate"]) for h in invariants}))
        parts = []
        if self.states:
            parts += [f"the integral of {supply} is never less than the change of the storage V"]
            parts += [f"V = {_flat(c['storage'])} >= 0 (V = 0 at rest)"]
            parts += [f"where d/dt {x} = {_flat(e)}" for x, e in sorted(c["rates"].items())]
            if invariants:
                parts += [f"from every start with {start}, kept for locally bounded {decays}"]
        else:
            parts += [f"{supply} >= 0"]
        parts += [f"for {k} {', '.join(c[k])}" for k in ("constants", "signals") if c[k]]
        for x in self.signs:
            zero = "from -1 to 1" if x in self.affine else "1 or -1"
            parts += [f"sign_{x} is the sign of {x}, at 0 {zero}; abs_{x} = sign_{x}*{x}"]
        parts += [f"as long as {', '.join(assumed)}"] if assumed else []
        values = ", ".join(f"{n} = {x}" for n, x in sorted(c["example"].items()))
        return "; ".join(parts + ([f"met for example by {values}"] if values else []))


def _flat(text: str) -> str:
    return " ".join(text.split())


def _remainders(algebra: Algebra, a: Poly, b: Poly, sign: int) -> list[Poly]:
    """Euclid's chain a, b, sign * rest ..., each scaled by a positive number."""
    chain = [a, b]
    while chain[-1]:
        rest = algebra.divided(chain[-2], chain[-1])[1]
        size = abs(rest[max(rest)]) if rest else Fraction(1)
        chain.append({k: sign * x / size for k, x in rest.items()})
    return chain[:-1]


def _is_hurwitz(algebra: Algebra, p: Poly) -> bool:
    """Whether all zeros have a negative real part (Routh)."""
    degree = max(p)[0]
    upper = {k: x / p[max(p)] for k, x in p.items() if (degree - k[0]) % 2 == 0}
    lower = {k: x / p[max(p)] for k, x in p.items() if (degree - k[0]) % 2}
    for n in range(degree, 0, -1):
        if lower.get((n - 1,), 0) <= 0:
            return False
        ratio: Poly = {(1,): upper[(n,)] / lower[(n - 1,)]}
        upper, lower = lower, algebra.plus(upper, algebra.times(ratio, lower), -1)
    return True


def _is_non_negative(algebra: Algebra, p: Poly) -> bool:
    """Whether p(x) >= 0 for all x >= 0: no zero of odd multiplicity at x > 0 (Sturm)."""
    if not p or p[max(p)] < 0:
        return not p
    common = _remainders(algebra, p, _slope(p), 1)[-1]
    simple, multiplicity = algebra.divided(p, common)[0], 1
    while max(simple)[0] > 0:  # simple: all zeros of this multiplicity or more
        more = _remainders(algebra, simple, common, 1)[-1]
        if multiplicity % 2 and _positive_zeros(algebra, algebra.divided(simple, more)[0]):
            return False
        simple, common = more, algebra.divided(common, more)[0]
        multiplicity += 1
    return True


def _slope(p: Poly) -> Poly:
    return {(k - 1,): k * x for (k,), x in p.items() if k}


def _positive_zeros(algebra: Algebra, p: Poly) -> int:
    """Number of zeros x > 0 of a polynomial without multiple zeros."""
    if (0,) not in p:
        p = {(k - 1,): x for (k,), x in p.items()}
    chain = _remainders(algebra, p, _slope(p), -1)
    ends = [q.get((0,), Fraction(0)) for q in chain], [q[max(q)] for q in chain if q]
    at_zero, far = (
        sum(a * b < 0 for a, b in itertools.pairwise([x for x in e if x])) for e in ends
    )
    return at_zero - far


def _positive_real(c: dict[str, Any]) -> str:
    """The statement of a certificate of the other kind; refused where it is not true."""
    _fields(c, "kind", "title", "digest", "impedance")
    rows = [_is(list, row, "impedance") for row in _is(list, c["impedance"], "impedance")]
    size = len(rows)
    _need(size in (1, 2) and all(len(row) == size for row in rows), "impedance: not 1x1 or 2x2")
    algebra = Algebra(["s"], [EFFORT], divides=True)
    plus, times = algebra.plus, algebra.times
    z = [[algebra.read(e) for e in row] for row in rows]
    below = {n: max(e.below.get(n, 0) for row in z for e in row) for n in algebra.bases}
    q = algebra.over(Quotient(algebra.number(1), {}), below, {})
    above = [[algebra.over(e, below, e.below) for e in row] for row in z]
    m, w = [[list(row) for row in above] for _ in "mw"]  # Z + 1 and Z - 1, times q
    for i in range(size):
        m[i][i], w[i][i] = plus(above[i][i], q), plus(above[i][i], q, -1)

    def cross(a: list[list[Poly]]) -> Poly:
        return plus(times(a[0][0], a[1][1]), times(a[0][1], a[1][0]), -1)

    d = m[0][0] if size == 1 else cross(m)
    _need(d, "Z + 1 is singular")
    if size == 2:  # times the adjoint matrix
        adjoint = [[m[1][1], plus({}, m[0][1], -1)], [plus({}, m[1][0], -1), m[0][0]]]
        w = [[plus(times(w[i][0], adjoint[0][j]), times(w[i][1], adjoint[1][j])) for j in (0, 1)]
             for i in (0, 1)]  # fmt: skip
    common = d
    for e in itertools.chain(*w):
        common = _remainders(algebra, common, e, 1)[-1]
    d, w = algebra.divided(d, common)[0], [[algebra.divided(e, common)[0] for e in r] for r in w]
    _need(_is_hurwitz(algebra, d), "not positive real: (Z - 1)/(Z + 1) is not stable")

    def paired(a: Poly, b: Poly) -> Poly:
        return times({k: x * (-1) ** k[0] for k, x in a.items()}, b)

    gap = [[paired(d, d) if i == j else {} for j in range(size)] for i in range(size)]
    for i, j, k in itertools.product(range(size), repeat=3):
        gap[i][j] = plus(gap[i][j], paired(w[k][i], w[k][j]), -1)
    for minor in [gap[0][0]] if size == 1 else [gap[0][0], gap[1][1], cross(gap)]:
        _need(not any(k % 2 for (k,) in minor), "not positive real: odd on the axis")
        over_frequency: Poly = {(k // 2,): x * (-1) ** (k // 2) for (k,), x in minor.items()}
        _need(_is_non_negative(algebra, over_frequency), "not positive real: Re Z < 0 on the axis")
    text = ", ".join("[" + ", ".join(map(_flat, row)) + "]" for row in rows)
    return f"Z(s) = [{text}] is positive real: analytic with Z + Z^H >= 0 for Re s > 0"


def read(content: object) -> tuple[dict[str, Any], Storage | None]:
    """A certificate without its proofs: its fields, and what it means if it is a storage."""
    c: dict[str, Any] = _is(dict, content, "certificate")
    for field in ("kind", "title", "digest"):
        _is(str, c.get(field), field)
    try:
        body = {k: v for k, v in c.items() if k != "digest"}
        text = json.dumps(body, sort_keys=True, allow_nan=False)
    except (TypeError, ValueError, RecursionError):
        raise Refused("refused: not plain data, or nested too deeply") from None
    digest = hashlib.sha256(text.encode()).hexdigest()
    _need(len(text) <= FILE and digest == c["digest"], "changed since it was written, or too long")
    _need(c["kind"] in ("storage", "positive real"), "kind: expected storage or positive real")
    return c, Storage(c) if c["kind"] == "storage" else None


def check(content: object) -> str:
    """The statement that a certificate (data as read from JSON) proves; Refused where none."""
    c, storage = read(content)
    if storage is None:
        return _positive_real(c)
    storage.check_proofs()
    return storage.statement()


def load(path: str) -> object:
    """The data of a JSON file; Refused where it is none."""

    def once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        _need(len(dict(pairs)) == len(pairs), "a field twice")
        return dict(pairs)

    try:
        with open(path, "rb") as file:
            data = file.read(FILE + 1)
        _need(len(data) <= FILE, "too long")
        return json.loads(data.decode("utf-8"), object_pairs_hook=once)
    except Refused:
        raise
    except (OSError, ValueError, RecursionError) as problem:
        raise Refused(f"refused: no certificate: {type(problem).__name__}") from None


def main(paths: list[str]) -> int:
    """Print a line for each file; 1 if any proves nothing, 2 without files."""
    status = 0 if paths else 2
    for path in paths:
        try:
            line = f"proved: {check(load(path))}"
        except Refused as problem:
            line, status = str(problem), 1
        print(f"{ascii(path)[1:-1]}: {line}")
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
