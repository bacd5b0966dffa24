"""Search for the least margin of a claim in a box; numerical, no proof."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import sympy as sp

from ...realise.lti import S
from ..two_port.two_port import passive_margin, stable_margin
from .box import ValueBox
from .family import Family

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


def pole_margin(polynomial: sp.Poly, symbols: Sequence[sp.Symbol]) -> MarginFunction:
    """Margin of stability: distance of the rightmost root from the axis, 1/s; > 0: on the left."""
    coefficients = _coefficients(polynomial, symbols)

    def margin(point: np.ndarray) -> float:
        roots = np.roots(coefficients(point))
        return float(-roots.real.max()) if len(roots) else np.inf

    return margin


def port_margin(
    family: Family, z: sp.Matrix, *, stable: bool, poles: Sequence[sp.Poly], box: ValueBox
) -> MarginFunction:
    """Least margin over frequency at one port or two; -inf where a pole grows.

    z: impedance matrix in S and the symbols, 1x1 or 2x2
    stable: whether the margin is Llewellyn's (dimensionless) or that of passivity (N s/m)
    poles: polynomials in S and the symbols; a zero with a positive real part is a growing pole
    """
    symbols = [family.symbols[n] for n in box.names]
    call = sp.lambdify([S, *symbols], [e for e in z], "numpy")
    growing = [_coefficients(p, symbols) for p in poles]
    size = z.shape[0]

    def over(w: np.ndarray, point: np.ndarray) -> np.ndarray:
        with np.errstate(all="ignore"):
            entries = call(1j * w, *point)
            flat = [np.broadcast_to(np.asarray(e, dtype=complex), w.shape) for e in entries]
            matrices = np.stack(flat, axis=-1).reshape(-1, size, size)
            finite = np.isfinite(matrices).all(axis=(1, 2))
            values = np.full(len(w), np.inf)
            test = stable_margin if stable and size == 2 else passive_margin
            values[finite] = test(matrices[finite])
        return values

    def margin(point: np.ndarray) -> float:
        w = np.array([1e-2, 1e3])
        for coefficients in growing:
            roots = np.roots(coefficients(point))
            # 1e-7: a double root on the axis comes out of rounding by the square root of 1e-16
            if (roots.real > 1e-7 * np.abs(roots)).any():
                return -np.inf
            w = np.append(w, np.abs(roots[roots != 0]))
        # a resonance may be narrower than the distance of two frequencies: each has its own
        grid = np.union1d(np.geomspace(w.min() / 1000, w.max() * 1000, _FREQUENCIES), w)
        values = over(grid, point)
        k = int(np.argmin(values))
        beside = np.geomspace(grid[max(k - 1, 0)], grid[min(k + 1, len(grid) - 1)], 41)
        return float(min(values[k], over(beside, point).min()))

    return margin


def _coefficients(
    polynomial: sp.Poly, symbols: Sequence[sp.Symbol]
) -> Callable[[np.ndarray], np.ndarray]:
    """A function: the coefficients of S at a point of the box, highest power first."""
    listed = sp.Poly(polynomial.as_expr(), S).all_coeffs()
    call = sp.lambdify(list(symbols), [c.evalf(17) for c in listed], "math")
    return lambda point: np.array(call(*point), dtype=float)
