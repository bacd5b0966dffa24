"""Characteristic functions of systems with dead times (quasi-polynomials), in exact numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ...controllers import exact_decimal

ExactEnds = tuple[Fraction, Fraction]
#: a quasi-polynomial at a point: dead time (s) -> coefficients of s, highest power first
ExactTerms = Mapping[Fraction, Sequence[Fraction]]


@dataclass(frozen=True)
class LateTerms:
    """A quasi-polynomial: f(s) = sum of coefficient * s^k * values^a * e^(-s sum b T).

    coefficients: (m);  powers: k, a and b of each term, (m, 1 + values + times)
    values: intervals of the values;  times: of the dead times T, s; only the upper end is used
    places, late: index of each value and of each time in a point of the box; -1: fixed
    """

    coefficients: tuple[Fraction, ...]
    powers: np.ndarray
    values: tuple[ExactEnds, ...]
    times: tuple[ExactEnds, ...]
    places: tuple[int, ...]
    late: tuple[int, ...]

    @property
    def degree(self) -> int:
        """The highest power of s."""
        return int(self.powers[:, 0].max())

    def exactly_at(self, point: np.ndarray) -> ExactTerms:
        """The quasi-polynomial at a point of the box, exactly; a float is its shortest decimal."""
        values = [_fraction(point[i]) for i in self.places]
        known = zip(self.late, self.times, strict=True)
        times = [_fraction(point[i]) if i >= 0 else longest for i, (_, longest) in known]
        n, made = len(values), dict[Fraction, list[Fraction]]()
        for coefficient, row in zip(self.coefficients, self.powers.tolist(), strict=True):
            k, a, b = row[0], row[1 : 1 + n], row[1 + n :]
            late = sum((t * e for t, e in zip(times, b, strict=True)), Fraction(0))
            for value, power in zip(values, a, strict=True):
                coefficient *= value**power
            made.setdefault(late, [Fraction(0)] * (self.degree + 1))[self.degree - k] += coefficient
        return {t: p for t, p in ((t, _drop_zeros(p)) for t, p in sorted(made.items())) if p}

    def at(self, point: np.ndarray) -> dict[float, np.ndarray]:
        """As `exactly_at`, but in floats, with all coefficients divided by the largest one."""
        exact = self.exactly_at(point)
        most = max((abs(c) for p in exact.values() for c in p), default=Fraction(1))
        return {float(t): np.array([float(c / most) for c in p]) for t, p in exact.items()}

    def groups(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """(b, indices of terms) for each late factor e^(-s sum b T); without dead time first."""
        late = self.powers[:, 1 + len(self.values) :]
        kinds = np.unique(late, axis=0)
        kinds = kinds[np.argsort(kinds.sum(axis=1), kind="stable")]
        return [(b, np.flatnonzero((late == b).all(axis=1))) for b in kinds]


def _fraction(value: float) -> Fraction:
    return Fraction(str(exact_decimal(float(value))))


def _drop_zeros(coefficients: Sequence[Fraction]) -> list[Fraction]:
    """The coefficients without leading zeros."""
    first = next((i for i, c in enumerate(coefficients) if c), len(coefficients))
    return list(coefficients[first:])
