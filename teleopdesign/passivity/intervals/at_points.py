"""Evaluation of a margin or a claim at points of a box; numerical, no proof over the box."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ...diagrams import Diagram
from ..claims.claim import Claim
from .box import ValueBox
from .interval_claim import Parts, Status, parts_of
from .worst import search_worst


def judge_at_points(
    middle: Diagram, box: ValueBox, claim: Callable[[Diagram], Any], points: int, seed: int
) -> Parts:
    """Judge a user's margin or claim at the vertices, the middle and further points of a box.

    claim: function of a diagram, which returns a margin (>= 0: it holds) or a `Claim`
    points: number of further points;  seed: of these points
    """
    unknown: list[str] = []
    units: list[str] = []

    def margin(point: np.ndarray) -> float:
        value = claim(middle.with_values(box.named(point)))
        if not isinstance(value, Claim):
            return float(value)
        if value.holds is None:
            unknown.append(str(value.verdict))
        units.append(getattr(value.verdict, "unit", ""))
        size = float(getattr(value.verdict, "margin", float("nan")))
        if np.isfinite(size) and (size >= 0) == bool(value.holds):
            return size
        return {True: np.inf, False: -np.inf, None: np.inf}[value.holds]

    worst = search_worst(margin, box, points=points, seed=seed, downhill=False)
    name = getattr(claim, "__name__", "the claim")
    failed = not worst.margin >= 0
    how = f"{name} is {worst.margin:.4g} there" if failed else f"{name}: nothing is proved"
    status: Status = "refuted" if failed else "unknown" if unknown else "evidence"
    how = f"unknown at {len(unknown)} points: {unknown[0]}" if status == "unknown" else how
    return parts_of(f"{name} holds", status, worst, box, next(filter(None, units), ""), how)
