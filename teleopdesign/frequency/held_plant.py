"""The plant between two samples, for held and delayed inputs: its matrices, with many digits.

    x' = A x + sum_k B_k u(t - T_k),   y = C x + sum_k D_k u(t - T_k)

C is that of the companion form: the first state. Time counts in samples. Numbers are exact before
`mpmath` takes them, with the digits that are set.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

import mpmath
import numpy as np


@dataclass(frozen=True)
class HeldPlant:
    """The plant between two samples in `mpmath`: matrices of one sample, time in samples."""

    step: mpmath.matrix  # e^(A h)
    grown: mpmath.matrix  # e^(A h) - I, as A times its integral
    #: for each dead time: samples m, B0, B1, D
    inputs: tuple[tuple[int, mpmath.matrix, mpmath.matrix, mpmath.mpf], ...]

    @classmethod
    def of(
        cls,
        period: Fraction,
        below: Sequence[Fraction],
        above: Sequence[tuple[Fraction, Sequence[Fraction]]],
    ) -> HeldPlant:
        """The plant of several numerators, each with its dead time (s), over one denominator.

        Coefficients begin with the highest power.
        """
        lead, n = below[0], len(below) - 1
        # time in samples: s h = q, so that the coefficient of q^k is that of s^k over h^k
        monic = tuple(c / lead * period**k for k, c in enumerate(below))
        a = _companion(monic)
        growth = _growth_of(monic, mpmath.mp.dps) if n else None
        whole = growth.integral(mpmath.mpf(1)) if growth else a
        inputs = []
        for time, numerator in above:
            padded = [Fraction(0)] * (n + 1 - len(numerator)) + list(numerator)
            scaled = [c / lead * period**k for k, c in enumerate(padded)]
            straight = scaled[0]
            b = mpmath.matrix([as_mpf(c - straight * m) for c, m in
                               zip(scaled[1:], monic[1:], strict=True)] or [0])  # fmt: skip
            m = int(time // period)
            share = as_mpf(time / period - m)
            if growth is None:
                inputs.append((m, mpmath.matrix(0, 1), mpmath.matrix(0, 1), as_mpf(straight)))
                continue
            late = growth.integral(1 - share)
            inputs.append((m, late * b, (whole - late) * b, as_mpf(straight)))
        grown = a * whole if n else a
        return cls(mpmath.eye(n) + grown if n else a, grown, tuple(inputs))

    def polynomials(self) -> tuple[np.ndarray, list[tuple[int, np.ndarray, np.ndarray]]]:
        """det(z I - e^(A h)); for each input m, C adj B0, C adj B1 + D det, highest power first."""
        n, f = self.step.rows, self.step
        below, adjoint = [mpmath.mpf(1)], list[mpmath.matrix]()
        power = mpmath.eye(n) if n else f
        for k in range(1, n + 1):
            adjoint.append(power)
            moved = f * power
            c = -sum((moved[i, i] for i in range(n)), mpmath.mpf(0)) / k
            below.append(c)
            power = moved + c * mpmath.eye(n)
        shares, made = [], np.array(below)
        for m, now, before, straight in self.inputs:
            first, second = (np.array([(p * b)[0] for p in adjoint]) for b in (now, before))
            shares.append((m, first, np.polyadd(second, straight * made)))
        return made, shares

    def as_floats(self) -> tuple[np.ndarray, ...]:
        """e^(A h) - I, B0 and B1 (n, inputs), D and m (inputs,), C (n,)."""
        from scipy.linalg import matrix_balance

        n = self.step.rows
        step = np.array([[float(self.grown[i, j]) for j in range(n)] for i in range(n)])
        columns = [
            np.array([[float(x[i]) for x in one] for i in range(n)])
            for one in ([e[1] for e in self.inputs], [e[2] for e in self.inputs])
        ]
        now, before = (x.reshape(n, len(self.inputs)) for x in columns)
        straight = np.array([float(d) for *_, d in self.inputs])
        whole = np.array([m for m, *_ in self.inputs], dtype=float)
        c = np.eye(n)[0] if n else np.zeros(0)
        if not n:
            return np.zeros((0, 0)), now, before, straight, whole, c
        # units of the states: their sizes spread as the powers of the slowest pole
        _, (scale, _) = matrix_balance(step, permute=False, separate=True)
        beside = scale[:, None]
        return step * scale / beside, now / beside, before / beside, straight, whole, c * scale


@dataclass(frozen=True)
class _Growth:
    """Integrals of e^(A t) from 0 to any part of a sample, from those over halves of a sample.

    terms: elements of A^k / (k+1)!, row by row, for times up to the shortest half
    halves: e^(A t) and its integral for t = 2^-j, the shortest, up to 1
    """

    terms: tuple[list[mpmath.mpf], ...]
    halves: tuple[tuple[mpmath.matrix, mpmath.matrix], ...]

    @classmethod
    def of(cls, a: mpmath.matrix) -> _Growth:
        """The integrals for a matrix A, time in samples, with the digits that are set."""
        size = mpmath.mnorm(a, "inf")
        times = max(mpmath.mag(size), 0) + int(0.5 * mpmath.mp.prec**0.5)
        with mpmath.extraprec(2 * a.rows + times):
            shortest = mpmath.ldexp(1, -times)
            powers, left = [mpmath.eye(a.rows)], mpmath.mpf(1)
            while left > mpmath.eps:
                k = len(powers) + 1
                powers.append(powers[-1] * a / k)
                left = left * size * shortest / k
            terms = tuple(list(power) for power in powers)
            over = cls(terms, ())._up_to(shortest)
            halves = [(mpmath.eye(a.rows) + a * over, over)]
            for _ in range(times):
                step, over = halves[-1]
                halves.append((step * step, over + step * over))
        return cls(terms, tuple(halves))

    def _up_to(self, time: mpmath.mpf) -> mpmath.matrix:
        """The integral up to a time within the shortest half."""
        # lists: with matrices of `mpmath` this takes six times as long
        total = [x * time for x in self.terms[-1]]
        for term in reversed(self.terms[:-1]):
            total = [(x + y) * time for x, y in zip(total, term, strict=True)]
        n = math.isqrt(len(total))
        return mpmath.matrix([total[i * n : (i + 1) * n] for i in range(n)])

    def integral(self, time: mpmath.mpf) -> mpmath.matrix:
        """The integral of e^(A t) from 0 to a time of 0 to 1 samples."""
        times = len(self.halves) - 1
        whole = int(mpmath.floor(mpmath.ldexp(time, times)))
        total = self._up_to(time - mpmath.ldexp(whole, -times))
        for k, (step, over) in enumerate(self.halves):
            if whole >> k & 1:
                total = over + step * total
        return total


# a search for a margin moves the dead time of one plant
@lru_cache(maxsize=16)
def _growth_of(monic: tuple[Fraction, ...], digits: int) -> _Growth:
    """The integrals for a plant of these coefficients, highest power first, time in samples."""
    with mpmath.workdps(digits):
        return _Growth.of(_companion(monic))


def _companion(monic: Sequence[Fraction]) -> mpmath.matrix:
    """The matrix A of the states of a denominator whose first coefficient is 1."""
    n = len(monic) - 1
    a = mpmath.matrix(n, n)
    for i in range(n):
        a[i, 0] = as_mpf(-monic[i + 1])
        if i + 1 < n:
            a[i, i + 1] = mpmath.mpf(1)
    return a


def as_mpf(value: Fraction) -> mpmath.mpf:
    """The fraction in `mpmath`, with the present number of digits."""
    return mpmath.mpf(value.numerator) / value.denominator
