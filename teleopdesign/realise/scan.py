"""Hidden states of an effect along a measured motion, with tangents, stepped from row to row.

A state whose rate is affine in it, dz/dt = A z + B, advances exactly over a sample in which its
signals are held: z(t + h) = e^x z + h phi_1(x) B with x = A h; the average over the sample is
phi_1(x) z + h phi_2(x) B. A state with a stop follows its rate up to the stop. Tangents follow by
differentiating the same expressions.

Several coupled states, such as a tip body, take Runge-Kutta steps; sub-steps keep the fastest mode
well within the method's stability. Between rows the driving motion is interpolated by a cubic with
its rates, because a straight line weakens an oscillation at a tenth of the sample rate by 3 %.

A state that declares a correction is led back by the unexplained force r, as by an observer: dz/dt
= rate + correction(r), r = rest - law - friction, 0 where friction can balance it. Without the
correction, two bodies that part and meet differ from the machine after a few meetings. Dry friction
on a state is a constant rate over each sub-step: the rate that brings the state to rest at the end
of the sub-step, within the bound of the friction (time stepping by Moreau and Jean). A stuck state
rests, without a stiff law.

Where a sequence of meetings depends on its past ever more strongly, so do its tangents, until they
describe no finite change of a parameter. So they restart wherever a small difference has grown by
`GROWTH` since it was smallest.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from types import MappingProxyType
from typing import Any

import numpy as np
import sympy as sp

from ..effects import SIGNALS, UNEXPLAINED, Effect
from ..measurement.filtering import Array
from ._coupled_source import write_coupled
from ._scan_source import list_drivers, list_parameters, list_traced, write_exact
from .compiled import compile_source
from .traced import Along, Traced, in_rows, joined_rows

#: angle of the fastest mode (rad) that one sub-step should cover (at half a radian the mode swings
#: 0.05 % too slowly, at one radian 0.8 %); most sub-steps; and angle that one may cover at most
MODE_STEP, MOST_STEPS, STABLE = 0.5, 16, 2.0
#: growth of a small difference between two solutions after which tangents begin anew
GROWTH = 30.0
#: driving signal -> the signal that is its rate of change
_RATES = {
    SIGNALS["position"]: SIGNALS["velocity"],
    SIGNALS["velocity"]: SIGNALS["acceleration"],
}


def exact_scan(
    effect: Effect,
    along: Along,
    *laws: sp.Expr,
    part: Traced | None = None,
    at_start: Mapping[sp.Symbol, Traced] = MappingProxyType({}),
) -> list[Traced]:
    """Laws on states with stops, or on one with an affine rate, at the end of each sample.

    laws: none: the average of the only state over each sample
    part: (1,) part of where they stay at which they start; None: all of it
    at_start: signals that differ there, of which the first sample counts
    """
    symbols, count = list_drivers(effect, laws), len(along.columns)
    signals, traced = [along.signals[s] for s in symbols], list_traced(symbols)
    driving = [signals[i] for i in traced]
    parameters, unit, rows = _parameters(
        effect, along, driving if part is None else [*driving, part]
    )
    u, du = _arrays(signals, driving, len(along), rows)
    first, dfirst = u[:, 0].copy(), du[:, 0].copy()
    for symbol in at_start.keys() & set(symbols):
        i, start = symbols.index(symbol), at_start[symbol]
        first[i] = start.value[0]
        if i in traced:
            dfirst[traced.index(i)] = start.tangent[rows, 0]
    share = 1.0 if part is None else float(part.value[0])
    dshare = np.zeros(len(rows)) if part is None else part.tangent[rows, 0].copy()
    out = np.empty((max(len(laws), 1), len(along)))
    tangent = np.empty((len(out), len(rows), len(along)))
    scan = compile_source(write_exact(effect, laws), "scan")
    scan(along.step, share, dshare, parameters, unit, first, dfirst, u, du, out, tangent)
    return [in_rows(y, dy, rows, count) for y, dy in zip(out, tangent, strict=True)]


def _parameters(
    effect: Effect, along: Along, signals: Sequence[Traced]
) -> tuple[Array, Array, list[int]]:
    """Values (p,) of the parameters, their tangents (p, q), and the rows of these q tangents.

    signals: those by which the tangents of the states may differ from zero, besides parameters
    """
    symbols = list_parameters(effect)
    places = [along.columns.of_symbols.get(s, -1) for s in symbols]
    moving = joined_rows(*signals, more=[i for i in places if i >= 0])
    rows = list(range(len(along.columns)) if moving is None else moving)
    unit = np.equal.outer(np.array(places, dtype=int), np.array(rows, dtype=int))
    return np.array([along.values[s] for s in symbols], dtype=float), 1.0 * unit, rows


def _arrays(
    signals: Sequence[Traced], traced: Sequence[Traced], n: int, rows: list[int], more: int = 0
) -> tuple[Array, Array]:
    """Signals (m, n), and in these rows the tangents (t, n, q) of the traced ones.

    more: further columns of zeros
    """
    values = np.array([signal.value for signal in signals]).reshape(len(signals), n)
    tangents = np.zeros((len(traced), n, len(rows) + more))
    for mine, signal in zip(tangents, traced, strict=True):
        if not signal.is_constant:
            mine[:, : len(rows)] = signal.tangent[rows].T
    return values, tangents


@lru_cache(maxsize=32)
def _stiffness(effect: Effect) -> tuple[list[str], Any]:
    """Names of signals, and a function of them and the parameters: Jacobian of the rates (1/s).

    Laws with gaps or stops are evaluated where they are stiffest, by the first of their pieces,
    with every state at the signal that it starts at.
    """
    # a correction is fastest where the unexplained force is small, and linear in this force there
    law, corrections = effect.expression(), effect.corrections()
    rates = [
        rate - law * sp.diff(corrections.get(name, sp.S(0)), UNEXPLAINED).subs(UNEXPLAINED, 0)
        for name, rate in effect.rates().items()
    ]
    rates = [r.replace(sp.Piecewise, lambda *pieces: pieces[0][0]) for r in rates]
    symbols = effect.state_symbols()
    starts = {symbols[n]: SIGNALS[s.start] if s.start else 0 for n, s in effect.states.items()}
    matrix = sp.Matrix(rates).jacobian(list(starts)).subs(starts)
    names = [n for n, s in SIGNALS.items() if matrix.has(s)]
    return names, sp.lambdify(
        [[SIGNALS[n] for n in names], list_parameters(effect)], matrix, "numpy"
    )


def _fastest(effect: Effect, along: Along, parameters: Array) -> float:
    """Largest rate (rad/s) of the coupled states, at the extremes of the measured motion."""
    names, slopes = _stiffness(effect)
    signals = [along.signals[SIGNALS[n]].value for n in names]
    ends = {int(end(row)) for row in signals for end in (np.argmin, np.argmax)} or {0}
    fastest = 0.0
    for end in ends:
        with np.errstate(invalid="ignore"):  # a law beyond where it begins, such as a root
            at_end = np.array(slopes([row[end] for row in signals], parameters), dtype=float)
        fastest = max(fastest, float(np.abs(np.linalg.eigvals(np.nan_to_num(at_end))).max()))
    return fastest


def _slope_of(signal: sp.Symbol, along: Along) -> Array | None:
    """Rate of change of a driving signal at the rows; None where no rate is known."""
    return along.signals[_RATES[signal]].value if signal in _RATES else None


def _bends(drive: Array, slopes: Sequence[Array | None], step: float) -> Array:
    """Slope less chord of each signal (m, n) at both ends of each step, in its units, (2, m, n)."""
    bends = np.zeros((2, *drive.shape))
    for i, slope in enumerate(slopes):
        if slope is not None:
            chord = np.diff(drive[i])
            bends[0, i, :-1] = step * slope[:-1] - chord
            bends[1, i, :-1] = step * slope[1:] - chord
    return bends


def coupled_scan(
    effect: Effect, along: Along, rest: Sequence[Traced] = ()
) -> dict[sp.Symbol, Traced]:
    """Coupled states at the rows, driven by the measured signals.

    along: signals at the rows
    rest: signals of corrections: force at the rows for the effect and friction together, least and
        largest friction; with tangents
    returns: NaN where the states are too fast for the sample rate
    """
    symbols, states = list_drivers(effect), effect.states.values()
    corrected = rest if effect.corrections() else ()
    signals = [*(along.signals[s] for s in symbols), *corrected]
    traced = [*(signals[i] for i in list_traced(symbols)), *corrected]
    parameters, unit, rows = _parameters(effect, along, traced)
    start = [along.signals[SIGNALS[s.start]].value[0] if s.start else 0.0 for s in states]
    out = np.full((len(start), len(along)), np.nan)
    tangent = np.full((len(start), len(rows), len(along)), np.nan)
    fastest = _fastest(effect, along, parameters)
    covered = along.step * fastest
    if covered <= STABLE * MOST_STEPS:
        steps = int(np.clip(np.ceil(covered / MODE_STEP), 1, MOST_STEPS))
        more = 1 if rows else 0  # a difference without input
        u, du = _arrays(signals, traced, len(along), rows, more)
        bends = _bends(u, [_slope_of(s, along) for s in symbols], along.step)
        # scale: a difference of 1 in position, and of the rate of the fastest mode in velocity
        rate = max(fastest, 1e-300)
        size = np.array([rate if s.quantity == "velocity" else 1.0 for s in states])
        growth = GROWTH if effect.corrections() and not effect.linear else np.inf
        scan = compile_source(write_coupled(effect), "scan")
        unit = np.column_stack([unit, *[np.zeros(len(unit))] * more])
        known = (along.step, steps, parameters, unit, u, bends, du)
        scan(*known, size, growth, np.array(start), out, tangent)
    if not np.isfinite(out).all():
        # too fast for the sample rate: NaN instead of a wrong number
        out[:], tangent[:] = np.nan, np.nan
    labelled = zip(effect.state_symbols().values(), out, tangent, strict=True)
    return {symbol: in_rows(z, dz, rows, len(along.columns)) for symbol, z, dz in labelled}
