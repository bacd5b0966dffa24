"""Margins of a claim as functions of a point of a box; numerical, compiled once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import sympy as sp

from ...derive.polynomials import roots
from ..linear.family import Family
from ..linear.signs import coefficient, degree
from ..linear.sweep import least_over, margin_of
from .box import MarginFunction

#: frequencies of the grid at each point of the box, then refined beside the lowest margin
_FREQUENCIES = 501


def pole_margin(p: Any) -> MarginFunction:
    """Margin of stability: distance of the rightmost root from the axis, 1/s; > 0: on the left.

    p: a polynomial in s and the values
    """
    falling = _coefficients(p)

    def margin(point: np.ndarray) -> float:
        at = roots(falling(point))
        return float(-at.real.max()) if len(at) else np.inf

    return margin


def port_margin(family: Family, claim: str) -> MarginFunction:
    """Least margin of a claim over frequency; -inf where a mode grows with dampers at the ports.

    "passive": N s/m;  "absolutely stable": Llewellyn's, dimensionless
    """
    test = margin_of(claim)
    held = None if family.times else _coefficients(family.held)

    def margin(point: np.ndarray) -> float:
        w = np.array([1e-2, 1e3])
        if held is not None:
            modes = roots(held(point))
            # 1e-7: a double root on the axis comes out of rounding by the square root of 1e-16
            if (modes.real > 1e-7 * np.abs(modes)).any():
                return -np.inf
            w = np.append(w, np.abs(modes[modes != 0]))
        w = np.concatenate([w, *(np.abs(r[r != 0]) for r in (roots(e(point)) for e in poles))])
        # a resonance may be narrower than the distance of two frequencies: each has its own
        grid = np.union1d(np.geomspace(w.min() / 1000, w.max() * 1000, _FREQUENCIES), w)
        _, least, _ = least_over(
            lambda x: test(family.at(1j * x, point)), grid, rounds=1, points=41
        )
        return least

    poles = [] if family.times else [_coefficients(family.d)]
    return margin


def _coefficients(p: Any) -> Callable[[np.ndarray], np.ndarray]:
    """A function: the coefficients of s at a point of the box, highest power first."""
    rising = [coefficient(p, k) for k in range(degree(p), -1, -1)]
    count = len(p.ring.symbols) - 1
    forms = [c.as_expr() for c in rising]
    call = sp.lambdify(p.ring.symbols[1:], [sp.sympify(e).evalf(17) for e in forms], "math")
    return lambda point: np.array(call(*(*point, *(0.0,) * (count - len(point)))), dtype=float)
