"""Certificates of claims over a box, in the form that the checker reads; a point is a box, too."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any, Literal

import sympy as sp

from ..claims.certificate import Certificate, checker_text, seal
from .family import Family
from .matrices import Matrix, dampers
from .signs import Ends, Signs

#: claim -> kind of its certificate at a point
KINDS: dict[str, Literal["positive real", "absolute stability"]] = {
    "passive": "positive real",
    "absolutely stable": "absolute stability",
}
#: most characters of a name that the checker reads
_LONGEST = 60


def stability_certificate(
    title: str, p: Any, *, names: Sequence[str] = (), ends: Ends = (), signs: Signs | None = None
) -> Certificate:
    """Certificate that a polynomial in s and the values has no root with Re s >= 0, over the box.

    raises ModelError: the checker does not accept it
    """
    plain = _plain_names(p.ring, names)
    fields: dict[str, object] = {"polynomial": _text(p, plain)}
    return _certify("stable over a box", title, fields, plain, ends, signs)


def impedance_certificate(
    title: str, family: Family, n: Matrix, claim: str, signs: Signs
) -> Certificate:
    """Certificate that N/d, of one or two ports, is passive or absolutely stable over the box.

    raises ModelError: the checker does not accept it
    """
    plain = _plain_names(family.d.ring, family.names)
    fields: dict[str, object] = {
        "numerators": [[_text(e, plain) for e in row] for row in n],
        "denominator": _text(family.d, plain),
    }
    if claim == "passive":
        middle = [[_middle_of(signs, e) for e in row] for row in n]
        fields["scale"] = str(max(dampers(middle, _middle_of(signs, family.d))))
    return _certify(f"{KINDS[claim]} over a box", title, fields, plain, family.ends, signs)


def _middle_of(signs: Signs, p: Any) -> Any:
    return p.ring.from_expr(signs.middle(p).as_expr())


def _certify(
    kind: str,
    title: str,
    fields: dict[str, object],
    plain: dict[sp.Symbol, sp.Symbol],
    ends: Ends,
    signs: Signs | None,
) -> Certificate:
    pairs = zip(list(plain.values())[1:], ends, strict=False)
    content = {
        "kind": kind,
        "title": title,
        "box": {x.name: [str(low), str(high)] for x, (low, high) in pairs},
        "squares": [_text(p, {**plain, next(iter(plain)): sp.Symbol("x")})
                    for p in (signs.squares if signs else ())],
        **fields,
    }  # fmt: skip
    made = seal(content)
    made.check()
    return made


def _plain_names(ring: Any, names: Sequence[str]) -> dict[sp.Symbol, sp.Symbol]:
    """Plain names of s and the values for a certificate: "Z_M.inertia" becomes Z_M_inertia.

    If such names are not plain words or not distinct, all become v1, v2, ...
    """
    plain = [re.sub(r"_+", "_", re.sub(r"\W", "_", n, flags=re.ASCII)).strip("_") for n in names]
    fits = all(re.fullmatch(r"[A-Za-z]\w*", n) and len(n) <= _LONGEST for n in plain)
    if not fits or len({*plain, "s", "x"}) != len(plain) + 2:
        plain = [f"v{k + 1}" for k in range(len(plain))]
    return dict(zip(ring.symbols, map(sp.Symbol, ["s", *plain]), strict=False))


def _text(p: Any, names: dict[sp.Symbol, sp.Symbol]) -> str:
    return checker_text(p.as_expr().xreplace(names))
