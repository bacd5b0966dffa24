"""Certificates: what a proof rests on, in a form that a program of 80 lines verifies.

`check_certificate.py` knows nothing of this package; it reads the JSON that is written here.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import sympy as sp

from ..arguments import checked
from ..errors import ModelError
from .check_certificate import check

#: weight * product of factor^power * square^2
Term = tuple[sp.Expr | int, Mapping[str, int], sp.Expr | int]


@checked
@dataclass(frozen=True, repr=False)
class Certificate:
    """What the checker reads; `content` is plain JSON data with a digest."""

    content: Mapping[str, Any]

    @property
    def kind(self) -> str:
        """ "storage" or "positive real"."""
        return str(self.content.get("kind", "no kind"))

    def check(self) -> str:
        """Verify with `check_certificate.py`; returns the claim, ModelError where it is refused."""
        try:
            return str(check(dict(self.content)))
        except Exception as problem:  # whatever a tampered file trips over, it proves nothing
            raise ModelError(f"certificate: {problem}") from problem

    def __repr__(self) -> str:
        return f"Certificate ({self.kind}): {self.content.get('claim', '')}"

    def write(self, path: str | Path) -> None:
        """Write the JSON file that `python check_certificate.py PATH` verifies."""
        text = json.dumps(self.content, indent=1, sort_keys=True)
        Path(path).write_text(text + "\n", encoding="utf-8")


def read_certificate(path: str | Path) -> Certificate:
    """Read a certificate; it proves nothing before `check` accepted it."""
    try:
        return Certificate(json.loads(Path(path).read_text(encoding="utf-8")))
    except (OSError, ValueError) as problem:
        raise ModelError(f"{path}: no certificate: {problem}") from problem


def positive_real_certificate(claim: str, impedance: Sequence[Sequence[sp.Expr]]) -> Certificate:
    """That a matrix of rational functions of s (1x1 or 2x2) is positive real."""
    rows = [[str(sp.sympify(e)) for e in row] for row in impedance]
    return _sealed({"kind": "positive real", "claim": claim, "impedance": rows})


def storage_certificate(
    claim: str,
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
    """That supply >= dV/dt with V >= 0 wherever what is assumed holds.

    rates: state -> rate of change;  constants: names that do not change; other names are signals
    positive, nonnegative: name -> expression that is assumed to be > 0, >= 0
    invariant: name -> (h, rate): h >= 0 at the start is kept, for h' + rate h >= 0
    signs: signals x with sign_x and abs_x; `proofs` has an entry for each combination of signs,
        "1 -1", or "" for all of them
    proofs: "supply", "storage" or invariant -> signs -> terms (weight, factor -> power, square)
    example: values that meet all assumptions (for `signs` the size)
    """
    rates, invariant = rates or {}, invariant or {}
    positive, nonnegative = positive or {}, nonnegative or {}
    used = [supply, storage, *rates.values(), *positive.values(), *nonnegative.values()]
    used += [e for pair in invariant.values() for e in pair]
    names = {s.name for e in used for s in sp.sympify(e).free_symbols}
    names |= {*rates, *constants, *(p + x for x in signs for p in ("", "abs_", "sign_"))}
    cases = _cases(len(signs))
    content = {
        "kind": "storage",
        "claim": claim,
        "symbols": sorted(names),
        "constants": sorted(constants),
        "positive": _text(positive),
        "nonnegative": _text(nonnegative),
        "rates": _text(rates),
        "supply": str(supply),
        "storage": str(storage),
        "signs": list(signs),
        "invariant": {
            n: {"expression": str(h), "rate": str(rate)} for n, (h, rate) in invariant.items()
        },
        "proofs": {
            goal: {case: _terms(by_case.get(case, by_case.get("", ()))) for case in cases}
            for goal, by_case in proofs.items()
        },
        "example": _text(example),
    }
    return _sealed(content)


def _cases(number: int) -> list[str]:
    cases = [""]
    for _ in range(number):
        cases = [f"{case} {s}".strip() for case in cases for s in (1, -1)]
    return cases


def _text(expressions: Mapping[str, sp.Expr | int]) -> dict[str, str]:
    return {name: str(sp.sympify(e)) for name, e in expressions.items()}


def _terms(terms: Sequence[Term]) -> list[list[object]]:
    return [[str(sp.sympify(w)), dict(powers), str(sp.sympify(e))] for w, powers, e in terms]


def _sealed(content: dict[str, Any]) -> Certificate:
    """With the digest that `check_certificate.py` expects."""
    text = json.dumps(content, sort_keys=True)
    return Certificate({**content, "digest": hashlib.sha256(text.encode()).hexdigest()})
