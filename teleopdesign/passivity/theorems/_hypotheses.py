"""Hypotheses of a theorem about its numbers: types of its arguments, checked at every call.

    @require_hypotheses
    def sampled_passivity(controller: Free, *, damping: NonNegative, sample_time: Positive): ...

A number outside of the hypotheses is refused in one line (ModelError), because the theorem does not
hold for it. A theorem receives its numbers exactly, as rationals, and states them for a prismatic
axis; with `axis="revolute"` the claim is in the units of that axis.

Certificates of theorems, from `certificates.toml`, are storage functions for all parameters. There
v is the velocity, p or y the friction force of the plant and d the force of the compensator; the
rate of Dahl friction comes from the effect `presliding`.
"""

from __future__ import annotations

import inspect
import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from fractions import Fraction
from functools import lru_cache, wraps
from itertools import product
from pathlib import Path
from typing import Annotated, Any, get_args

import sympy as sp

from ...base.errors import ModelError, did_you_mean
from ...base.units import AXES
from ...effects import EFFECTS
from ..claims.certificate import Certificate, checker_text, seal
from ..claims.claim import Claim, use_units_of
from ..linear.impedance import exact

Claiming = Callable[..., Claim]
#: most samples or paths: each costs time, and a thousand late samples already take a second
_MOST = 10_000
#: smallest and largest size of a number that is not 0, SI: no machine is near these ends, and
#: products of five such numbers, and their squares, still fit into double precision, in which
#: motions are searched and replayed
_SMALLEST, _LARGEST = Fraction(1, 10**30), Fraction(10**30)


@dataclass(frozen=True)
class Hypothesis:
    """A condition on one argument of a theorem.

    text: for messages, such as "a number > 0";  holds: whether a value meets the condition
    received: the value as the theorem receives it
    """

    text: str
    holds: Callable[[Any], bool]
    received: Callable[[Any], Any] = lambda value: value

    def or_none(self) -> Hypothesis:
        """The same condition, with None allowed as well."""
        return replace(
            self,
            text=f"{self.text} or None",
            holds=lambda x: x is None or self.holds(x),
            received=lambda x: None if x is None else self.received(x),
        )


def _is_of_size(number: sp.Rational) -> bool:
    return bool(number == 0 or _SMALLEST <= abs(number) <= _LARGEST)


def _real(text: str, holds: Callable[[sp.Rational], Any]) -> Hypothesis:
    """A condition on a number: 0 or of a size from 1e-30 to 1e30, and `holds`."""
    return Hypothesis(text, lambda x: _is_of_size(exact(x)) and bool(holds(exact(x))), exact)


POSITIVE = _real("a number > 0", lambda x: x > 0)
NOT_NEGATIVE = _real("a number >= 0", lambda x: x >= 0)
REAL = _real("a finite number", lambda x: True)
WHOLE = Hypothesis(
    f"a whole number >= 0, at most {_MOST}",
    lambda x: bool(0 <= exact(x) <= _MOST and exact(x) == sp.floor(exact(x))),
    int,
)
#: no condition: the function itself checks the argument
FREE = Hypothesis("anything", lambda x: True)


def one_of(*values: Any) -> Hypothesis:
    """The condition that an argument is one of these values."""
    return Hypothesis(" or ".join(map(str, values)), lambda x: x in values)


Positive = Annotated[Any, POSITIVE]
PositiveOrNone = Annotated[Any, POSITIVE.or_none()]
NonNegative = Annotated[Any, NOT_NEGATIVE]
Real = Annotated[Any, REAL]
Whole = Annotated[int, WHOLE]
Free = Annotated[Any, FREE]


def require_hypotheses(function: Claiming) -> Claiming:
    """Decorator of a theorem on numbers: checks the hypothesis of each argument at every call.

    The theorem has one more argument, `axis`: "prismatic" or "revolute".

    raises ModelError: at a call, an argument that violates its hypothesis; at the definition, an
        argument without a hypothesis
    """
    signature = inspect.signature(function, eval_str=True)
    notes = {n: get_args(p.annotation) for n, p in signature.parameters.items()}
    hypotheses = {n: h for n, some in notes.items() for h in some if isinstance(h, Hypothesis)}
    if odd := sorted(set(notes) - set(hypotheses)):
        raise ModelError(f"{function.__name__}: arguments without hypothesis: {odd}")

    @wraps(function)
    def call(*arguments: Any, axis: str = "prismatic", **named: Any) -> Claim:
        if axis not in AXES:
            raise ModelError(
                f'{function.__name__}: axis: found "{axis}", expected {" or ".join(AXES)}'
                f"{did_you_mean(str(axis), AXES)}"
            )
        bound = signature.bind(*arguments, **named)
        bound.apply_defaults()
        for name, value in bound.arguments.items():
            bound.arguments[name] = _receive(function.__name__, name, value, hypotheses[name])
        return use_units_of(axis, function(*bound.args, **bound.kwargs))

    call.hypotheses = hypotheses  # type: ignore[attr-defined]
    return call


