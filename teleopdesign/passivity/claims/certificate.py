"""Certificates of proofs, in a form that a small separate program (`checker`) verifies.

`checker` does not use this package. It reads the JSON file of a certificate and makes the statement
that the file proves from its contents. The title is for readers only and proves nothing.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import sympy as sp

from ...base.arguments import check_types
from ...base.errors import ModelError
from ...base.files import write_text
from ...base.shown import Shown
from ..checker import Refused, check, load


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
