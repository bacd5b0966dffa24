"""Where a model fails: sentences on each body, each with its numbers and its graph.

The figure of a residual: its views, and a curve for each dependence on a variable.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ...base.finding import Finding
from ...base.sentences import number, percent
from ...diagnose.criteria import CRITERIA
from ...unexplained.dependence import ALARM
from ...unexplained.shapes import SHAPES
from ..figures.diagnosis import direction_legend
from ..figures.graph import draw_graph
from ..figures.style import AFTER, BACKWARD, FORWARD, MEASURED, plt
from ..registry import shows

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ...base.finding import Graph
    from ...unexplained import BodyResidual, DescribedDependence, ResidualDescription
    from ...unexplained.views import Whiteness


#: part of the residual that may remain undescribed without a remark: a description to first order,
#: with f as lines between knots, leaves a few percent anyway
UNDESCRIBED = 0.1
#: if at least this part of the residual lies where no motion is certain, the description says so
MOSTLY = 0.5


@shows("text")
def description_text(description: ResidualDescription) -> str:
    """A line for each finding."""
    return "\n".join(map(str, description.findings))


@shows("findings")
def findings_of(description: ResidualDescription) -> tuple[Finding, ...]:
    """The sentences on all bodies."""
    many = len(description.parts) > 1
    return tuple(f for p in description.parts for f in _findings_on(p, p.body if many else ""))


def _findings_on(part: BodyResidual, where: str) -> Iterator[Finding]:
    """The sentences about one body, each with its numbers and its graph."""
    numbers = {"error": part.error, "noise floor": part.floor, "noise floors": part.floors}
    time = part.views.get("time", part.views["velocity"])
    sentence = f"the model leaves {percent(part.error, '.2g')} of the force, "
    if part.is_adequate:
        sentence += "no more than sensor noise would leave."
        yield Finding("what is left", "fine", sentence, numbers, where, time)
        return
    sentence += f"{number(part.floors)} times what sensor noise would leave."
    yield Finding("what is left", "warning", sentence, numbers, where, time)
    for one in part.dependences:
        yield _finding(one, where)
    if part.floors > CRITERIA.adequate:
        yield from _rest(part, where)


def _finding(one: DescribedDependence, where: str) -> Finding:
    d = one.dependence
    numbers = {
        "explained": d.explained,
        "score": d.score,
        "probability of chance": d.probability,
        "largest": float(one.curve.y.max()),
        "smallest": float(one.curve.y.min()),
    }
    alike = ""
    if d.alike:
        listed = ", ".join(d.alike[:3]) + (", ..." if len(d.alike) > 3 else "")
        alike = f" (no better: {listed})"
    share = percent(d.explained, ".0f")
    sentence = f"{one.sentence}. That is {share} of what is left{alike}."
    topic = f"dependence: {d.shape.name}"
    return Finding(topic, "warning", sentence[0].upper() + sentence[1:], numbers, where, one.graph)


def _rest(part: BodyResidual, where: str) -> Iterator[Finding]:
    """Findings on the remaining residual: its frequencies, correlation in time, and size."""
    if part.whiteness is not None:
        yield _frequencies(part, part.whiteness, where)
    if part.at_rest > MOSTLY:
        sentence = (
            f"{percent(part.at_rest, '.0f')} of the residual lies where no motion can be seen."
        )
        numbers = {"share": part.at_rest}
        yield Finding("rest", "note", sentence, numbers, where, part.views["velocity"])
    floors = part.after / part.floor if part.floor else float("inf")
    if floors > CRITERIA.adequate and part.after**2 > UNDESCRIBED * part.error**2:
        what, stays = "Beside that,", "stays"
        if not part.dependences:
            what, stays = f"None of {len(SHAPES)} dependences is sure:", "stay"
        sentence = f"{what} {number(floors)} times the sensors' noise {stays} undescribed."
        numbers = {"noise floors": floors}
        yield Finding("undescribed", "note", sentence, numbers, where, part.views.get("time"))


def _frequencies(part: BodyResidual, white: Whiteness, where: str) -> Finding:
    """Where in frequency the residual lies, and whether it is correlated in time."""
    low, high = white.band
    numbers = {"low": low, "high": high, "probability of chance": white.probability}
    sentence = f"Half of what is left lies between {number(low)} and {number(high)} Hz"
    if low < 1.0:  # the first band
        sentence = f"Three quarters of what is left lies below {number(max(high, 1.0))} Hz"
    if white.probability < ALARM:
        largest = int(np.argmax(np.abs(white.correlation) / white.noise))
        lag, r = white.lag[largest], white.correlation[largest]
        numbers |= {"lag": float(lag), "correlation": float(r)}
        sentence += f"; its autocorrelation at {number(1e3 * lag)} ms is {r:.2f}"
        sentence += ", unlike sensor noise"
    return Finding("frequency", "note", f"{sentence}.", numbers, where, part.views["frequency"])


#: panels side by side; height of a row of them (in)
COLUMNS, HEIGHT = 3, 1.75
#: letters on a line above the panels: as many as fit into 7.16 in at 7 points
LETTERS = 150
#: colour of each named series
COLOURS = {
    "forward": FORWARD,
    "backward": BACKWARD,
    "mean forward": "#00513b",
    "mean backward": "#7b3f63",
    "measured force": MEASURED,
    "residual": AFTER,
    "check, means": "0.25",
    "smooth": AFTER,
}


@shows("figure")
def plot_unexplained(failure: ResidualDescription) -> Figure:
    """The sentences of all findings, and below them the graphs of each body, dependences first."""
    panels = [p for part in failure.parts for p in _panels(part, name=len(failure.parts) > 1)]
    lines = [part for one in failure.findings for part in textwrap.wrap(_line(one), LETTERS)]
    rows = math.ceil(len(panels) / COLUMNS)
    title = 0.14 * (len(lines) + 1)
    figure, axes = plt.subplots(rows, COLUMNS, figsize=(7.16, HEIGHT * rows + title), squeeze=False)
    for ax, (name, graph) in zip(axes.flat, panels, strict=False):
        draw_graph(graph, ax, colours=COLOURS, legend=False)
        if not graph.logarithmic:
            ax.axhline(0, color="k", lw=0.5)
        ax.set_title(name, loc="left", fontsize=7)
        if not any(s.kind == "rest" for s in graph.series):
            ax.legend(markerscale=2, fontsize=6, loc="best")
        elif graph.x_label.startswith("time ("):  # points are everywhere: beside the title
            direction_legend(ax)
    for ax in axes.flat[len(panels) :]:
        ax.set_axis_off()
    figure.suptitle("\n".join(lines), x=0.01, ha="left", fontsize=7, parse_math=False)
    return figure


def _line(finding: Finding) -> str:
    where, sentence = finding.where, finding.sentence
    return f"{where}: {sentence}" if where else sentence[:1].upper() + sentence[1:]


def _panels(part: BodyResidual, *, name: bool) -> list[tuple[str, Graph]]:
    before = f"{part.body}, " if name else ""
    curves = [(before + d.dependence.shape.name, d.graph) for d in part.dependences]
    return curves + [(f"{before}residual over {n}", g) for n, g in part.views.items()]
