"""Signals with their derivatives by parameters, and laws that compute both.

`Along` holds the signals and values for laws along one motion, and the parameters of the tangents.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from ..effects import SIGNALS, Effect, Role, sort_by_action
from ..measurement.filtering import Array
from .tangent_columns import Probe, TangentColumns


@dataclass(frozen=True)
class Traced:
    """A signal of n samples and its tangents (p, n) by p parameters.

    moving: rows of the tangents that may differ from zero; None: any of them
    """

    value: Array
    tangent: Array
    moving: tuple[int, ...] | None = None

    def rows(self, at: slice | NDArray[np.intp] = slice(None)) -> Array:
        """Value and tangents as rows of one array (1 + p, n);  at: selected samples."""
        return np.vstack([self.value[at][None], self.tangent[:, at]])

    def at(self, samples: slice) -> Traced:
        """The signal at a slice of samples."""
        return Traced(self.value[samples], self.tangent[:, samples], self.moving)

    @property
    def is_constant(self) -> bool:
        """Whether no parameter changes the signal."""
        if self.tangent.strides == (0, 0):
            return True
        return self.moving == () or (self.moving is None and not self.tangent.any())

    @property
    def moving_rows(self) -> Sequence[int]:
        """Rows of the tangents that may differ from zero: all of them where it is not known."""
        return range(len(self.tangent)) if self.moving is None else self.moving

    def __add__(self, other: Traced) -> Traced:
        value = self.value + other.value
        if other.is_constant:
            return Traced(value, self.tangent, self.moving)
        return Traced(value, self.tangent + other.tangent, joined_rows(self, other))

    def __sub__(self, other: Traced) -> Traced:
        return self.subtract([other])

    def subtract(self, others: Sequence[Traced]) -> Traced:
        """The signal less others; of their tangents only rows that may not be zero are read."""
        value = self.value
        for other in others:
            value = value - other.value
        changing = [other for other in others if not other.is_constant]
        if not changing:
            return Traced(value, self.tangent, self.moving)
        tangent = np.array(self.tangent)
        for other in changing:
            for j in other.moving_rows:
                tangent[j] -= other.tangent[j]
        return Traced(value, tangent, joined_rows(self, *changing))

    def times(self, factor: Array | float) -> Traced:
        """The signal times a factor, (n,) or the same at each sample."""
        if self.is_constant or self.moving is None:
            tangent = self.tangent if self.is_constant else self.tangent * factor
            return Traced(self.value * factor, tangent, self.moving)
        tangent = np.zeros(self.tangent.shape)
        for j in self.moving:
            tangent[j] = self.tangent[j] * factor
        return Traced(self.value * factor, tangent, self.moving)


def joined_rows(*signals: Traced, more: Iterable[int] = ()) -> tuple[int, ...] | None:
    """Rows of tangents that may differ from zero in any of these signals; None: all may.

    more: further such rows
    """
    rows = set(more)
    for signal in signals:
        if signal.tangent.strides == (0, 0):
            continue
        if signal.moving is None:
            return None
        rows.update(signal.moving)
    return tuple(sorted(rows))


def in_rows(value: Array, tangent: Array, rows: Collection[int], parameters: int) -> Traced:
    """A signal (n,) whose tangents are given in some rows, in order; the other rows are zero."""
    if len(rows) == parameters:
        return Traced(value, tangent, tuple(rows))
    whole = np.zeros((parameters, len(value)))
    whole[list(rows)] = tangent
    return Traced(value, whole, tuple(rows))


def choose(condition: NDArray[np.bool_], one: Traced, other: Traced) -> Traced:
    """One signal at the samples where the condition (n,) holds, the other elsewhere."""
    if one is other:
        return one
    value = np.where(condition, one.value, other.value)
    tangent = np.where(condition, one.tangent, other.tangent)
    return Traced(value, tangent, joined_rows(one, other))


def constant(value: Array, parameters: int) -> Traced:
    """A signal (n,) that no parameter changes; its (p, n) tangents use no memory."""
    return Traced(value, _zero_signal(parameters, len(value)))


@lru_cache(maxsize=256)
def _zero_signal(parameters: int, n: int) -> Array:
    return np.broadcast_to(0.0, (parameters, n))


def filter_traced(filtered: Callable[[Array], Array], signal: Traced) -> Traced:
    """A signal and its tangents after a linear filter; tangents that are zero stay zero."""
    if signal.is_constant:
        return constant(filtered(signal.value), len(signal.tangent))
    rows = signal.moving
    if rows is None:
        rows = tuple(np.flatnonzero(signal.tangent.any(axis=1)).tolist())
    every = len(rows) == len(signal.tangent)
    tangent = signal.tangent if every else signal.tangent[list(rows)]
    both = filtered(np.vstack([signal.value[None], tangent]))
    return in_rows(both[0], both[1:], rows, len(signal.tangent))


@dataclass(frozen=True)
class Along:
    """Signals and values for laws along one motion of n samples.

    signals: symbol -> signal with its tangents;  values: parameter symbol -> value (SI)
    columns: the p parameters and probes of the tangents (p, n), also as a plain tuple
    step: s between samples
    """

    signals: Mapping[sp.Symbol, Traced]
    values: Mapping[sp.Symbol, float]
    columns: TangentColumns
    step: float

    def __post_init__(self) -> None:
        if not isinstance(self.columns, TangentColumns):
            object.__setattr__(self, "columns", TangentColumns(self.columns))

    def __len__(self) -> int:
        """Number of samples."""
        return len(next(iter(self.signals.values())).value)

    def with_signals(self, signals: Mapping[sp.Symbol, Traced]) -> Along:
        """The same with additional or other signals."""
        return Along({**self.signals, **signals}, self.values, self.columns, self.step)

    def constant(self, signal: Array) -> Traced:
        """A signal (n,) that no parameter changes."""
        return constant(signal, len(self.columns))

    def evaluate(self, law: sp.Expr) -> Traced:
        """A law on these signals and values, with tangents by `TRACED` and hidden states."""
        return _law_of(law, tuple(s for s in self.signals if s not in _KNOWN))(self)

    def present(self, effects: Sequence[Effect], role: Role) -> list[Effect]:
        """Effects of a role, without absent effects with states: their laws may divide by 0."""
        return [
            e
            for e in _in_order_of_action(tuple(effects), role)
            if not (e.states and e.is_absent(self.values))
        ]


@lru_cache(maxsize=4096)
def _in_order_of_action(effects: tuple[Effect, ...], role: Role) -> tuple[Effect, ...]:
    return tuple(sort_by_action(effects, role))


@dataclass(frozen=True)
class NumericLaw:
    """A sympy expression as a numpy function of signals and parameters, with derivatives.

    joins: the expression joins conditions, which numpy does only where both are as long
    """

    expression: sp.Expr
    signals: tuple[sp.Symbol, ...]
    parameters: tuple[sp.Symbol, ...]
    call: Callable[..., Any]
    joins: bool = False

    @cached_property
    def _among_parameters(self) -> frozenset[Any]:
        """The parameters, to look up: on short records a comparison of each symbol takes longer."""
        return frozenset(self.parameters)

    def __call__(self, along: Along) -> Traced:
        signals, values, columns = along.signals, along.values, along.columns
        arrays = [signals[s].value for s in self.signals]
        n = len(along)
        with np.errstate(under="ignore", over="ignore", divide="ignore", invalid="ignore"):
            out = self.call(*arrays, *self._numbers(values, n))
        value = np.empty(n)
        value[:] = out[0]  # a constant law gives one number
        moved = [s for s in self.signals if not signals[s].is_constant]
        mine = [j for j, s in enumerate(columns.symbols) if s in self._among_parameters]
        if not moved and not mine:
            return constant(value, len(columns))
        by_signal = dict(zip(self.signals, out[1 : 1 + len(arrays)], strict=True))
        tangent = np.zeros((len(columns), n))
        for s in moved:
            for j in signals[s].moving_rows:
                tangent[j] += by_signal[s] * signals[s].tangent[j]
        for p, d in zip(self.parameters, out[1 + len(arrays) :], strict=True):
            if (place := columns.places.get(p)) is not None:
                tangent[place] += d
        for j in mine:
            if isinstance(column := columns[j], Probe):
                tangent[j] += self._slope(column, arrays, values)
        return Traced(value, tangent, joined_rows(*(signals[s] for s in moved), more=mine))

    def _numbers(self, values: Mapping[sp.Symbol, float], n: int) -> list[Any]:
        """Values of the parameters, as the function takes them beside n samples."""
        numbers = [np.float64(values[p]) for p in self.parameters]
        return [np.full(n, x) for x in numbers] if self.joins else numbers

    def _slope(
        self, probe: Probe, arrays: Sequence[Array], values: Mapping[sp.Symbol, float]
    ) -> Any:
        """Derivative by the probe's strength, at the probe's values of the other parameters."""
        at = {p: probe.values.get(p, values[p]) for p in self.parameters}
        numbers = self._numbers(at, len(arrays[0]) if arrays else 1)
        call = _slope_call(self.expression, self.signals, self.parameters, probe.symbol)
        with np.errstate(under="ignore", over="ignore", divide="ignore", invalid="ignore"):
            return call(*arrays, *numbers)


_SIGNALS = tuple(SIGNALS.values())
_KNOWN = frozenset(_SIGNALS)
#: signals that depend on parameters, or on time shifts of their logs
TRACED = frozenset(
    {
        SIGNALS[name]
        for name in ("command", "acting_force", "carried_force", "interaction_force", "level")
    }
)


def slope(expression: sp.Expr, symbol: sp.Symbol) -> sp.Expr:
    """Derivative almost everywhere; at a jump, such as of sgn, the derivative beside it."""
    return sp.diff(expression, symbol).replace(sp.DiracDelta, lambda *_: sp.S(0))


def numpy_function(
    arguments: Sequence[sp.Symbol], expressions: sp.Expr | list[sp.Expr]
) -> Callable[..., Any]:
    """A numpy function of one expression, or of a list of them, without a text that documents it.

    A condition that chooses between conditions is written without: printed, it is no condition.
    """

    def plain(expression: sp.Expr) -> sp.Expr:
        return expression.replace(
            sp.ITE, lambda c, yes, no: sp.Or(sp.And(c, yes), sp.And(sp.Not(c), no))
        )

    several = isinstance(expressions, list)
    printed = [plain(e) for e in expressions] if several else plain(expressions)
    call: Callable[..., Any]
    call = sp.lambdify(arguments, printed, "numpy", cse=True, docstring_limit=0)
    return call


@lru_cache(maxsize=512)
def _law_of(expression: sp.Expr, more: tuple[sp.Symbol, ...]) -> NumericLaw:
    """The expression as a numpy function; every symbol that is no signal is a parameter.

    more: additional signals, which have tangents
    """
    signals, traced = (*_SIGNALS, *more), TRACED | set(more)
    used = tuple(s for s in signals if expression.has(s))
    parameters = tuple(sorted(expression.free_symbols - set(signals), key=str))
    gradients = [slope(expression, s) if s in traced else sp.S(0) for s in used]
    results = [expression, *gradients, *(slope(expression, p) for p in parameters)]
    joins = any(e.has(sp.And, sp.Or, sp.ITE) for e in results)
    call = numpy_function([*used, *parameters], results)
    return NumericLaw(expression, used, parameters, call, joins)


@lru_cache(maxsize=512)
def _slope_call(
    expression: sp.Expr,
    signals: tuple[sp.Symbol, ...],
    parameters: tuple[sp.Symbol, ...],
    symbol: sp.Symbol,
) -> Callable[..., Any]:
    """One derivative of a law as a numpy function of its signals and parameters."""
    return numpy_function([*signals, *parameters], slope(expression, symbol))
