"""The result of a claim over intervals of values: its status, worst case, and method."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from ...base.by_value import ByValue
from ...base.notebook import html_table
from ...base.quantity import unit_after_number
from ...base.rounding import round_down
from ..claims.certificate import Certificate
from ..claims.claim import Claim, NotTrueOrFalse
from .box import ValueBox
from .worst import Worst

Status = Literal["proved", "refuted", "evidence", "unknown"]


@dataclass(frozen=True, eq=False)
class IntervalClaim(NotTrueOrFalse, ByValue):
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

    def __repr__(self) -> str:
        measures = {n: unit_after_number(self.units.get(n, "1")) for n in self.worst}
        where = ", ".join(f"{n} = {v:.6g}{measures[n]}" for n, v in self.worst.items())
        lines = [f"{self.known}: {self.statement}", f"    {self.how}"]
        unit = unit_after_number(self.unit)
        if not np.isnan(self.margin):
            lines.append(f"    worst margin {self.margin:.4g}{unit} at {where or 'its values'}")
        if not np.isnan(self.proved_margin):
            least = round_down(self.proved_margin, digits=4)
            lines.append(f"    proved to be at least {least:g}{unit}")
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        rows = [
            (n, f"{low:g}", f"{high:g}", f"{self.worst[n]:.6g}", self.units.get(n, ""))
            for n, (low, high) in self.intervals.items()
        ]
        head = ("value", "from", "to", "at the worst point", "unit")
        note = f"{self.statement}; margin {self.margin:.4g} {self.unit}. {self.how}"
        return html_table(self.known, head, rows, note=note)


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
