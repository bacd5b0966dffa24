"""Search for the least margin of a claim in a box; numerical, no proof."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import sympy as sp

from ...derive.polynomials import roots
from ..linear.family import Family
from ..linear.signs import coefficient, degree
from ..linear.sweep import least_over, margin_of
from .box import IntervalClaim, Status, ValueBox

#: margin at a point of the box, (n,); -inf where the claim fails and no number measures this
MarginFunction = Callable[[np.ndarray], float]
#: frequencies of the grid at each point of the box, then refined beside the lowest margin
_FREQUENCIES = 501
#: number of points from which a descent starts, and evaluations of a descent for each value
_STARTS, _STEPS = 3, 40


@dataclass(frozen=True)
class Worst:
    """The least margin of all points that were evaluated.

    point: where the margin is least, (n,);  points: number of points
    """

    point: np.ndarray
    margin: float
    points: int


def search_worst(
    margin: MarginFunction, box: ValueBox, *, points: int, seed: int, downhill: bool = True
) -> Worst:
    """Least margin at the vertices, the middle and Sobol points, then by descent from the lowest.

    points: number of Sobol points;  seed: of these; the same seed gives the same result
    downhill: whether descents follow
    """
    from scipy.optimize import minimize

    values: dict[tuple[float, ...], float] = {}

    def at(point: np.ndarray) -> float:
        key = tuple(map(float, point))
        if key not in values:
            values[key] = margin(np.asarray(point, dtype=float))
        return values[key]

    for point in (*box.vertices(), box.centre, *box.inside(points, seed)):
        at(point)
    low, high = np.array(box.low), np.array(box.high)
    lowest = sorted(values, key=lambda key: values[key])[:_STARTS]
    if downhill and box.names and np.isfinite(values[lowest[0]]):
        for start in lowest:
            unit = (np.array(start) - low) / (high - low)
            minimize(  # type: ignore[call-overload]
                lambda u: at(low + np.clip(u, 0, 1) * (high - low)),
                unit,
                method="Nelder-Mead",
                bounds=[(0.0, 1.0)] * len(low),
                options={"maxfev": _STEPS * len(low), "xatol": 1e-6, "fatol": 1e-12},
            )
    key = min(values, key=lambda key: values[key])
    return Worst(np.array(key), values[key], len(values))


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


def interval_claim(
    statement: str, status: Status, worst: Worst, box: ValueBox, unit: str, how: str, **more: Any
) -> IntervalClaim:
    """The claim from its status, its worst point and its words; more: further fields."""
    ends = {n: (a, b) for n, a, b in zip(box.names, box.low, box.high, strict=True)}
    at, nothing = box.named(worst.point), float("nan")
    made = IntervalClaim(
        statement, status, ends, at, worst.margin, unit, nothing, worst.points, how
    )
    return replace(made, **more)