def _receive(function: str, name: str, value: Any, needs: Hypothesis) -> Any:
    """The value as the theorem receives it; raises ModelError: it violates its hypothesis."""
    try:
        if needs.holds(value):
            return needs.received(value)
        off = isinstance(value, int | float) and not _is_of_size(exact(value))
    except ModelError as error:
        raise ModelError(f"{function}: {name}: {error}") from None
    sizes = " of a size from 1e-30 to 1e30" if off else ""
    raise ModelError(f"{function}: {name}: expected {needs.text}{sizes}, found {value}")


_NAME = re.compile(r"[A-Za-z_]\w*")


def certificate(name: str, **values: sp.Expr | int) -> Certificate:
    """A certificate of the file; it holds for all parameters that meet its inequalities.

    values: an example of them, by the names of the file
    """
    content = _whole(name)
    example = _entry(name).get("example", {})
    symbols = {sp.Symbol(n, real=True): x for n, x in values.items()}
    numbers = {n: _read(text).subs(symbols) for n, text in example.items()} | values
    texts = {n: checker_text(numbers[n]) for n in content["example"] if n in numbers}
    return seal({**content, "example": texts})


def dahl_rate(force: sp.Expr, level: sp.Expr, stiffness: sp.Expr) -> sp.Expr:
    """Rate df/dt of the force f of Dahl friction (N/s), with abs_v for abs(v)."""
    v, abs_v = sp.symbols("v abs_v", real=True)
    now = {"velocity": v, "level": level, "bristle": force / stiffness}
    rates = EFFECTS["presliding"].rates(now, {"stiffness": stiffness})
    return sp.expand(stiffness * rates["bristle"].subs(sp.Abs(v), abs_v))


@lru_cache(maxsize=1)
def _entries() -> dict[str, dict[str, Any]]:
    return tomllib.loads(Path(__file__).with_name("certificates.toml").read_text(encoding="utf-8"))


def _entry(name: str) -> dict[str, Any]:
    """An entry of the file, with what it has in common with another."""
    entry = _entries()[name]
    like = _entries().get(entry.get("like", ""), {})
    return {**like, **entry, "proofs": {**like.get("proofs", {}), **entry["proofs"]}}


@lru_cache(maxsize=64)
def _whole(name: str) -> Mapping[str, Any]:
    """The content of a certificate without digest; its example has no values yet."""
    entry = _entry(name)
    signs, constants = entry.get("signs", []), sorted(entry.get("constants", []))
    read: list[sp.Expr] = []

    def text(expression: str) -> str:
        read.append(_read(expression))
        return checker_text(read[-1])

    def each(field: str) -> dict[str, str]:
        return {n: text(expression) for n, expression in entry.get(field, {}).items()}

    pairs = entry.get("invariant", {}).items()
    content = {
        "kind": "storage",
        "title": entry["title"],
        "constants": constants,
        "positive": each("positive"),
        "nonnegative": each("nonnegative"),
        "rates": each("rates"),
        "supply": text(entry["supply"]),
        "storage": text(entry.get("storage", "0")),
        "signs": signs,
        "invariant": {n: {"expression": text(h), "rate": text(rate)} for n, (h, rate) in pairs},
    }
    names = {x.name for e in read for x in e.free_symbols} | {*signs}
    names -= {prefix + x for x in signs for prefix in ("abs_", "sign_")}
    proofs = {"storage": {}, **entry["proofs"]}
    return {
        **content,
        "signals": sorted(names - {*content["rates"], *constants}),
        "proofs": {goal: _cases(terms, signs) for goal, terms in proofs.items()},
        "example": dict.fromkeys(names),
    }


def _cases(terms: Mapping[str, Sequence[str]], signs: Sequence[str]) -> dict[str, list[Any]]:
    """Terms of each case of the signs: those of all cases, and those of a pattern that fits."""
    cases = (" ".join(case) for case in product(("1", "-1"), repeat=len(signs)))
    return {
        case: [
            _term(one)
            for pattern, listed in terms.items()
            if pattern == "all" or fnmatchcase(case, pattern)
            for one in listed
        ]
        for case in cases
    }


def _term(text: str) -> list[Any]:
    """A term such as "1/2 abs_v F^-1 [p]": weight, factor -> power, root."""
    head, _, root = text.partition("[")
    weight, powers = "1", {}
    for word in head.split():
        if word[0].isdigit():
            weight = word
        else:
            factor, _, power = word.partition("^")
            powers[factor] = int(power or 1)
    return [weight, powers, checker_text(_read(root.removesuffix("]") or "1"))]


def _read(text: str) -> sp.Expr:
    names: dict[str, Any] = {n: sp.Symbol(n, real=True) for n in _NAME.findall(text)}
    return sp.sympify(text, {**names, "dahl": dahl_rate, "expand": sp.expand}, rational=True)
