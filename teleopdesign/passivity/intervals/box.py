"""A box, an interval for each of some values of a diagram: a claim over it, and its worst point."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import product
from typing import Any, Literal

import numpy as np
import sympy as sp

from ...base.errors import ModelError, did_you_mean
from ...base.expectations import describe_value
from ...base.frozen import ByValue
from ...base.shown import Shown
from ...controllers import exact_decimal
from ...derive.polynomials import roots
from ...diagrams import Diagram
from ..claims.certificate import Certificate
from ..claims.claim import Claim, NotTrueOrFalse
from ..linear.family import Family
from ..linear.signs import coefficient, degree
from ..linear.sweep import least_over, margin_of
from ..ports import drop_absent_effects, nonlinear_parts

#: most vertices that are evaluated: all vertices of eight intervals, 2^8
MOST_VERTICES = 256


@dataclass(frozen=True)
class ValueBox:
    """A box: intervals of values of a diagram.

    names: of the values, (n);  low, high: ends of the intervals, low < high, (n) each. A float
        stands for its shortest decimal (0.1 is 1/10)
    """

    names: tuple[str, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]

    @staticmethod
    def of(intervals: Mapping[str, tuple[float, float]]) -> ValueBox:
        """The box of these intervals: value -> (low, high)."""
        low, high = (tuple(float(ends[k]) for ends in intervals.values()) for k in (0, 1))
        return ValueBox(tuple(intervals), low, high)

    @property
    def intervals(self) -> dict[str, tuple[float, float]]:
        """Value -> (low, high)."""
        return dict(zip(self.names, zip(self.low, self.high, strict=True), strict=True))

    @property
    def exact(self) -> tuple[tuple[Fraction, Fraction], ...]:
        """The intervals as rational numbers."""
        ends = self.intervals.values()
        return tuple(
            (Fraction(str(exact_decimal(a))), Fraction(str(exact_decimal(b)))) for a, b in ends
        )

    @property
    def centre(self) -> np.ndarray:
        """The middle of every interval, (n,)."""
        return np.asarray((np.array(self.low) + np.array(self.high)) / 2)

    def vertices(self) -> np.ndarray:
        """Vertices of the box, (m, n): all of them, or the first MOST_VERTICES."""
        ends = self.intervals.values()
        listed = [v for v, _ in zip(product(*ends), range(MOST_VERTICES), strict=False)]
        return np.array(listed, dtype=float).reshape(len(listed), len(self.names))

    def inside(self, number: int, seed: int) -> np.ndarray:
        """Points inside the box, from a scrambled Sobol sequence, (number, n)."""
        from scipy.stats import qmc

        if not number or not self.names:
            return np.empty((0, len(self.names)))
        bits = math.ceil(math.log2(max(number, 2)))
        unit = qmc.Sobol(len(self.names), rng=np.random.default_rng(seed)).random_base2(bits)
        width = np.array(self.high) - np.array(self.low)
        return np.asarray(np.array(self.low) + unit[:number] * width)

    def named(self, point: np.ndarray) -> dict[str, float]:
        """Values at a point, (n,), by their names."""
        return dict(zip(self.names, map(float, point), strict=True))

    def select(self, names: tuple[str, ...]) -> ValueBox:
        """The box of these values alone."""
        return ValueBox.of({n: ends for n, ends in self.intervals.items() if n in names})


Status = Literal["proved", "refuted", "evidence", "unknown"]


@dataclass(frozen=True, eq=False)
class IntervalClaim(Shown, NotTrueOrFalse, ByValue):
    """A claim over intervals of values, with its status and worst case.

    status: "proved" over the whole box; "refuted" at `worst`; "evidence": the claim holds at all
        points that were evaluated; "unknown"
    intervals: value -> (low, high);  worst: the values at the least margin
    margin: the least margin that was evaluated, at `worst`, in `unit`
    proved_margin: lower bound of the margin that is proved over the whole box; NaN: none
    points: number of points that were evaluated;  how: the method in words
    units: of the values;  at_worst: the claim at `worst` alone
    time: of the controllers: "any" where no controller is sampled
    certificates: for a linear diagram, each verified by `checker`: one for the bound of the margin
        over the whole box, one for the modes that no port shows
    """

    statement: str
    status: Status
    intervals: Mapping[str, tuple[float, float]]
    worst: Mapping[str, float]
    margin: float
    unit: str
    proved_margin: float
    points: int
    how: str
    units: Mapping[str, str] = field(default_factory=dict)
    at_worst: Claim | None = None
    time: Literal["continuous", "any"] = "any"
    certificates: tuple[Certificate, ...] = ()

    @property
    def holds(self) -> bool | None:
        """Whether the claim holds, as far as is known; None where the status is "unknown"."""
        return {"proved": True, "evidence": True, "refuted": False}.get(self.status)

    @property
    def limited(self) -> str:
        """Words that limit a proof to continuous time; "" where no controller is sampled."""
        return " (in continuous time)" if self.time == "continuous" else ""

    @property
    def known(self) -> str:
        """Status and method in words, as every report of the claim states them."""
        return {
            "proved": f"proved over the whole box{self.limited}",
            "refuted": "refuted at a point of the box",
            "evidence": f"checked numerically at {self.points} points, worst found there",
            "unknown": "unknown",
        }[self.status]


def box_of(
    diagram: Diagram, intervals: Mapping[str, tuple[float, float]]
) -> tuple[Diagram, ValueBox]:
    """The diagram with its values in the middle of their intervals, and the box of these intervals.

    An interval without width sets the value and is no part of the box.

    intervals: names of `diagram.values` -> (low, high)
    raises ModelError: an unknown value, no pair of finite numbers, low above high, or values at a
        vertex that a block refuses
    """
    known = diagram.values
    for name, ends in intervals.items():
        if name not in known:
            raise ModelError(f'{diagram.name}: no parameter "{name}"{did_you_mean(name, known)}')
        if not isinstance(ends, tuple | list) or len(ends) != 2:
            raise ModelError(f"{name}: found {describe_value(ends)}, expected (low, high)")
        if not all(math.isfinite(x) for x in ends) or ends[0] > ends[1]:
            low, high = map(float, ends)
            raise ModelError(f"{name}: found {low:g} to {high:g}, expected finite low <= high")
    box = ValueBox.of({n: ends for n, ends in intervals.items() if ends[0] < ends[1]})
    fixed = {n: float(a) for n, (a, b) in intervals.items() if a == b}
    for vertex in box.vertices():  # values that a block refuses are refused here
        diagram.with_values({**fixed, **box.named(vertex)})
    return diagram.with_values({**fixed, **box.named(box.centre)}), box


def nonlinear_within(diagram: Diagram, box: ValueBox) -> tuple[str, ...]:
    """Names of the parts of a diagram that are not linear somewhere in the box.

    The middle and two opposite vertices are tested, because an effect may be absent in the middle
    and present at an end of its interval.
    """
    points = (box.centre, np.array(box.low), np.array(box.high))
    parts = (
        nonlinear_parts(drop_absent_effects(diagram.with_values(box.named(x)))) for x in points
    )
    return tuple(dict.fromkeys(name for names in parts for name in names))


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
    ends = box.intervals
    at, nothing = box.named(worst.point), float("nan")
    made = IntervalClaim(
        statement, status, ends, at, worst.margin, unit, nothing, worst.points, how
    )
    return replace(made, **more)
