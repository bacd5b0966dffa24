"""The result of a claim over intervals of values: its status, worst case, and method."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from ...base.frozen import ByValue
from ...base.shown import Shown
from ..claims.certificate import Certificate
from ..claims.claim import Claim, NotTrueOrFalse
from .box import ValueBox
from .worst import Worst

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


#: fields of an `IntervalClaim` before units and all intervals are added
Parts = dict[str, Any]


def parts_of(
    statement: str, status: Status, worst: Worst, box: ValueBox, unit: str, how: str, **more: Any
) -> Parts:
    """Fields of an `IntervalClaim` from its status, its worst point and its words.

    more: fields that differ from the defaults
    """
    return {
        "statement": statement,
        "status": status,
        "worst": box.named(worst.point),
        "margin": worst.margin,
        "unit": unit,
        "proved_margin": float("nan"),
        "points": worst.points,
        "how": how,
        **more,
    }
