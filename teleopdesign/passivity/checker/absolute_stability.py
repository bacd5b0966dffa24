"""Absolute stability of rational two-ports: Llewellyn's criterion, poles and residues included.

Z(s) is a 2x2 matrix of rational functions with real coefficients. k_ij is the residue of z_ij at a
pole on the axis (at infinity: the coefficient of s), and L = z12 z21. The claim: no pair of
positive-real terminations (Z1, Z2) for which (Z + diag(Z1, Z2))^-1 exists gives this inverse a pole
in the open right half plane. The claim holds if the conditions 1 to 4 hold. Each of them is also
necessary, except the second line of 2:

    1. z11 and z22 are positive real;
    2. z12 and z21 have no pole in the open right half plane,
       and their poles on the axis, infinity included, are simple;
    3. A = 2 Re z11 Re z22 - Re L >= |L| at every w that is no pole;
    4. 2 k11 k22 - Re(k12 k21) >= |k12 k21| at every pole on the axis, 0 and infinity included
       (with 3, k12 k21 is real and >= 0 there, so that this is k11 k22 >= k12 k21).

Condition 3 is Llewellyn's inequality. Without 4 it calls [[1, 1/s], [1/s, 1]] stable, although this
two-port with both ports free has a pole at s = 1. At a lossless pole the axis shows nothing.

The conditions are sufficient. By 3, L has no simple pole on the axis: near such a pole L ~ l/(j u)
with u = w - w0, and one sign of u makes A < |L|. Near a double pole L ~ -k12 k21/u^2 while the
Re z_ii stay bounded, so k12 k21 > 0.

First case: n = z22 + Z2 is not identically 0. It is positive real, so it has no zero in the open
half plane, and by 1 and 2 z_in = z11 - L/n has no pole there. On the axis Re n >= Re z22 and
Re(L/n) <= (|L| + Re L)/(2 Re n), so Re z_in >= 0 by 3. Where Re n = 0, L is real and <= 0 by 3, and
Re(L/n) = 0. The poles of z_in on the axis are simple with residue >= 0:

- where n has a pole with residue K >= k22 > 0, the residue is k11 - k12 k21/K >= 0 by 4;
- where k22 = 0, L has no pole by 4, and the residue is k11, or k11 - L/n' where n has a zero, with
  n' > 0 and L <= 0 by 3 (in the limit, if z11 has a pole there).

Infinity is the same with 1/s for s. So z_in is positive real, det = n (z_in + Z1) is zero nowhere
in the open half plane or everywhere, and adj/det has no pole there.

Second case: n = 0 identically. Then z22 and -z22 are positive real, so z22 = Z2 = 0. L has no pole
in the closed half plane and is real and <= 0 on the axis, so L(s) = L(-s) = -c, as of a gyrator. If
c > 0, z12 = -c/z21 and z21 have neither pole nor zero in the open half plane, and the inverse,
[[0, 1/z21], [1/z12, (z11 + Z1)/c]], has no pole there. If c = 0, or z_in + Z1 = 0 identically, no
inverse exists: velocities are not determined (a free port without mass), and nothing is claimed.

With port 2 clamped, z11 + Z1 remains, which is positive real by 1.

The conditions are necessary.

1: a port whose z_ii is not positive real oscillates while the other port is clamped.
2: a pole s0 of L in the open half plane is a pole of z_in, so z_in takes every value near s0. If
z12 has a pole there and L has none, the inverse has this pole.
3: where it fails at w, a reactance and a damper at port 2 make Re z_in < 0 beside j w.
4: where it fails at j w0, let s = j w0 + d and Z2 of the size c/d, c small. Then
z_in ~ (k11 - k12 k21/(k22 + c))/d < 0.

In 3 and 4 the termination is Z1 = -z_in(s). A damper with a mass or a spring takes every value with
abs(arg) <= arg s. Near the axis, arg s is near 90 degrees.

If 2 fails by a multiple pole on the axis alone, the signal that passes through grows like time or
faster, but the open half plane need not contain a pole. Then nothing is claimed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isnan
from typing import Any

from .algebra import Quotient
from .effort import bound_effort, need
from .fields import expect_fields, read_matrix
from .polynomials import (
    Polynomial,
    add,
    coefficient_list,
    derivative,
    divide,
    first_root,
    greatest_common_divisor,
    halves,
    is_free_of_growth,
    is_non_negative,
    is_positive_real,
    multiply,
    odd_part,
    real_part,
    signs_at_roots,
    value,
    without_zero,
)

#: numerator and denominator of a rational function, coprime
Ratio = tuple[Polynomial, Polynomial]
#: entries of a two-port: z11, z12, z21, z22
Entries = tuple[Ratio, Ratio, Ratio, Ratio]
_NAMES = ("z11", "z12", "z21", "z22")
_ONE = [Fraction(1)]


@dataclass(frozen=True)
class Condition:
    """One of the conditions: its text, whether it holds, and where it fails ("": not known)."""

    name: str
    holds: bool
    where: str = ""

    def __str__(self) -> str:
        return self.name if self.holds else f"not so: {self.name}{self.where and ', ' + self.where}"


def state_absolute_stability(c: dict[str, Any]) -> str:
    """The statement that a certificate of this kind proves; raises Refused where Z is not so."""
    expect_fields(c, "kind", "title", "digest", "impedance")
    algebra, rows, text = read_matrix(c["impedance"], (2,))
    one = Quotient(algebra.number(1), {})
    below = [[algebra.over(one, e.below, {}) for e in row] for row in rows]
    with bound_effort(algebra.left):
        z11, z12, z21, z22 = (
            coprime(coefficient_list(rows[i][j].above), coefficient_list(below[i][j]))
            for i in (0, 1)
            for j in (0, 1)
        )
        for condition in conditions((z11, z12, z21, z22)):
            need(condition.holds, f"not shown to be absolutely stable: {condition}")
    return (
        f"Z(s) = [{text}] is absolutely stable: no positive-real Z1 and Z2 for which the inverse "
        "(Z + diag(Z1, Z2))^-1 exists give it a pole with Re s > 0"
    )


def conditions(z: Entries) -> tuple[Condition, ...]:
    """All conditions of absolute stability, each decided in rational arithmetic.

    z: coprime numerators and denominators of z11, z12, z21, z22
    """
    return (
        *(_positive_real(_NAMES[k], z[k]) for k in (0, 3)),
        *(_without_growth(_NAMES[k], z[k]) for k in (1, 2)),
        *(_simple_poles(_NAMES[k], z[k]) for k in (1, 2)),
        *_inequality(z),
        *_residues(z),
    )


def coprime(p: Polynomial, q: Polynomial) -> Ratio:
    """p/q without common factors, with a monic denominator; q: not zero."""
    common = greatest_common_divisor(p, q)
    above, below = divide(p, common)[0], divide(q, common)[0]
    return [c / below[-1] for c in above], [c / below[-1] for c in below]


def _positive_real(name: str, z: Ratio) -> Condition:
    where = "a pole on the axis or at infinity has no residue > 0, or is multiple"
    if not is_free_of_growth(z[1]):
        where = "a pole in the open right half plane"
    elif not is_non_negative(real := real_part(*z)):
        where = f"its real part is negative {_describe_place(real)}"
    holds = is_positive_real(*z)
    return Condition(f"{name} is positive real", holds, "" if holds else where)


def _without_growth(name: str, z: Ratio) -> Condition:
    name = f"{name} has no pole in the open right half plane"
    return Condition(name, is_free_of_growth(z[1]))


def _simple_poles(name: str, z: Ratio) -> Condition:
    """The condition that all poles of z on the axis and at infinity are simple."""
    p, q = z
    multiple = greatest_common_divisor(q, derivative(q))
    even, odd = halves(multiple)
    on_axis = greatest_common_divisor(even, odd)
    finite = value(multiple, 0) != 0 and sum(signs_at_roots(_ONE, on_axis)) == 0
    infinite = len(p) <= len(q) + 1
    where = "" if finite else "on the axis"
    return Condition(
        f"every pole of {name} on the axis and at infinity is simple",
        finite and infinite,
        where if infinite else "at infinity",
    )


def _inequality(z: Entries) -> Iterator[Condition]:
    """Condition 3 as signs of two polynomials in x = w^2, times denominators >= 0."""
    difference, twice = llewellyn(z)
    for name, p in (
        ("2 Re z11 Re z22 - Re z12 z21 >= 0 on the axis", difference),
        ("(2 Re z11 Re z22 - Re z12 z21)^2 >= abs(z12 z21)^2 on the axis", twice),
    ):
        holds = is_non_negative(p)
        yield Condition(name, holds, "" if holds else _describe_place(p))


def llewellyn(z: Entries) -> tuple[Polynomial, Polynomial]:
    """A and A^2 - abs(z12 z21)^2 as polynomials in x = w^2, times factors that are >= 0."""
    loop = coprime(multiply(z[1][0], z[2][0]), multiply(z[1][1], z[2][1]))
    (r1, d1), (r2, d2) = (_real_ratio(one) for one in (z[0], z[3]))
    re, d = real_part(*loop), real_part(loop[1], loop[1])
    a = add(multiply([Fraction(2)], r1, r2, d), multiply(re, d1, d2), -1)
    size = multiply(real_part(loop[0], loop[0]), d, d1, d1, d2, d2)
    return a, add(multiply(a, a), size, -1)


def _real_ratio(z: Ratio) -> tuple[Polynomial, Polynomial]:
    """Re z = r/d in x = w^2, d >= 0; common factors are divided out where d stays >= 0."""
    r, d = real_part(*z), real_part(z[1], z[1])
    common = greatest_common_divisor(r, d)
    short = divide(d, common)[0]
    return (divide(r, common)[0], short) if is_non_negative(short) else (r, d)


def _describe_place(p: Polynomial) -> str:
    """Text that names the lowest frequency, rad/s, at which p(x) < 0 begins; approximate."""
    odd = odd_part(p)
    x = first_root([Fraction(-1)], odd)
    return "at every frequency" if isnan(x) else f"beside {x**0.5:.4g} rad/s"


def _residues(z: Entries) -> Iterator[Condition]:
    """Condition 4 at s = 0, at infinity, and at the poles j w that z12 and z21 share."""
    name = "the residues have 2 k11 k22 - Re k12 k21 >= abs(k12 k21)"
    yield Condition(f"{name} at s = 0", _is_balanced([_residue_at_zero(one) for one in z]))
    yield Condition(f"{name} at infinity", _is_balanced([_residue_at_infinity(one) for one in z]))
    shared = both = greatest_common_divisor(axis_poles(z[1][1]), axis_poles(z[2][1]))
    for one in (z[0], z[3]):
        both = greatest_common_divisor(both, axis_poles(one[1]))
    alone = divide(shared, both)[0]
    name = f"{name} at s = j w"
    for poles, of_both in ((both, True), (alone, False)):
        tests = residue_tests(z, shared=of_both)
        wrong = [f for f in tests if signs_at_roots(f, poles)[0]]
        if wrong:
            where = f"at {first_root(wrong[0], poles) ** 0.5:.4g} rad/s"
            yield Condition(name, False, where)
            return
    yield Condition(name, True)


def residue_tests(z: Entries, *, shared: bool) -> tuple[Polynomial, Polynomial]:
    """B and B^2 - C^2 in x = w^2: both are >= 0 at a pole if and only if it meets condition 4.

    B = 2 k11 k22 - Re k12 k21 and C = abs(k12 k21), both times the same positive number, with
    k = p/q' at the simple zeros j w of q. shared: whether z11 and z22 have that pole as well
    """
    (p11, q11), (p12, q12), (p21, q21), (p22, q22) = ((p, derivative(q)) for p, q in z)
    above, below = multiply(p12, p21), multiply(q12, q21)
    size, cross = real_part(below, below), real_part(above, below)
    passed = multiply(real_part(above, above), size)
    if not shared:
        return [-c for c in cross], add(multiply(cross, cross), passed, -1)
    kept = real_part(multiply(p11, p22), multiply(q11, q22))
    weight = real_part(multiply(q11, q22), multiply(q11, q22))
    b = add(multiply([Fraction(2)], kept, size), multiply(cross, weight), -1)
    return b, add(multiply(b, b), multiply(passed, weight, weight), -1)


def axis_poles(q: Polynomial) -> Polynomial:
    """Polynomial in x whose roots x > 0 are the w^2 of all zeros j w of q."""
    return without_zero(greatest_common_divisor(*halves(q)))


def _residue_at_zero(z: Ratio) -> Fraction:
    """Residue of z at s = 0; 0 where z has no simple pole there."""
    p, q = z
    return value(p, 0) / q[1] if q[0] == 0 and q[1] != 0 else Fraction(0)


def _residue_at_infinity(z: Ratio) -> Fraction:
    """Residue of z at infinity, the coefficient of s; 0 where z does not grow like s."""
    p, q = z
    return p[-1] / q[-1] if len(p) == len(q) + 1 else Fraction(0)


def _is_balanced(k: Sequence[Fraction]) -> bool:
    return 2 * k[0] * k[3] - k[1] * k[2] >= abs(k[1] * k[2])
