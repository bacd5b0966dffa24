"""Certificates of the theorems, from `certificates.toml`: storage functions for all parameters.

The rate of Dahl friction comes from the effect `presliding`. v is the velocity, p or y the friction
force of the plant, d the force of the compensator.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping, Sequence
from fnmatch import fnmatchcase
from functools import lru_cache
from itertools import product
from pathlib import Path
from typing import Any

import sympy as sp

from ...effects import EFFECTS
from ..claims.certificate import Certificate, Term, checker_text, seal, storage_certificate

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

    def each(field: str) -> dict[str, sp.Expr]:
        return {n: _read(text) for n, text in entry.get(field, {}).items()}

    signs = entry.get("signs", [])
    proofs = {goal: _cases(terms, signs) for goal, terms in entry["proofs"].items()}
    inequalities = each("positive"), each("nonnegative")
    supply, storage = _read(entry["supply"]), _read(entry.get("storage", "0"))
    invariant = {n: tuple(map(_read, pair)) for n, pair in entry.get("invariant", {}).items()}
    every = [supply, storage, *each("rates").values(), *(e for p in invariant.values() for e in p)]
    every += [e for part in inequalities for e in part.values()]
    names = {x.name for e in every for x in e.free_symbols} | {*signs}
    known = {prefix + x for x in signs for prefix in ("abs_", "sign_")}
    made = storage_certificate(
        entry["title"],
        supply=supply,
        storage=storage,
        rates=each("rates"),
        constants=entry.get("constants", []),
        positive=inequalities[0],
        nonnegative=inequalities[1],
        invariant=invariant,
        signs=signs,
        proofs={"storage": {"": ()}, **proofs},
        example=dict.fromkeys(names - known, 0),
    )
    return {n: x for n, x in made.content.items() if n != "digest"}


def _cases(terms: Mapping[str, Sequence[str]], signs: Sequence[str]) -> dict[str, list[Term]]:
    """Terms of each case of the signs: those of all cases, and those of a pattern that fits."""
    cases = [" ".join(case) for case in product(("1", "-1"), repeat=len(signs))]
    patterns = {p: list(map(_term, texts)) for p, texts in terms.items() if p != "all"}
    common = list(map(_term, terms.get("all", ())))
    if not patterns:
        return {"": common}
    return {
        case: [*common, *(t for p, more in patterns.items() if fnmatchcase(case, p) for t in more)]
        for case in cases
        if any(fnmatchcase(case, p) for p in patterns)
    }


def _term(text: str) -> Term:
    """A term such as "1/2 abs_v F^-1 [p]": weight, factor -> power, root."""
    head, _, root = text.partition("[")
    weight, powers = sp.S(1), {}
    for word in head.split():
        if word[0].isdigit():
            weight = sp.Rational(word)
        else:
            factor, _, power = word.partition("^")
            powers[factor] = int(power or 1)
    return weight, powers, _read(root.removesuffix("]") or "1")


def _read(text: str) -> sp.Expr:
    names: dict[str, Any] = {n: sp.Symbol(n, real=True) for n in _NAME.findall(text)}
    return sp.sympify(text, {**names, "dahl": dahl_rate, "expand": sp.expand}, rational=True)
