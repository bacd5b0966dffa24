"""Certificates of proofs, in a form that a small separate program (`checker`) verifies.

`checker` does not use this package. It reads the JSON file of a certificate and makes the statement
that the file proves from its contents. The title is for readers only and proves nothing.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any, Literal

import sympy as sp

from ...base.arguments import check_types
from ...base.errors import ModelError
from ...base.files import write_text
from ...base.shown import Shown
from ..checker import Refused, check, load

#: one term of an identity, (weight, factor -> power, e): weight * product of factor^power * e^2
Term = tuple[sp.Expr | int, Mapping[str, int], sp.Expr | int]


@check_types
@dataclass(frozen=True)
class Certificate(Shown):
    """A certificate that the checker can verify; `content` is plain JSON data with a digest."""

    content: Mapping[str, Any]

    @property
    def kind(self) -> str:
        """Kind: "storage", "positive real", "absolute stability", or a kind "... over a box"."""
        return str(self.content.get("kind", "no kind"))

    def check(self) -> str:
        """Verify the certificate with `checker`.

        returns: the statement that is proved, which the checker makes from the content
        raises ModelError: the checker refuses the certificate; the message says why
        """
        try:
            return check(dict(self.content))
        except Refused as problem:
            raise ModelError(f"certificate: {problem}") from None

    def write(self, path: str | Path) -> None:
        """Write a JSON file, which `python -m teleopdesign.passivity.checker PATH` verifies."""
        text = json.dumps(self.content, indent=1, sort_keys=True)
        write_text(path, text + "\n")


def read_certificate(path: str | Path) -> Certificate:
    """Read a certificate from a JSON file; it proves nothing before `Certificate.check` accepts it.

    path: the JSON file;  raises ModelError: not readable, or no certificate
    """
    if not Path(path).is_file():
        raise ModelError(f"{path}: no such file")
    try:
        content = load(str(path))
    except Refused as problem:
        raise ModelError(f"{path}: {problem}") from None
    if not isinstance(content, dict):
        raise ModelError(f"{path}: no certificate: expected named fields")
    return Certificate(content)


def matrix_certificate(
    title: str,
    impedance: Sequence[Sequence[sp.Expr]],
    kind: Literal["positive real", "absolute stability"] = "positive real",
) -> Certificate:
    """Certificate about a matrix of rational functions of s at a point; not yet checked.

    impedance: 6x6 at most, 2x2 for absolute stability
    raises ModelError: an entry is not rational with exact numbers
    """
    rows = [[checker_text(e) for e in row] for row in impedance]
    return seal({"kind": kind, "title": title, "impedance": rows})


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
    """Certificate that supply >= dV/dt with V >= 0 wherever the assumptions hold; not yet checked.

    `checker/storage.py` contains the theorem and its proof.

    supply: power that flows in;  storage: V
    rates: state -> rate of change;  constants: names that do not change; other names are signals
    positive, nonnegative: name -> expression that is assumed to be > 0, or >= 0
    invariant: name -> (h, rate), with h' + rate h >= 0: h >= 0 at the start implies h >= 0 later
    signs: signals and states x for which sign_x and abs_x are used
    proofs: "supply", "storage" or name of an invariant -> signs -> terms of the identity (`Term`);
        signs: one combination such as "1 -1", or "" for all combinations
    example: values that meet all assumptions (for each x in `signs` its size)
    raises ModelError: an expression is not rational with exact numbers
    """
    rates, invariant = rates or {}, invariant or {}
    positive, nonnegative = positive or {}, nonnegative or {}
    used = [supply, storage, *rates.values(), *positive.values(), *nonnegative.values()]
    used += [e for pair in invariant.values() for e in pair]
    names = {s.name for e in used for s in sp.sympify(e).free_symbols} | {*signs}
    known = {*rates, *constants, *(prefix + x for x in signs for prefix in ("abs_", "sign_"))}
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
        "proofs": {goal: _cases(by_case, signs) for goal, by_case in proofs.items()},
        "example": _text({n: e for n, e in example.items() if n in {*names, *rates, *constants}}),
    }
    return seal(content)


def _cases(by_case: Mapping[str, Sequence[Term]], signs: Sequence[str]) -> dict[str, list[Any]]:
    """The terms of an identity for each combination of signs."""
    cases = [" ".join(case) for case in product(("1", "-1"), repeat=len(signs))]
    return {
        case: [
            [checker_text(w), dict(powers), checker_text(e)]
            for w, powers, e in by_case.get(case, by_case.get("", ()))
        ]
        for case in cases
    }


def _text(expressions: Mapping[str, sp.Expr | int]) -> dict[str, str]:
    return {name: checker_text(e) for name, e in expressions.items()}


def checker_text(expression: sp.Expr | int) -> str:
    """An expression as the text that the checker reads.

    raises ModelError: not rational with exact numbers; a float is refused, too
    """
    e = sp.sympify(expression)
    for part in sp.preorder_traversal(e):
        rational = part.is_Rational or part.is_Symbol or part.is_Add or part.is_Mul
        if not rational and not (part.is_Pow and part.exp.is_Integer):
            raise ModelError(f"certificate: found {part} in {e}, expected a rational expression")
    return str(e)


def seal(content: dict[str, Any]) -> Certificate:
    """A certificate from its content: adds the digest that `checker` expects."""
    text = json.dumps(content, sort_keys=True)
    return Certificate({**content, "digest": hashlib.sha256(text.encode()).hexdigest()})
