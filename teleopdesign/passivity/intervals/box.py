"""A box, an interval for each of some values of a diagram, and the result of a claim over it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import product
from typing import Literal

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

    @property
    def exact(self) -> tuple[tuple[Fraction, Fraction], ...]:
        """The intervals as rational numbers."""
        ends = zip(self.low, self.high, strict=True)
        return tuple(
            (Fraction(str(exact_decimal(a))), Fraction(str(exact_decimal(b)))) for a, b in ends
        )

    @property
    def centre(self) -> np.ndarray:
        """The middle of every interval, (n,)."""
        return np.asarray((np.array(self.low) + np.array(self.high)) / 2)

    def vertices(self) -> np.ndarray:
        """Vertices of the box, (m, n): all of them, or the first MOST_VERTICES."""
        ends = zip(self.low, self.high, strict=True)
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
        kept = [k for k, n in enumerate(self.names) if n in names]
        pick = [tuple(x[k] for k in kept) for x in (self.names, self.low, self.high)]
        return ValueBox(*pick)  # type: ignore[arg-type]


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
    wide = {n: (float(a), float(b)) for n, (a, b) in intervals.items() if a < b}
    fixed = {n: float(a) for n, (a, b) in intervals.items() if a == b}
    box = ValueBox(
        tuple(wide), tuple(a for a, _ in wide.values()), tuple(b for _, b in wide.values())
    )
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
