"""Signals with their derivatives by parameters, and laws that carry both."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp

from ..effects import SIGNALS
from ..measurement.filtering import Array


@dataclass(frozen=True)
class Traced:
    """A signal of n samples and its tangents (p, n) by the p parameters asked for."""

    value: Array
    tangent: Array

    def rows(self) -> Array:
        """Value and tangents as rows of one array (1 + p, n)."""
        return np.vstack([self.value[None], self.tangent])

    def __add__(self, other: Traced) -> Traced:
        return Traced(self.value + other.value, self.tangent + other.tangent)

    def __sub__(self, other: Traced) -> Traced:
        return Traced(self.value - other.value, self.tangent - other.tangent)


def through(filtered: Callable[[Array], Array], signal: Traced) -> Traced:
    """A signal and its tangents through a linear filter; tangents that are zero stay so."""
    moving = signal.tangent.any(axis=1)
    both = filtered(np.vstack([signal.value[None], signal.tangent[moving]]))
    tangent = np.zeros((len(signal.tangent), both.shape[-1]))
    tangent[moving] = both[1:]
    return Traced(both[0], tangent)


@dataclass(frozen=True, eq=False)
class Probe:
    """A direction in which a model may be changed: the strength of an effect that it has at zero.

    at: place;  symbol: of the strength;  values: parameter symbol -> value, of the effect's others
    """

    at: str
    symbol: sp.Symbol
    values: Mapping[sp.Symbol, float]


@dataclass(frozen=True)
class Law:
    """A sympy expression as a numpy function of signals and parameters, with its derivatives."""

    signals: tuple[sp.Symbol, ...]
    parameters: tuple[sp.Symbol, ...]
    call: Callable[..., Any]

    def __call__(
        self,
        given: Mapping[sp.Symbol, Traced],
        values: Mapping[sp.Symbol, float],
        wrt: Sequence[Any],
    ) -> Traced:
        arrays = [given[s].value for s in self.signals]
        n = len(next(iter(given.values())).value)
        with np.errstate(under="ignore", over="ignore", divide="ignore", invalid="ignore"):
            out = self.call(*arrays, *[np.float64(values[p]) for p in self.parameters])
        value = np.broadcast_to(np.asarray(out[0], dtype=float), (n,))
        tangent = np.zeros((len(wrt), n))
        for p, d in zip(self.parameters, out[1 + len(arrays) :], strict=True):
            if p in wrt:
                tangent[list(wrt).index(p)] += d
        for j, column in enumerate(wrt):
            if isinstance(column, Probe) and column.symbol in self.parameters:
                tangent[j] += self._slope(column, arrays, values)
        for s, d in zip(self.signals, out[1 : 1 + len(arrays)], strict=True):
            if given[s].tangent.any():
                tangent += d * given[s].tangent
        return Traced(value.copy(), tangent)

    def _slope(
        self, probe: Probe, arrays: Sequence[Array], values: Mapping[sp.Symbol, float]
    ) -> Any:
        """Derivative by the probe's strength, at the probe's values of the other parameters."""
        own = [np.float64(probe.values.get(p, values[p])) for p in self.parameters]
        with np.errstate(under="ignore", over="ignore", divide="ignore", invalid="ignore"):
            out = self.call(*arrays, *own)
        return out[1 + len(arrays) + self.parameters.index(probe.symbol)]


#: signals that depend on parameters themselves
TRACED = frozenset({SIGNALS["command"], SIGNALS["acting_force"], SIGNALS["level"]})


@lru_cache(maxsize=512)
def law_of(
    expression: sp.Expr,
    signals: tuple[sp.Symbol, ...] = tuple(SIGNALS.values()),
    traced: frozenset[sp.Symbol] = TRACED,
) -> Law:
    """The expression as a Law; every symbol that is no signal is a parameter.

    traced: the signals that carry tangents; the motion is given and carries none
    """
    used = tuple(s for s in signals if expression.has(s))
    parameters = tuple(sorted(expression.free_symbols - set(signals), key=str))
    gradients = [sp.diff(expression, s) if s in traced else sp.S(0) for s in used]
    gradients += [sp.diff(expression, p) for p in parameters]
    call = sp.lambdify([*used, *parameters], [expression, *gradients], "numpy", cse=True)
    return Law(used, parameters, call)
