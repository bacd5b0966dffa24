"""Passivity of several ports together: proved by the positive-real test, or refuted by a wave."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

import numpy as np
import sympy as sp

from ...base.errors import ModelError
from ...realise.lti import S
from ..checker.absolute_stability import Ratio, coprime
from ..checker.positive_real import SIZES
from ..claims.certificate import positive_real_certificate
from ..claims.claim import Claim, Proof, Refutation, Unknown
from ..linear.impedance import readable
from ..search.growing_wave import GrowingWave, wave_of
from .exact_complex import ZERO, Gaussian, add, multiply, round_point, value_at
from .growing_mode import sort_by_power
from .growth_points import evaluate_at, points_near_poles, roots_of

#: most points of the right half plane whose waves are tested exactly, the best points first
_MOST_CANDIDATES = 30


def passive_together(z: sp.Matrix) -> Claim:
    """Are all ports passive together: does no motion of all ports at once take energy out?

    z: forces over velocities (N s/m), n by n, rational in S with exact numbers
    returns: proved by the positive-real test of the matrix, refuted by a growing wave, or unknown;
        always unknown with dead times, and with more ports than a certificate can have
    """
    matrix = sp.ImmutableMatrix(z)
    text = "; ".join(", ".join(map(readable, row)) for row in matrix.tolist())
    statement = f"the {matrix.rows} ports of [{text}] are passive together"
    if matrix.has(sp.exp):
        return Claim(statement, Unknown("with dead times the tests are for one port or two"))
    if matrix.rows not in SIZES:
        why = f"the exact test is for {max(SIZES)} ports at most, found {matrix.rows}"
        return Claim(statement, Unknown(why))
    why = "no certificate is accepted"
    try:
        certificate = positive_real_certificate(statement, matrix.tolist())
        certificate.check()
    except ModelError as problem:
        why = str(problem)
    else:
        return Claim(statement, Proof("the positive-real test of the matrix", (certificate,)))
    wave = _wave_out_of(matrix)
    if wave is not None:
        f = float(wave.frequency) / (2 * np.pi)
        return Claim(statement, Refutation(f"a growing wave at {f:.4g} Hz", wave))
    return Claim(statement, Unknown(f"{why}; no wave that takes energy out was found"))


def _wave_out_of(z: sp.ImmutableMatrix) -> GrowingWave | None:
    ratios = [_ratio(entry) for entry in z]
    points = np.array([*_points_beside_axis(ratios), *points_near_poles(ratios)])
    values = np.moveaxis(np.array([evaluate_at(r, points) for r in ratios]), 0, 1)
    values = values.reshape(-1, *z.shape)
    finite = np.isfinite(values).all(axis=(1, 2))
    points, values = points[finite], values[finite]
    lowest = np.linalg.eigvalsh((values + values.conj().transpose(0, 2, 1)) / 2)[:, 0]
    share = lowest / np.abs(values).max(axis=(1, 2)) * points.real / np.abs(points)
    for k in np.argsort(share)[:_MOST_CANDIDATES]:
        if share[k] >= 0:
            return None
        at = round_point(complex(points[k]))
        wave = wave_of(z, *at)
        if wave is not None and wave.energy > 0 and _takes_out(ratios, at, wave):
            return wave
    return None


def _ratio(entry: sp.Expr) -> Ratio:
    above, below = sp.fraction(sp.together(entry))
    p, q = (sp.Poly(part, S, domain="QQ") for part in (above, below))
    return coprime(sort_by_power(p), sort_by_power(q))


def _points_beside_axis(ratios: list[Ratio]) -> Iterator[complex]:
    """Points beside the axis, from below the slowest root to above the fastest, ever closer."""
    sizes = np.abs([r for p, q in ratios for r in (*roots_of(p), *roots_of(q)) if r != 0] or [1.0])
    w = np.unique(np.r_[np.geomspace(sizes.min() / 1e3, sizes.max() * 1e3, 400), sizes])
    for closer in (1, 4, 8, 16, 32):
        yield from w * (2.0**-closer + 1j)


def _takes_out(ratios: list[Ratio], at: Gaussian, wave: GrowingWave) -> bool:
    """Whether V^H (Z + Z^H) V < 0 at the wave, exactly; V: its velocities, read as fractions."""
    v = [(Fraction(x.real), Fraction(x.imag)) for x in wave.velocity]
    total = ZERO
    for k, ratio in enumerate(ratios):
        value = value_at(ratio, at)
        if value is None:
            return False
        row, column = divmod(k, len(v))
        conjugate = v[row][0], -v[row][1]
        total = add(total, multiply(multiply(conjugate, value), v[column]))
    return total[0] < 0
