"""Certificates of claims over a box, in the form that `checker/over_a_box.py` checks."""

from __future__ import annotations

import re
from functools import reduce

import sympy as sp

from ..checker.effort import NAMES
from ..claims.certificate import Certificate, checker_text, seal
from .box import ValueBox
from .conditions import Conditions, size_of

#: claim -> kind of its certificate
KINDS = {
    "passive": "positive real over a box",
    "absolutely stable": "absolute stability over a box",
}


def stability_certificate(
    ask: Conditions, box: ValueBox, polynomial: sp.Poly, title: str
) -> Certificate:
    """Certificate that a polynomial in S and the values has no root with Re s >= 0, over the box.

    raises ModelError: the checker does not accept it
    """
    fields: dict[str, object] = {"polynomial": _text(polynomial.as_expr(), _plain_names(ask, box))}
    return _certify(ask, box, "stable over a box", title, fields)


def impedance_certificate(
    ask: Conditions, box: ValueBox, z: sp.Matrix, claim: str, title: str
) -> Certificate:
    """Certificate that an impedance of one or two ports is passive, or absolutely stable.

    raises ModelError: the checker does not accept it
    """
    parts = [tuple(map(ask.poly, sp.fraction(sp.cancel(e)))) for e in z]
    d = reduce(sp.lcm, (q for _, q in parts))
    n = [p * sp.quo(d, q) for p, q in parts]
    names, size = _plain_names(ask, box), z.shape[0]
    rows = [n[i * size : (i + 1) * size] for i in range(size)]
    fields: dict[str, object] = {
        "numerators": [[_text(e.as_expr(), names) for e in row] for row in rows],
        "denominator": _text(d.as_expr(), names),
    }
    if claim == "passive":
        fields["scale"] = str(size_of(ask.middle(n[0]), ask.middle(d)))
    return _certify(ask, box, KINDS[claim], title, fields)


def _certify(
    ask: Conditions,
    box: ValueBox,
    kind: str,
    title: str,
    fields: dict[str, object],
) -> Certificate:
    names = _plain_names(ask, box)
    ends = zip(names.values(), box.exact, strict=True)
    content = {
        "kind": kind,
        "title": title,
        "box": {n.name: [str(low), str(high)] for n, (low, high) in ends},
        "squares": [_text(p.as_expr(), names) for p in ask.effort.squares],
        **fields,
    }
    made = seal(content)
    made.check()
    return made


def _plain_names(ask: Conditions, box: ValueBox) -> dict[sp.Symbol, sp.Symbol]:
    """Plain names of the values for a certificate: "Z_M.inertia" becomes Z_M_inertia.

    If such names are not plain words or not distinct, all become v1, v2, ...
    """
    plain = [
        re.sub(r"_+", "_", re.sub(r"\W", "_", n, flags=re.ASCII)).strip("_") for n in box.names
    ]
    fits = all(re.fullmatch(r"[A-Za-z]\w*", n) and len(n) <= NAMES for n in plain)
    if not fits or len({*plain, "s", "x"}) != len(plain) + 2:
        plain = [f"v{k + 1}" for k in range(len(plain))]
    return {x: sp.Symbol(n) for x, n in zip(ask.symbols, plain, strict=True)}


def _text(expression: sp.Expr, names: dict[sp.Symbol, sp.Symbol]) -> str:
    return checker_text(expression.xreplace(names))
