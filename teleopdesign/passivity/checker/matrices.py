"""Certificates of matrices of impedances, at a point or over a box, in two parts with a proof each.

Positive real: "positive real", and "positive real over a box". The first kind contains Z
alone, at a point, of up to 6 ports. The second contains numerators N, a denominator d and a scale
c > 0, of one port or two, with names that vary over a box. The checker decides, at each point of
the box, with Z = N/d and c = 1 where no scale is given:

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

Absolute stability of two-ports: "absolute stability", and the same over a box. Z(s) is a 2x2
matrix of rational functions with real coefficients. The claim: no pair of positive-real
terminations (Z1, Z2) for which (Z + diag(Z1, Z2))^-1 exists gives this inverse a pole in the open
right half plane. With E = (Z + 1)^-1 the checker shows, at each point of a box:

1. E11, E22 and E12 E21 have no pole with Re s >= 0;
2. E12 and E21 have no pole with Re s > 0, and simple ones on the axis, infinity included;
3. Re z11, Re z22 >= 0 and A = 2 Re z11 Re z22 - Re(z12 z21) >= |z12 z21| at every w that is no pole
   (Llewellyn's inequality), as signs of polynomials.

Proof. Let S = 1 - 2 E and Zi = (1 + Gi)/(1 - Gi), with Gi analytic and |Gi| <= 1 for Re s > 0 (a
clamped port has G = 1). The inverse is made of 1 - Gi, of S and of 1/F, with

    F = 1 - a G1 - b G2 + (a b - l) G1 G2,    a = S11,  b = S22,  l = S12 S21.

By 2 its poles in the open half plane are zeros of F. For constant complex numbers G1, G2 with
|Gi| < 1, F is a function of s that is analytic for Re s >= 0 by 1.

On the axis, where Z is finite: by 3 Z + diag(Z1, Z2) is regular for all Z1, Z2 with Re Zi > 0 (for
each such Z2, Re(z11 - z12 z21/(z22 + Z2)) >= 0), so F is not 0 for any |Gi| < 1. F is continuous in
s, and for G1 = G2 = 0 it is 1. So F is not 0 for any |Gi| < 1 at the other points of the axis: a
limit of functions without zeros has none, or is 0 everywhere (Hurwitz). F = 0 has no solution with
|G2| < 1, so |b - (a b - l) G1| <= |1 - a G1|. Hence |a|, |b| <= 1 and |a b - l| <= 2: on the axis
a, b and l are bounded, so they are proper, and infinity is one of the other points.

The number of zeros of F with Re s > 0 does not change while G1, G2 grow from 0, since no zero meets
the axis or infinity. At 0 there is none. So F(s) is not 0 for Re s > 0 and any numbers |Gi| < 1,
such as the values of terminations at s. If |Gi(s)| = 1 at some s, Gi is constant (maximum
principle). F as a function of s and of the other number is then a limit of functions without zeros.
So it has none, or is 0 everywhere, and no inverse exists.

Over a box, instead of 1 and 2 the checker may show that the poles of Z are at s = 0 and infinity,
simple, with k11, k22 >= 0 and k11 k22 >= k12 k21 for the residues there. With 3, this implies 1 and
2: z22 is positive real, so n = z22 + 1 has no zero for Re s >= 0. If k22 > 0, z12 z21/n has a
simple pole, with residue k12 k21/k22 <= k11. If k22 = 0, z12 z21 has no pole: beside one its size
would exceed A, for one sign of w. So z_in = z11 - z12 z21/n is positive real by 3, and
E11 = 1/(z_in + 1) has no pole for Re s >= 0. The same holds for E22, and for
E12 E21 = z12 z21 E11^2/n^2, where a double pole of z12 z21 meets one of n^2. E12 = -z12 E11/n has
the poles of z12 at most.

The conditions are necessary but for the second half of 2: where 1, the first half of 2, or 3 fails,
some termination -z_in(s) is passive and grows. If only a pole on the axis is multiple, the signal
that passes through grows like time or faster, and nothing is claimed.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from .algebra import Poly, read_number
from .effort import need
from .over_a_box import PolyMatrix, SignsOverBox, degree, halves, read_impedance, times_x
from .polynomials import coefficient_list, derivative, greatest_common_divisor, is_hurwitz

#: numbers of rows that are allowed: each further row doubles the number of principal minors
SIZES = (1, 2, 3, 4, 5, 6)


def state_positive_real(c: dict[str, Any]) -> str:
    """The statement that Z is positive real, as the certificate says; raises Refused if not."""
    box, n, d, text, where = read_impedance(c, SIZES, "scale")
    scale = read_number(c["scale"], "scale") if where else Fraction(1)
    need(scale > 0, "scale: not > 0")
    _check_matrix(box, n, d, scale)
    return f"{text} is positive real: analytic with Z + Z^H >= 0 for Re s > 0{where}"


def _check_matrix(box: SignsOverBox, n: PolyMatrix, d: Poly, scale: Fraction) -> None:
    """Raise Refused unless steps 1 and 2 of the first part are shown."""
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


def state_absolute_stability(c: dict[str, Any]) -> str:
    """The statement that Z is absolutely stable, as the certificate says; raises Refused if not."""
    box, n, d, text, where = read_impedance(c, (2,))
    _check_two_port(box, n, d)
    return (
        f"{text} is absolutely stable: no positive-real Z1 and Z2 for which the inverse "
        f"(Z + diag(Z1, Z2))^-1 exists give it a pole with Re s > 0{where}"
    )


def _check_two_port(box: SignsOverBox, n: PolyMatrix, d: Poly) -> None:
    """Raise Refused unless conditions 1 to 3 of the second part are shown."""
    m = with_damper(box, n, d, Fraction(1))
    below = box.inverse_denominator(m, d)
    need(below, "not absolutely stable: Z + 1 is singular")
    grows = max(degree(box.algebra.times(d, m[i][1 - i])) for i in (0, 1))
    slow = grows <= degree(box.minor(m, (0, 1), (0, 1))) + 1
    if not (box.is_stable(below) and slow):
        if box.names:
            shown = box.has_passive_residues(n, d, symmetric=False)
            need(shown, "not shown to be absolutely stable: modes between dampers")
        else:
            _check_poles(box, m, d)
    names = ("Re z11", "Re z22", "2 Re z11 Re z22 - Re z12 z21", "Llewellyn's inequality")
    weight = box.cross(d, d)[0]
    for name, p in zip(names, _inequalities(box, n, d), strict=True):
        shown = box.are_non_negative([p], weight)
        need(shown, f"not shown to be absolutely stable: {name} on the axis")


def _check_poles(box: SignsOverBox, m: PolyMatrix, d: Poly) -> None:
    """Conditions 1 and 2, entry by entry, at a point; m: N + d."""
    times = box.algebra.times
    det = box.minor(m, (0, 1), (0, 1))
    first, second, through, back = (times(d, e) for e in (m[1][1], m[0][0], m[0][1], m[1][0]))
    loop = box.reduce([times(through, back)], times(det, det))
    for p in (box.reduce([first], det), box.reduce([second], det), loop):
        need(box.is_stable(p), "not absolutely stable: a mode between dampers")
    for above in (through, back):
        p = box.reduce([above], det)
        need(box.is_free_of_growth(p), "not absolutely stable: z12 or z21 has a pole that grows")
        q = coefficient_list(p)
        multiple = greatest_common_divisor(q, derivative(q), box.left)
        simple = is_hurwitz(multiple, box.left)
        simple = simple and degree(above) - degree(det) <= 1
        need(simple, "not shown to be absolutely stable: a multiple pole of z12 or z21")


def _inequalities(box: SignsOverBox, n: PolyMatrix, d: Poly) -> tuple[Poly, ...]:
    """Re z11, Re z22, A and A^2 - abs(z12 z21)^2 on the axis, times powers of abs(d)^2."""
    plus, times, number = box.algebra.plus, box.algebra.times, box.algebra.number
    first, second = (box.cross(n[k][k], d)[0] for k in (0, 1))
    real, odd = box.cross(times(n[0][1], n[1][0]), times(d, d))
    a = plus(times(number(2), times(first, second)), real, -1)
    size = plus(times(real, real), times_x(times(odd, odd)))
    return first, second, a, plus(times(a, a), size, -1)
