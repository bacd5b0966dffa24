"""Certificates: what a proof rests on, in a form that a small program verifies.

`checker` does not use this package. It reads the JSON file that is written here, and states in its
own words what the file proves. A title is for readers only and proves nothing.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import sympy as sp

from ...arguments import check_types
from ...errors import ModelError
from ...plain_data import write_text
from ..checker import Refused, check, load

#: weight * product of factor^power * square^2
Term = tuple[sp.Expr | int, Mapping[str, int], sp.Expr | int]


@check_types
@dataclass(frozen=True, repr=False)
class Certificate:
    """What the checker reads; `content` is plain JSON data with a digest."""

    content: Mapping[str, Any]

    @property
    def kind(self) -> str:
        """ "storage", "positive real", "absolute stability", or one "... over a box"."""
        return str(self.content.get("kind", "no kind"))

    def check(self) -> str:
        """Verify with `checker`.

        returns: the statement that is proved, which the checker makes from the content
        raises ModelError: refused, and why
        """
        try:
            return check(dict(self.content))
        except Refused as problem:
            raise ModelError(f"certificate: {problem}") from None

    def __repr__(self) -> str:
        return f"Certificate ({self.kind}): {self.content.get('title', '')}"

    def write(self, path: str | Path) -> None:
        """Write the JSON file that `python -m teleopdesign.passivity.checker PATH` verifies."""
        text = json.dumps(self.content, indent=1, sort_keys=True)
        write_text(path, text + "\n")


def read_certificate(path: str | Path) -> Certificate:
    """Read a certificate; it proves nothing before `check` accepted it.

    path: a JSON file;  raises ModelError: not readable, or no certificate
    """
    try:
        content = load(str(path))
    except Refused as problem:
        raise ModelError(f"{path}: {problem}") from None
    if not isinstance(content, dict):
        raise ModelError(f"{path}: no certificate: expected named fields")
    return Certificate(content)


def positive_real_certificate(title: str, impedance: Sequence[Sequence[sp.Expr]]) -> Certificate:
    """That a matrix of rational functions of s (6x6 at most) is positive real."""
    rows = [[checker_text(e) for e in row] for row in impedance]
    return seal({"kind": "positive real", "title": title, "impedance": rows})


def absolute_stability_certificate(
    title: str, impedance: Sequence[Sequence[sp.Expr]]
) -> Certificate:
    """That a 2x2 matrix of rational functions of s is absolutely stable, residues included."""
    rows = [[checker_text(e) for e in row] for row in impedance]
    return seal({"kind": "absolute stability", "title": title, "impedance": rows})


def storage_certificate(
    title: str,
    *,
    supply: sp.Expr,
    storage: sp.Expr | int = 0,
    rates: Mapping[str, sp.Expr] | None = None,
    constants: Sequence[str] = (),
    positive: Mapping[str, sp.Expr] | None = None,
    nonnegative: Mapping[str, sp.Expr] | None = None,
    invariant: Mapping[str, tuple[sp.Expr, sp.Expr]] | None = None,
    signs: Sequence[str] = (),
    proofs: Mapping[str, Mapping[str, Sequence[Term]]],
    example: Mapping[str, sp.Expr | int],
) -> Certificate:
    """That supply >= dV/dt with V >= 0 wherever the assumptions hold.

    rates: state -> rate of change;  constants: names that do not change; other names are signals
    positive, nonnegative: name -> expression that is assumed to be > 0, >= 0
    invariant: name -> (h, rate): h >= 0 at the start is kept, for h' + rate h >= 0
    signs: signals and states x with sign_x and abs_x; `proofs` has an entry for each
        combination of signs, "1 -1", or "" for all of them
    proofs: "supply", "storage" or invariant -> signs -> terms (weight, factor -> power, square)
    example: values that meet all assumptions (for `signs` the size)
    """
    rates, invariant = rates or {}, invariant or {}
    positive, nonnegative = positive or {}, nonnegative or {}
    used = [supply, storage, *rates.values(), *positive.values(), *nonnegative.values()]
    used += [e for pair in invariant.values() for e in pair]
    names = {s.name for e in used for s in sp.sympify(e).free_symbols} | {*signs}
    known = {*rates, *constants, *(prefix + x for x in signs for prefix in ("abs_", "sign_"))}
    cases = _cases(len(signs))
    content = {
        "kind": "storage",
        "title": title,
        "constants": sorted(constants),
        "signals": sorted(names - known),
        "positive": _text(positive),
        "nonnegative": _text(nonnegative),
        "rates": _text(rates),
        "supply": checker_text(supply),
        "storage": checker_text(storage),
        "signs": list(signs),
        "invariant": {
            n: {"expression": checker_text(h), "rate": checker_text(rate)}
            for n, (h, rate) in invariant.items()
        },
        "proofs": {
            goal: {case: _terms(by_case.get(case, by_case.get("", ()))) for case in cases}
            for goal, by_case in proofs.items()
        },
        "example": _text({n: e for n, e in example.items() if n in {*names, *rates, *constants}}),
    }
    return seal(content)


def _cases(number: int) -> list[str]:
    cases = [""]
    for _ in range(number):
        cases = [f"{case} {s}".strip() for case in cases for s in (1, -1)]
    return cases


def _text(expressions: Mapping[str, sp.Expr | int]) -> dict[str, str]:
    return {name: checker_text(e) for name, e in expressions.items()}


def _terms(terms: Sequence[Term]) -> list[list[object]]:
    return [[checker_text(w), dict(powers), checker_text(e)] for w, powers, e in terms]


def checker_text(expression: sp.Expr | int) -> str:
    """Text that the checker reads; ModelError for what is not rational, floats included."""
    e = sp.sympify(expression)
    for part in sp.preorder_traversal(e):
        rational = part.is_Rational or part.is_Symbol or part.is_Add or part.is_Mul
        if not rational and not (part.is_Pow and part.exp.is_Integer):
            raise ModelError(f"certificate: found {part} in {e}, expected a rational expression")
    return str(e)


def seal(content: dict[str, Any]) -> Certificate:
    """With the digest that `checker` expects."""
    text = json.dumps(content, sort_keys=True)
    return Certificate({**content, "digest": hashlib.sha256(text.encode()).hexdigest()})
