"""Claims about a family of linear systems as signs of polynomials over a box.

Stable: the determinant of all states is Hurwitz in the whole box.

Passive: `held`, all states with dampers at the ports, is Hurwitz, and all principal minors of
Z + Z^H are >= 0 on the axis. In units of the ports in which the dampers are 1, (Z - 1)/(Z + 1) is
then analytic for Re s >= 0 and at most 1 on the axis, so also in between (maximum principle). What
`held` adds are modes that no port shows.

Absolutely stable, two ports: `held` is Hurwitz, what passes between dampers grows at most like s
far out, and on the axis Re z11, Re z22 >= 0 and Llewellyn's inequality hold, where Z is finite.
`checker/matrices.py` has the proof. What is shown is written as a certificate in the form that the
checker reads; a point is a box, too.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import combinations
from typing import Any, Literal

import sympy as sp

from ...derive.polynomials import X, as_poly, cross, where_negative
from ..claims.certificate import Certificate, checker_text, seal
from .family import Family
from .matrices import Matrix, close, dampers, determinant, hold, rational
from .signs import Ends, Signs, axis_unit, coefficient, degree


def is_shown(signs: Signs, family: Family, claim: str, margin: Fraction = Fraction(0)) -> bool:
    """Whether a claim is shown for the whole box; dead times are not covered.

    claim: "passive" or "absolutely stable";  margin: damping that Z may lose at each port, N s/m
    """
    n = take_damping(family, margin)
    if not _modes_decay(signs, family, n, claim):
        return False
    unit = axis_unit(signs.middle(family.held))
    tests = axis_conditions(n, family.d, claim)
    return all(signs.is_non_negative(p, unit) for p in tests)


def _modes_decay(signs: Signs, family: Family, n: Matrix, claim: str) -> bool:
    """Whether all modes are shown to decay with dampers at the ports; n: less a margin.

    Where springs or masses vanish at an end of the box, the modes that the ports do not show are
    shown to decay, and the poles of Z to be passive ones.
    """
    held = family.held if n is family.n else close(n, family.d, dampers(n, family.d))
    # what passes from port to port between dampers is to grow at most like s far out
    is_slow = claim == "passive" or (
        degree(family.d) + max(degree(n[0][1]), degree(n[1][0]))
        <= degree(determinant(hold(n, family.d, dampers(n, family.d)))) + 1
    )
    decays = is_slow and signs.is_hurwitz(held)
    if decays and (n is family.n or signs.is_hurwitz(family.held)):
        return True
    if not signs.ends or len(n) > 2:
        return False
    shown = close(family.n, family.d, dampers(family.n, family.d))
    (hidden,), rest = family.held.div([shown])
    if rest or not signs.is_hurwitz(hidden):
        return False
    return _has_passive_residues(signs, n, family.d, symmetric=claim == "passive")


def _has_passive_residues(signs: Signs, n: Matrix, d: Any, *, symmetric: bool) -> bool:
    """Whether the poles of N/d are shown to lie on the left, or at 0 and infinity and passive."""
    has_zero = not coefficient(d, 0)
    rest = d.exquo(d.ring.gens[0]) if has_zero else d
    if not signs.is_hurwitz(rest) or max(degree(e) for row in n for e in row) > degree(d) + 1:
        return False
    sign = 1 if signs.middle(rest).LC() > 0 else -1
    for power in (degree(d) + 1, *((0,) if has_zero else ())):
        k = [[coefficient(e, power) * sign for e in row] for row in n]
        if symmetric and len(k) == 2 and k[0][1] != k[1][0]:
            return False
        if not all(map(signs.is_non_negative, (*(k[i][i] for i in range(len(k))), determinant(k)))):
            return False
    return True


def take_damping(family: Family, margin: Fraction) -> Matrix:
    """Numerators of Z less a damper at each port, N s/m."""
    if not margin:
        return family.n
    damper = rational(margin)
    return hold(family.n, family.d, [-damper] * family.size)


def axis_conditions(n: Matrix, d: Any, claim: str) -> Iterator[Any]:
    """Polynomials in x = w^2 that are not negative where the claim holds; Z = N/d."""
    if claim == "passive":
        yield from hermitian_minors(n, d)
        return
    first, second = (cross(n[k][k], d)[0] for k in (0, 1))
    re, im = cross(n[0][1] * n[1][0], d * d)
    size, x = cross(d, d)[0], d.ring.gens[0]
    yield from (first, second, _divide_out(2 * first * second - re, size))
    yield _divide_out(4 * first * second * (first * second - re) - x * im**2, size)


def where_it_fails(family: Family, claim: str) -> list[Fraction]:
    """Values of x = w^2 at which a condition of the claim on the axis fails; a point, exactly."""
    tests = axis_conditions(family.n, family.d, claim)
    return [x for p in tests for x in where_negative(as_poly(p, X))]


def hermitian_minors(n: Matrix, d: Any) -> Iterator[Any]:
    """Principal minors of abs(d)^2 (Z + Z^H) on the axis, less factors abs(d)^2; Z = N/d."""
    ring, size = d.ring, cross(d, d)[0]
    mirror = {ring.gens[0]: -ring.gens[0]}
    turned = d.compose(list(mirror.items()))
    h = [
        [e * turned + n[j][i].compose(list(mirror.items())) * d for j, e in enumerate(row)]
        for i, row in enumerate(n)
    ]
    for number in range(1, len(n) + 1):
        for chosen in combinations(range(len(n)), number):
            minor = determinant([[h[i][j] for j in chosen] for i in chosen])
            yield _divide_out(cross(minor, ring.one)[0], size)


def _divide_out(p: Any, size: Any) -> Any:
    """The polynomial divided by `size`, which is abs(d)^2 >= 0, as often as `size` divides it."""
    while p and max(map(sum, size), default=0) > 0:
        (quotient,), rest = p.div([size])
        if rest:
            break
        p = quotient
    return p


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
