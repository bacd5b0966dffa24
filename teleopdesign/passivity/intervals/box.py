"""A box, an interval for each of some values of a diagram: a claim over it, and its worst point."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import product
from typing import Any, Literal

import numpy as np

from ...base.errors import ModelError, did_you_mean
from ...base.expectations import describe_value
from ...base.frozen import ByValue
from ...base.shown import Shown
from ...controllers import exact_decimal
from ...diagrams import Diagram
from ..claims.certificate import Certificate
from ..claims.claim import Claim, NotTrueOrFalse
from ..ports import drop_absent_effects, nonlinear_parts

#: the statement of the claim "stable"
STABLE = "every pole has a negative real part"
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
#: number of points from which a descent starts, and evaluations of a descent for each value
_STARTS, _STEPS = 3, 40


@dataclass(frozen=True)
class Worst:
    """The least margin of all points that were evaluated.

    point: where the margin is least, (n,);  points: number of points
    suspects: other points at which the margin is not above 0; (n,) each
    """

    point: np.ndarray
    margin: float
    points: int
    suspects: tuple[np.ndarray, ...] = ()


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
    first, *others = sorted(values, key=lambda key: values[key])
    suspects = tuple(np.array(k) for k in others if values[k] <= 0)
    return Worst(np.array(first), values[first], len(values), suspects)


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


def judge_at_points(
    middle: Diagram, box: ValueBox, claim: Callable[[Diagram], Any], points: int, seed: int
) -> IntervalClaim:
    """Judge a user's margin or claim at the vertices, the middle and further points of a box.

    claim: function of a diagram, which returns a margin (>= 0: it holds), whether it holds, or a
        `Claim`
    points: number of further points;  seed: of these points
    """
    unknown: list[str] = []
    units: list[str] = []

    def margin(point: np.ndarray) -> float:
        value = claim(middle.with_values(box.named(point)))
        if isinstance(value, bool | np.bool_):
            return np.inf if value else -np.inf
        if not isinstance(value, Claim):
            if np.isnan(size := float(value)):
                unknown.append(f"{name} is no number")
            return np.inf if np.isnan(size) else size
        if value.holds is None:
            unknown.append(str(value.verdict))
        units.append(getattr(value.verdict, "unit", ""))
        size = float(getattr(value.verdict, "margin", float("nan")))
        if np.isfinite(size) and (size >= 0) == bool(value.holds):
            return size
        return {True: np.inf, False: -np.inf, None: np.inf}[value.holds]

    name = getattr(claim, "__name__", "the claim")
    worst = search_worst(margin, box, points=points, seed=seed, downhill=False)
    failed = worst.margin < 0
    how = f"{name} is {worst.margin:.4g} there" if failed else f"{name}: nothing is proved"
    status: Status = "refuted" if failed else "unknown" if unknown else "evidence"
    how = f"unknown at {len(unknown)} points: {unknown[0]}" if status == "unknown" else how
    return interval_claim(f"{name} holds", status, worst, box, next(filter(None, units), ""), how)
