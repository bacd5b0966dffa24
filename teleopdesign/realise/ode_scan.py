"""Several coupled hidden states along a measured motion, such as a tip body, with tangents.

Runge-Kutta steps; the signals that drive them are interpolated between rows, and sub-steps keep
the fastest mode well within the method's stability. Generated from the effect's rates.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp

from ..effects import SIGNALS, Effect
from .compiled import compiled
from .scan import code_of, columns_of, indented

if TYPE_CHECKING:
    from .along_motion import Traced

#: part of a radian of the fastest mode that one sub-step may cover, and the most sub-steps
MODE_STEP, MOST_STEPS = 1.0, 16


def _drivers(effect: Effect) -> list[str]:
    rates = effect.rates().values()
    return [n for n, s in SIGNALS.items() if any(r.has(s) for r in rates)]


@lru_cache(maxsize=32)
def _source(effect: Effect) -> str:
    states = list(effect.state_symbols().values())
    rates = list(effect.rates().values())
    parameters = list(effect.symbols().values())
    drivers = _drivers(effect)
    unpack = [f"{s} = z[{i}]" for i, s in enumerate(states)]
    unpack += [f"{s} = p[{i}]" for i, s in enumerate(parameters)]
    unpack += [f"{d} = u[{i}]" for i, d in enumerate(drivers)]
    slopes = [f"f[{i}] = {code_of(r)}" for i, r in enumerate(rates)]
    for i, rate in enumerate(rates):
        by_state = [f"({code_of(sp.diff(rate, s))}) * d[{j}, c]" for j, s in enumerate(states)]
        by_parameter = [
            f"({code_of(sp.diff(rate, s))}) * (columns[{j}] == c)" for j, s in enumerate(parameters)
        ]
        slopes_of_tangent = " + ".join(by_state + by_parameter)
        unpack_tangent = f"g[{i}, c] = {slopes_of_tangent}"
        slopes.append(f"for c in range(d.shape[1]):\n        {unpack_tangent}")
    return f'''"""Generated from an effect's rates; do not edit."""
from math import *

import numpy as np
from numba import njit


@njit(cache=True, nogil=True, error_model="numpy")
def rate(z, d, u, p, columns, f, g):
{indented(unpack, 4)}
{indented(slopes, 4)}


@njit(cache=True, nogil=True, error_model="numpy")
def scan(h, steps, p, columns, drive, z, out, dout):
    m, n = drive.shape
    s, q = len(z), dout.shape[1]
    d = np.zeros((s, q))
    f = np.zeros((4, s))
    g = np.zeros((4, s, q))
    u = np.zeros(m)
    w = h / steps
    zs = np.zeros(s)
    ds = np.zeros((s, q))
    for k in range(n):
        for i in range(s):
            out[i, k] = z[i]
            for c in range(q):
                dout[i, c, k] = d[i, c]
        if k == n - 1:
            break
        for step in range(steps):
            for stage in range(4):
                part = 0.0 if stage == 0 else 1.0 if stage == 3 else 0.5
                here = (step + part) / steps
                for i in range(m):
                    u[i] = drive[i, k] + here * (drive[i, k + 1] - drive[i, k])
                before = max(stage - 1, 0)
                for i in range(s):
                    zs[i] = z[i] + part * w * f[before, i]
                    for c in range(q):
                        ds[i, c] = d[i, c] + part * w * g[before, i, c]
                rate(zs, ds, u, p, columns, f[stage], g[stage])
            for i in range(s):
                z[i] += w / 6 * (f[0, i] + 2 * f[1, i] + 2 * f[2, i] + f[3, i])
                for c in range(q):
                    d[i, c] += w / 6 * (
                        g[0, i, c] + 2 * g[1, i, c] + 2 * g[2, i, c] + g[3, i, c]
                    )
'''


@lru_cache(maxsize=32)
def _fastest(effect: Effect) -> Any:
    """Function of the parameters: the largest rate (rad/s) of the states among themselves.

    Laws with gaps or stops are judged where they are stiffest, by the largest of their pieces.
    """
    states = list(effect.state_symbols().values())
    rates = [r.replace(sp.Piecewise, lambda *pieces: pieces[0][0]) for r in effect.rates().values()]
    matrix = sp.Matrix(rates).jacobian(states)
    return sp.lambdify(list(effect.symbols().values()), matrix, "numpy")


def ode_scan(
    effect: Effect,
    given: Mapping[Any, Traced],
    values: Mapping[Any, float],
    columns: list[Any],
    step: float,
) -> dict[sp.Symbol, Traced]:
    """The effect's hidden states at the rows, with tangents, driven by the measured signals.

    given: signals at the rows, which carry no tangents themselves;  step: s between rows
    """
    from .along_motion import Traced

    own = effect.symbols()
    parameters = np.array([values[s] for s in own.values()], dtype=float)
    places = columns_of(effect, columns)
    modes = np.linalg.eigvals(np.nan_to_num(np.array(_fastest(effect)(*parameters), dtype=float)))
    needed = step * float(np.abs(modes).max()) / MODE_STEP
    steps = int(np.clip(np.ceil(needed), 1, MOST_STEPS))
    drive = np.ascontiguousarray([given[SIGNALS[n]].value for n in _drivers(effect)])
    start = np.array(
        [given[SIGNALS[s.start]].value[0] if s.start else 0.0 for s in effect.states.values()]
    )
    n, count = drive.shape[1], len(effect.states)
    out, tangent = np.empty((count, n)), np.empty((count, len(columns), n))
    compiled(_source(effect), "scan")(step, steps, parameters, places, drive, start, out, tangent)
    if needed > 2.0 * MOST_STEPS or not np.isfinite(out).all():
        # too fast for the record's rate: no number at all rather than a wrong one
        out[:], tangent[:] = np.nan, np.nan
    return {
        symbol: Traced(out[i], tangent[i])
        for i, symbol in enumerate(effect.state_symbols().values())
    }
