"""Several coupled hidden states along a measured motion, such as a tip body, with tangents.

Runge-Kutta steps; sub-steps keep the fastest mode well within the method's stability. Between rows
the driving motion is interpolated by a cubic with its rates, because a straight line weakens an
oscillation at a tenth of the sample rate by 3 %. The code is generated from the effect's rates.

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

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp

from ..effects import SIGNALS, UNEXPLAINED, Effect
from ..measurement.filtering import Array
from ._ode_scan_source import list_drivers, list_parameters, write_scan
from .compiled import compile_source
from .traced import Along, Traced, joined_rows

#: angle of the fastest mode (rad) that one sub-step should cover (at half a radian the mode swings
#: 0.05 % too slowly, at one radian 0.8 %); most sub-steps; and angle that one may cover at most
MODE_STEP, MOST_STEPS, STABLE = 0.5, 16, 2.0
#: growth of a small difference between two solutions after which tangents begin anew
GROWTH = 30.0


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


#: driving signal -> the signal that is its rate of change
_RATES = {"position": "velocity", "velocity": "acceleration"}


def _slope_of(name: str, along: Along) -> Array | None:
    """Rate of change of a driving signal at the rows; None where no rate is known."""
    if name in _RATES:
        return along.signals[SIGNALS[_RATES[name]]].value
    return None


def _bends(drive: Array, slopes: Sequence[Array | None], step: float) -> Array:
    """Slope less chord of each signal (m, n) at both ends of each step, in its units, (2, m, n)."""
    bends = np.zeros((2, *drive.shape))
    for i, slope in enumerate(slopes):
        if slope is not None:
            chord = np.diff(drive[i])
            bends[0, i, :-1] = step * slope[:-1] - chord
            bends[1, i, :-1] = step * slope[1:] - chord
    return bends


def ode_scan(effect: Effect, along: Along, rest: Sequence[Traced] = ()) -> dict[sp.Symbol, Traced]:
    """The effect's hidden states at the rows, with tangents, driven by the measured signals.

    along: signals at the rows, which have no tangents here
    rest: signals of corrections: force at the rows for the effect and friction together, least and
        largest friction; with tangents
    returns: NaN where the states are too fast for the sample rate
    """
    parameters_of_effect, signals, step, columns = (
        list_parameters(effect),
        along.signals,
        along.step,
        along.columns,
    )
    parameters = np.array([along.values[s] for s in parameters_of_effect], dtype=float)
    places = np.array([columns.of_symbols.get(s, -1) for s in parameters_of_effect], dtype=int)
    fastest = _fastest(effect, along, parameters)
    covered = step * fastest
    steps = int(np.clip(np.ceil(covered / MODE_STEP), 1, MOST_STEPS))
    corrected = rest if effect.corrections() else ()
    drivers = [signals[SIGNALS[n]].value for n in list_drivers(effect)]
    drive = np.ascontiguousarray([*drivers, *(r.value for r in corrected)])
    bends = _bends(drive, [_slope_of(n, along) for n in list_drivers(effect)], step)
    n, count = drive.shape[1], len(effect.states)
    # without corrections, only the parameters of the rates change the states
    moved = joined_rows(*corrected, more=places[places >= 0].tolist())
    mine = np.arange(len(columns)) if moved is None else np.array(moved, dtype=int)
    width = len(mine) + 1 if len(mine) else 0
    unit = 1.0 * np.equal.outer(places, np.append(mine, -2)[:width])
    moving = np.zeros((len(corrected), n, len(mine) + 1))
    for i, r in enumerate(corrected):
        moving[i, :, :-1] = r.tangent[mine].T
    start = np.array(
        [signals[SIGNALS[s.start]].value[0] if s.start else 0.0 for s in effect.states.values()]
    )
    out, tangent = np.empty((count, n)), np.zeros((count, len(columns), n))
    if covered <= STABLE * MOST_STEPS:
        # scale: a difference of 1 in position, and of the rate of the fastest mode in velocity
        rate = max(fastest, 1e-300)
        states = effect.states.values()
        size = np.array([rate if s.quantity == "velocity" else 1.0 for s in states])
        growth = GROWTH if effect.corrections() and not effect.linear else np.inf
        by_mine = tangent if len(mine) == len(columns) else np.empty((count, len(mine), n))
        scan = compile_source(write_scan(effect), "scan")
        known = (step, steps, parameters, unit, drive, bends, moving)
        scan(*known, size, growth, start, out, by_mine)
        if by_mine is not tangent:
            tangent[:, mine] = by_mine
    if covered > STABLE * MOST_STEPS or not np.isfinite(out).all():
        # too fast for the sample rate: NaN instead of a wrong number
        out[:], tangent[:], moved = np.nan, np.nan, None
    return {
        symbol: Traced(out[i], tangent[i], moved)
        for i, symbol in enumerate(effect.state_symbols().values())
    }
