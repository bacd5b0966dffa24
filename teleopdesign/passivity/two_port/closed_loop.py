"""Exact closed loop of a rational two-port with a termination at each port."""

from __future__ import annotations

from fractions import Fraction

from ..checker.absolute_stability import Entries, Ratio, coprime
from ..checker.polynomials import (
    Polynomial,
    add,
    greatest_common_divisor,
    is_free_of_growth,
    multiply,
)


def grows_between(z: Entries, held: tuple[Ratio, Ratio]) -> bool:
    """Whether (Z + diag(held))^-1 has a pole in the open right half plane, by Routh's scheme.

    held: impedances of the two terminations
    returns: False also where the inverse does not exist
    """
    det, (z11, z22) = _close_loop(z, held)
    if not det[0]:
        return False
    closed = (_product(one, (det[1], det[0])) for one in (z11, z[1], z[2], z22))
    return not all(is_free_of_growth(q) for _, q in closed)


def hidden_poles(z: Entries, held: tuple[Ratio, Ratio], k: int) -> Polynomial:
    """Polynomial whose zeros are poles of z[k] and of the same entry of the closed loop.

    Only poles count at which the determinant of the closed loop is finite, because there the other
    port rests. The result is 1 where the determinant is zero or shares a pole with z[k].
    k: 1 (z12) or 2 (z21);  held: impedances of the two terminations
    """
    det, _ = _close_loop(z, held)
    if not det[0] or len(greatest_common_divisor(det[1], z[k][1])) > 1:
        return [Fraction(1)]
    return greatest_common_divisor(_product(z[k], (det[1], det[0]))[1], z[k][1])


def _close_loop(z: Entries, held: tuple[Ratio, Ratio]) -> tuple[Ratio, tuple[Ratio, Ratio]]:
    """Determinant and diagonal of Z + diag(held)."""
    z11, z22 = (_sum(one, end) for one, end in zip((z[0], z[3]), held, strict=True))
    loop = _product(z[1], z[2])
    return _sum(_product(z11, z22), ([-c for c in loop[0]], loop[1])), (z11, z22)


def _sum(a: Ratio, b: Ratio) -> Ratio:
    return coprime(add(multiply(a[0], b[1]), multiply(b[0], a[1])), multiply(a[1], b[1]))


def _product(a: Ratio, b: Ratio) -> Ratio:
    return coprime(multiply(a[0], b[0]), multiply(a[1], b[1]))
