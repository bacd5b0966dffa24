"""Certificates that a matrix Z is positive real: "positive real", and "positive real over a box".

The first kind contains Z alone, at a point, of up to 6 ports. The second contains numerators N, a
denominator d and a scale c > 0, of one port or two, with names that vary over a box. The checker
decides, at each point of the box, with Z = N/d and c = 1 where no scale is given:

1. (Z + c)^-1 has a denominator all of whose zeros have Re s < 0. So S = (Z - c)/(Z + c) =
   1 - 2 c (Z + c)^-1 is analytic for Re s >= 0.
2. All principal minors of H = N conj(d) + N^H d = abs(d)^2 (Z + Z^H) are >= 0 on the imaginary
   axis. So H is positive semidefinite there, and so is
   1 - S^H S = 2 c (Z + c)^-H (Z + Z^H) (Z + c)^-1.
3. S is bounded on the axis, so it is proper. By the maximum principle |S| <= 1 for Re s > 0. So Z
   is analytic for Re s > 0 with Z + Z^H >= 0.

Over a box, step 1 may instead show that the poles of Z are at s = 0 and infinity, simple, with
symmetric, positive semidefinite residues. Z without them is analytic and bounded for Re s >= 0, so
v^H (Z + Z^H) v is harmonic there, and >= 0 by the maximum principle. The poles add a term >= 0.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from .algebra import Poly, read_number
from .effort import need
from .over_a_box import PolyMatrix, SignsOverBox, halves, read_impedance

#: numbers of rows that are allowed: each further row doubles the number of principal minors
SIZES = (1, 2, 3, 4, 5, 6)


def state_positive_real(c: dict[str, Any]) -> str:
    """The statement that Z is positive real, as the certificate says; raises Refused if not."""
    box, n, d, text, where = read_impedance(c, SIZES, "scale")
    scale = read_number(c["scale"], "scale") if where else Fraction(1)
    need(scale > 0, "scale: not > 0")
    _check(box, n, d, scale)
    return f"{text} is positive real: analytic with Z + Z^H >= 0 for Re s > 0{where}"


def _check(box: SignsOverBox, n: PolyMatrix, d: Poly, scale: Fraction) -> None:
    """Raise Refused unless steps 1 and 2 are shown."""
    below = box.inverse_denominator(with_damper(box, n, d, scale), d)
    need(below, "not positive real: Z + c is singular")
    shown = box.is_stable(below) or box.names and box.has_passive_residues(n, d, symmetric=True)
    need(shown, "not positive real: (Z - c)/(Z + c) is not shown to be stable")
    weight = box.cross(d, d)[0]
    for minor in _hermitian_minors(box, n, d):
        shown = box.are_non_negative([minor], weight)
        need(shown, "not positive real: Z + Z^H is not shown to be >= 0 on the axis")


def with_damper(box: SignsOverBox, n: PolyMatrix, d: Poly, scale: Fraction) -> PolyMatrix:
    """N + c d, with c on the diagonal."""
    return [
        [box.algebra.plus(e, d, scale) if i == j else e for j, e in enumerate(row)]
        for i, row in enumerate(n)
    ]


def _hermitian_minors(box: SignsOverBox, n: PolyMatrix, d: Poly) -> Iterator[Poly]:
    """Principal minors of N conj(d) + N^H d on the axis, in x = w^2."""
    times, plus, size = box.algebra.times, box.algebra.plus, len(n)
    late = _mirror(d)
    h = [
        [plus(times(n[i][j], late), times(_mirror(n[j][i]), d)) for j in range(size)]
        for i in range(size)
    ]
    for number in range(1, size + 1):
        for chosen in itertools.combinations(range(size), number):
            real, odd = halves(box.minor(h, chosen, chosen))
            need(not odd, "not positive real: odd on the axis")
            yield real


def _mirror(p: Poly) -> Poly:
    """p(-s), which is the conjugate of p(s) on the imaginary axis."""
    return {k: -c if k[0] % 2 else c for k, c in p.items()}
