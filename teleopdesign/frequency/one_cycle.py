"""A law along one cycle of a sinusoidal motion, with hidden states that repeat.

Rates that are affine in their state, A z + B, are integrated exactly over each step with A and B at
its middle (second order). The start from which a cycle closes follows from the decay of each state
over the cycle.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp

from ..base.errors import ModelError
from .lock_in import phasors

#: steps of a cycle. Forces are taken in the middle of each: no step lies on a reversal
STEPS = 2000
#: largest change of a state over a cycle, relative to its largest size, that counts as periodic;
#: and most cycles
_CLOSED, _MOST_CYCLES = 1e-9, 200
_Call = Callable[..., list[float]]


@dataclass(frozen=True)
class LawExpressions:
    """An output and its hidden states, as expressions of signals.

    rates: state -> its rate;  where: name of the law, in messages
    """

    output: sp.Expr
    rates: Mapping[sp.Symbol, sp.Expr]
    where: str

    @cached_property
    def force(self) -> tuple[tuple[sp.Symbol, ...], Callable[..., np.ndarray]]:
        """Symbols on which the output depends, and the output as a function of their arrays."""
        used = tuple(sorted(self.output.free_symbols, key=str))
        return used, sp.lambdify(used, self.output, "numpy", cse=True)


def first_harmonic(
    law: LawExpressions, signals: Mapping[sp.Symbol, np.ndarray], *, frequency: float | np.ndarray
) -> np.ndarray:
    """First harmonic of the law's output over a closed cycle, (...); sin is 1, cos is j.

    signals: symbol -> values (..., STEPS) in the middle of equal steps of one cycle from phase 0
    frequency: Hz, a number if the law has hidden states
    raises ModelError: the law needs another signal, or its states do not repeat
    """
    needed = law.output.free_symbols.union(*(r.free_symbols for r in law.rates.values()))
    if strangers := sorted(str(s) for s in needed - {*signals, *law.rates}):
        raise ModelError(
            f"{law.where}: no describing function, for it depends on {', '.join(strangers)}"
        )
    states = _close_cycle(law, signals, 1 / (float(frequency) * STEPS)) if law.rates else {}
    along = {**signals, **states}
    used, call = law.force
    with np.errstate(all="ignore"):  # a piecewise law is computed also where it does not hold
        force = np.asarray(call(*(along[s] for s in used)), dtype=float)
    if not np.isfinite(force).all():
        raise ModelError(f"{law.where}: the force is not finite along this motion")
    force = np.broadcast_to(force, np.broadcast_shapes(force.shape, (STEPS,)))
    # taken half a step after the nodes of `phasors`
    return np.asarray(phasors(force) * np.exp(-1j * np.pi / STEPS))


def middles() -> np.ndarray:
    """Phase omega t in the middle of each step of a cycle, (STEPS,)."""
    return 2 * np.pi * (np.arange(STEPS) + 0.5) / STEPS


def _close_cycle(
    law: LawExpressions, signals: Mapping[sp.Symbol, np.ndarray], step: float
) -> dict[sp.Symbol, np.ndarray]:
    """Hidden states in the middle of each step of a cycle that ends where it began."""
    states = [*law.rates]
    call = _slopes_and_rest(law, [*signals])
    rows = np.column_stack([*signals.values()]).tolist()
    start = np.zeros(len(states))
    for _ in range(_MOST_CYCLES):
        values, decay, end = _cycle(call, rows, start, step)
        size = np.maximum(np.abs(values).max(axis=0), np.finfo(float).tiny)
        if (np.abs(end - start) <= _CLOSED * size).all():
            return dict(zip(states, values.T, strict=True))
        # z -> decay z + c closes at c/(1 - decay); states that do not decay take their time
        kept = np.minimum(decay, 1 - 1e-9)
        start = start + (end - start) / (1 - kept)
    raise ModelError(f"{law.where}: hidden states do not repeat from cycle to cycle")


def _slopes_and_rest(law: LawExpressions, signals: list[sp.Symbol]) -> _Call:
    slopes = []
    for state, rate in law.rates.items():
        slope = sp.diff(rate, state)
        if slope.has(state):
            raise ModelError(
                f"{law.where}: no describing function, for {state} rests or slips by what it is "
                "itself: measure its impedance in simulation (`measured_impedance`)"
            )
        slopes.append(slope)
    rest = [rate.xreplace({state: sp.S(0)}) for state, rate in law.rates.items()]
    # plain numbers: arrays of one or two states would cost ten times as much
    function: _Call = sp.lambdify([*law.rates, *signals], [*slopes, *rest], "math", cse=True)
    return function


def _cycle(
    call: _Call, rows: list[list[float]], start: np.ndarray, step: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """States in the middle of the steps, decay of each initial state, and states at the end."""
    state = start.tolist()
    n = len(state)
    values, exponent = [], [0.0] * n
    for row in rows:
        derivatives = call(*state, *row)
        middle = [
            _advance(z, a, b, step / 2)
            for z, a, b in zip(state, derivatives, derivatives[n:], strict=False)
        ]
        derivatives = call(*middle, *row)
        state = [
            _advance(z, a, b, step)
            for z, a, b in zip(state, derivatives, derivatives[n:], strict=False)
        ]
        exponent = [e + a * step for e, a in zip(exponent, derivatives, strict=False)]
        values.append(middle)
    return np.array(values), np.exp(exponent), np.array(state)


def _advance(state: float, a: float, b: float, step: float) -> float:
    """The state after a step of its rate a z + b."""
    x = a * step
    share = 1 + x / 2 if abs(x) < 1e-8 else math.expm1(x) / x
    return state * math.exp(x) + step * share * b
