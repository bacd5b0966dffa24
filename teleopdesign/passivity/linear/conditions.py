"""Claims about a family of linear systems as conditions on polynomials, and their certificates.

Stable: the determinant of all states is Hurwitz in the whole box.

Passive: `held`, all states with dampers at the ports, is Hurwitz, and all principal minors of
Z + Z^H are >= 0 on the axis. In units of the ports in which the dampers are 1, (Z - 1)/(Z + 1) is
then analytic for Re s >= 0 and at most 1 on the axis, so also in between (maximum principle). What
`held` adds are modes that no port shows.

Absolutely stable, two ports: `held` is Hurwitz, what passes between dampers grows at most like s
far out, and on the axis Re z11, Re z22 >= 0 and Llewellyn's inequality hold, where Z is finite.
`checker/matrices.py` has the proof.

At a point the conditions are decided here, too. Over a box a claim is proved where the checker
accepts its certificates: the checker alone looks for signs over a box.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from itertools import combinations
from typing import Any, Literal

import sympy as sp

from ...derive.polynomials import X, as_poly, cross, is_hurwitz, is_non_negative, where_negative
from ...realise.lti import S
from ..claims.certificate import Certificate, checker_text, seal
from .family import Family
from .matrices import Ends, Matrix, close, dampers, degree, determinant, evaluate_at_middle, hold


def holds_exactly(family: Family, claim: str, margin: Fraction = Fraction(0)) -> bool:
    """Whether a claim about a family without values and dead times holds.

    claim: "passive" or "absolutely stable";  margin: damping that Z loses at each port, N s/m
    """
    n, d = take_damping(family, margin), family.d
    held = family.held if n is family.n else close(n, d, dampers(n, d))
    # what passes from port to port between dampers is to grow at most like s far out
    is_slow = claim == "passive" or (
        degree(d) + max(degree(n[0][1]), degree(n[1][0]))
        <= degree(determinant(hold(n, d, dampers(n, d)))) + 1
    )
    return (
        is_slow
        and is_hurwitz(as_poly(held, S))
        and all(is_non_negative(as_poly(p, X)) for p in axis_conditions(n, d, claim))
    )


def take_damping(family: Family, margin: Fraction) -> Matrix:
    """Numerators of Z less a damper at each port, N s/m."""
    if not margin:
        return family.n
    damper = sp.QQ(margin.numerator, margin.denominator)
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
#: terms of a polynomial of which factors are looked for: of a larger one this takes longer than the
#: proof
_MOST_TERMS = 600


def stability_certificate(
    title: str, p: Any, names: Sequence[str] = (), ends: Ends = ()
) -> Certificate:
    """Certificate that a polynomial in s and the values has no root with Re s >= 0, over the box.

    raises ModelError: the checker does not accept it
    """
    plain = _plain_names(p.ring, names)
    return _certify("stable over a box", title, plain, ends, (), polynomial=_text(p, plain))


def certificates_over_box(
    title: str, family: Family, claim: str, margin: Fraction = Fraction(0)
) -> tuple[Certificate, ...]:
    """Certificates that a family of one or two ports is passive or absolutely stable over the box.

    One is for the ports, and one for the modes that the ports do not show, where there are any.

    claim: "passive" or "absolutely stable";  margin: damping that Z may lose at each port, N s/m
    raises ModelError: the checker does not accept them
    """
    n, d, plain = take_damping(family, margin), family.d, _plain_names(family.d.ring, family.names)
    fields: dict[str, object] = {
        "numerators": [[_text(e, plain) for e in row] for row in n],
        "denominator": _text(d, plain),
    }
    if claim == "passive":
        *rows, below = (
            [d.ring.from_expr(evaluate_at_middle(e, family.ends).as_expr()) for e in row]
            for row in (*n, [d])
        )
        fields["scale"] = str(max(dampers(rows, *below)))
    tests = axis_conditions(n, d, claim)
    kind = f"{KINDS[claim]} over a box"
    made = [_certify(kind, title, plain, family.ends, tests, **fields)]
    (hidden,), rest = family.held.div([close(family.n, d, dampers(family.n, d))])
    hidden = family.held if rest else hidden
    if not hidden.is_ground:
        more = "every mode that no port shows decays"
        made.append(stability_certificate(more, hidden, family.names, family.ends))
    return tuple(made)


def _certify(
    kind: str,
    title: str,
    plain: dict[sp.Symbol, sp.Symbol],
    ends: Ends,
    tests: Iterable[Any],
    **fields: object,
) -> Certificate:
    """A certificate that the checker accepts.

    plain: symbols of the ring -> plain names;  tests: polynomials whose signs the checker decides
    """
    pairs = zip(list(plain.values())[1:], ends, strict=False)
    on_axis = {**plain, next(iter(plain)): sp.Symbol("x")}
    made = seal(
        {
            "kind": kind,
            "title": title,
            "box": {x.name: [str(low), str(high)] for x, (low, high) in pairs},
            "squares": [_text(p, on_axis) for p in _repeated_factors(tests)],
            **fields,
        }
    )
    made.check()
    return made


def _repeated_factors(tests: Iterable[Any]) -> list[Any]:
    """Factors of which polynomials have a square: the checker divides by it."""
    lists = (p.factor_list()[1] for p in tests if len(p) <= _MOST_TERMS)
    return list(dict.fromkeys(f for one in lists for f, k in one if k > 1 and not f.is_ground))


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
