"""Responses of a linear diagram over frequency, from the equations of all states; numerical."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp

from .all_states import AllStates
from .linear_rows import Row, eliminate_numbers

#: symbols of a ring -> their numbers
SymbolNumbers = Mapping[sp.Symbol, float]


@dataclass(frozen=True, eq=False)
class Responses:
    """Responses of some signals to others, as a function of s and the values.

    wanted, given: names of signals;  more: equations of further names
    """

    states: AllStates
    wanted: Sequence[str]
    given: Sequence[str]
    more: Sequence[Row] = ()

    @cached_property
    def _rows(self) -> list[Row]:
        """The equations, with fewer unknowns; signals from outside that are not given are zero."""
        rows = self.states.rows_between(self.wanted, self.given, self.more)
        return eliminate_numbers(rows, {*self.wanted, *self.given})[1]

    @cached_property
    def _names(self) -> list[str]:
        """Unknowns, the wanted ones first, then the given signals."""
        names = dict.fromkeys([*self.wanted, *(n for row in self._rows for n in row)])
        return [*(n for n in names if n not in self.given), *self.given]

    @cached_property
    def _terms(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """All entries: row and column, and the first of its monomials; their numbers and powers."""
        columns = {n: k for k, n in enumerate(self._names)}
        entries = [(i, columns[n], p) for i, row in enumerate(self._rows) for n, p in row.items()]
        terms = [[(int(c.numerator) / int(c.denominator), k) for k, c in p.items()]
                 for *_, p in entries]  # fmt: skip
        sizes, powers = zip(*(term for p in terms for term in p), strict=True)
        starts = np.cumsum([0, *map(len, terms[:-1])])
        return np.array([e[:2] for e in entries]).T, starts, np.array(sizes), np.array(powers)

    def at(self, s: np.ndarray, numbers: SymbolNumbers | None = None) -> np.ndarray:
        """Values at each s (1/s, (n,)), (n, wanted, given); NaN where there is no single one.

        numbers: values that the equations hold as symbols
        """
        known = dict(numbers or {})
        late = {x: float(sp.sympify(t).xreplace(known)) for x, t in self.states.times.items()}
        entries, starts, sizes, powers = self._terms
        total = np.broadcast_to(sizes.astype(complex), (len(s), len(sizes)))
        for k, x in enumerate(self.states.ring.symbols):
            if powers[:, k].any():
                factor = s[:, None] if k == 0 else late.get(x, known.get(x))
                base = np.exp(-s[:, None] * factor) if x in late else factor
                total = total * base ** powers[:, k]
        count, size = len(self._names) - len(self.given), (len(s), len(self._rows))
        matrix = np.zeros((*size, len(self._names)), dtype=complex)
        matrix[:, entries[0], entries[1]] = np.add.reduceat(total, starts, axis=1)
        matrix /= np.abs(matrix).max(axis=2, keepdims=True)
        return _solve(matrix[:, :, :count], -matrix[:, :, count:])[:, : len(self.wanted)]


def _solve(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solutions of each system, (n, unknowns, given); NaN where it is singular."""
    try:
        return np.asarray(np.linalg.solve(left, right))
    except np.linalg.LinAlgError:
        if len(left) == 1:
            return np.full((1, left.shape[2], right.shape[2]), np.nan, dtype=complex)
        half = len(left) // 2
        return np.concatenate(
            [_solve(left[:half], right[:half]), _solve(left[half:], right[half:])]
        )
