"""A finding: one sentence, the numbers on which it is based, and a graph that shows it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from .frozen import ByValue
from .shown import html_table

Array = NDArray[np.float64]
#: "fine" says that all is well, "note" is worth knowing, "warning" needs care
Concern = Literal["fine", "note", "warning"]


@dataclass(frozen=True, eq=False, repr=False)
class Series(ByValue):
    """One set of points or one line of a graph.

    x, y: (n,);  low, high: a band around y, (n,), or None
    kind: "measured" and "rest" are drawn as points, "model" and "trend" as lines, "limit" dashed,
        "course" (a measured signal over time) as a thick line
    """

    name: str
    x: Array
    y: Array
    kind: Literal["measured", "rest", "model", "trend", "limit", "course"] = "measured"
    low: Array | None = None
    high: Array | None = None

    def __repr__(self) -> str:
        return f"Series({self.name!r}, {len(self.x)} points, {self.kind})"


@dataclass(frozen=True, eq=False)
class Graph(ByValue):
    """Series over common axes; a label names quantity and unit, such as "velocity (mm/s)"."""

    x_label: str
    y_label: str
    series: tuple[Series, ...]
    logarithmic: bool = False


@dataclass(frozen=True, eq=False)
class Finding(ByValue):
    """One fact about a recording, or about what a model leaves unexplained.

    topic: the subject of the finding ("sample clock", "dependence on velocity")
    concern: how much it matters;  sentence: the fact in plain words, with the numbers
    numbers: name -> value (SI)
    where: the record or body that the finding is about; "" for all
    graph: a graph that shows the fact, or None
    stops: whether these records tell no effect, whatever is fitted, so that a diagnosis names none;
        the sentence then ends with what mends that
    """

    topic: str
    concern: Concern
    sentence: str
    numbers: Mapping[str, float] = field(default_factory=dict)
    where: str = ""
    graph: Graph | None = None
    stops: bool = False

    def __str__(self) -> str:
        place = f"{self.where}: " if self.where else ""
        return f"{self.concern:<8}{place}{self.sentence}"

    def _repr_html_(self) -> str:
        rows = [(name, f"{number:.6g}") for name, number in self.numbers.items()]
        place = f", {self.where}" if self.where else ""
        title = f"{self.concern}: {self.topic}{place}"
        return html_table(title, ("number (SI)", "") if rows else (), rows, note=self.sentence)


class Findings(tuple[Finding, ...]):
    """Findings in the order in which they were made; printed and in a notebook, a line for each."""

    __slots__ = ()

    def __str__(self) -> str:
        return "\n".join(map(str, self))

    __repr__ = __str__

    def _repr_html_(self) -> str:
        rows = [(f.concern, f.topic, f.where, f.sentence) for f in self]
        return html_table("Findings", ("concern", "topic", "where", "finding"), rows)
