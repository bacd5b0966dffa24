"""The block diagram, each block in the colour of its cut's error; a table of the cuts below."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ...base.sentences import percent
from ...block_cuts.computer import velocity_of
from ...block_cuts.cuts_ladder import Key
from ...block_cuts.diagnosis import BlockDiagnosis
from ...diagrams import Control
from ..figures.block_diagram import draw_diagram
from ..figures.block_diagram.drawing import figure
from ..figures.block_diagram.shapes import Box, Wire, shaft
from ..figures.style import CASES, TWO_COLUMNS, plt, symbol
from ..registry import shows

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap
    from matplotlib.figure import Figure

    from ...measurement.filtering import Array

#: most effects of a group that are listed in the table
_LISTED = 3
#: noise floors at which the colour is full; the scale is logarithmic from one floor on
FULL = 100.0
UNTESTED = "0.86"
#: points: height of a line of the table, least width of the page, and size of its letters
LINE, WIDTH, LETTERS = 13.0, 430.0, 8.0


@shows("figure")
def plot_block_diagnosis(diagnosis: BlockDiagnosis) -> Figure:
    """Blocks by the error of the stated diagram, in noise floors; missing effects with a frame.

    Grey: no recorded signal tests the block. A thick wire is the signal of a cut.
    """
    import matplotlib as mpl

    drawing = draw_diagram(diagnosis.experiment.diagram)
    rows = _table(diagnosis)
    width = max(drawing.width, WIDTH)
    height = drawing.height + LINE * (len(rows) + 3)
    page = figure(drawing.shapes, width=width, height=height)
    axes, colours = page.axes[0], mpl.colormaps["YlOrRd"]
    errors = _floors_of_blocks(diagnosis)
    named = {at for _, at in diagnosis.missing}
    listed = {at for group in diagnosis.groups for _, at in group}
    signals = {f"signal {cut.signal}" for cut in diagnosis.cuts.tested}
    for shape in drawing.shapes:
        if isinstance(shape, Box) and shape.block:
            error = errors.get(shape.block)
            face = UNTESTED if error is None else colours(_share(error))
            frame: Any = {"linewidth": 2.2} if shape.block in named else {"linewidth": 0.8}
            frame |= {"linestyle": "--"} if shape.block in listed - named else {}
            _box(shape, axes, facecolor=face, **frame)
        elif isinstance(shape, Wire) and shape.signal in signals:
            x, y = zip(*shaft(shape), strict=True)
            axes.plot(x, y, color="black", linewidth=2.0, zorder=2)
    _write_table(axes, rows, drawing.height + LINE)
    _write_scale(axes, colours, drawing.height + LINE * (len(rows) + 1.6))
    return page


def _box(shape: Box, axes: Axes, **look: Any) -> None:
    from matplotlib.patches import Rectangle

    corner = shape.x - shape.width / 2, shape.y - shape.height / 2
    axes.add_patch(
        Rectangle(corner, shape.width, shape.height, edgecolor="black", zorder=3.5, **look)
    )


def _share(floors: float) -> float:
    """Place on the colour scale, 0 to 1; never so dark that a name is not read."""
    return 0.75 * min(max(math.log(max(floors, 1.0)) / math.log(FULL), 0.0), 1.0)


def _floors_of_blocks(diagnosis: BlockDiagnosis) -> dict[str, float]:
    """Block -> error of the stated diagram at its cuts, in noise floors: the largest."""
    first, errors = diagnosis.rows[0].check, dict[str, float]()
    for cut in diagnosis.cuts.tested:
        if floor := diagnosis.floors.get(cut.name):
            for block in cut.blocks:
                errors[block] = max(errors.get(block, 0.0), first[cut.name] / floor)
    return errors


def _table(diagnosis: BlockDiagnosis) -> list[tuple[str, ...]]:
    """A row a cut: name, blocks, errors before and after, noise floor, what was added."""
    head = ("cut", "tests", "error", "at the end", "noise floor", "missing")
    rows: list[tuple[str, ...]] = [head]
    groups = {key: group for group in diagnosis.groups for key in group}
    for cut in diagnosis.cuts.tested:
        if cut.name not in diagnosis.floors:
            continue
        added = [r.added for r in diagnosis.rows if r.added and r.added[1] in cut.blocks]
        words = [_any_of(groups.get(key, (key,))) for key in dict.fromkeys(added)]
        errors = (
            diagnosis.rows[0].check[cut.name],
            diagnosis.rows[-1].check[cut.name],
            diagnosis.floors[cut.name],
        )
        shares = (percent(e, ".2g") for e in errors)
        rows.append((cut.name, ", ".join(cut.blocks), *shares, ", ".join(words)))
    return rows


def _any_of(group: Sequence[Key]) -> str:
    """Effects of which one is missing; of many the first, and the number of the others."""
    words = [f"{name} at {at}" for name, at in group]
    few = len(words) <= _LISTED
    return " or ".join(words) if few else f"{words[0]} or one of {len(words) - 1} others"


def _write_table(axes: Axes, rows: list[tuple[str, ...]], top: float) -> None:
    at = (10.0, 45.0, 130.0, 175.0, 228.0, 290.0)
    for i, row in enumerate(rows):
        for x, text in zip(at, row, strict=True):
            weight = "bold" if i == 0 else "normal"
            axes.text(
                x, top + LINE * i, text, fontsize=LETTERS, fontweight=weight, parse_math=False
            )


def _write_scale(axes: Axes, colours: Colormap, y: float) -> None:
    from matplotlib.patches import Rectangle

    marks = [(f"{f:g}", colours(_share(f))) for f in (1.0, 3.0, 10.0, 30.0, FULL)]
    for i, (text, colour) in enumerate([*marks, ("untested", UNTESTED)]):
        x = 10.0 + 42.0 * i
        axes.add_patch(Rectangle((x, y - 7.0), 10.0, 8.0, facecolor=colour, edgecolor="black"))
        axes.text(x + 13.0, y, text, fontsize=LETTERS)
    axes.text(10.0 + 42.0 * 6.3, y, "error of the stated diagram in noise floors", fontsize=LETTERS)


#: most points of a cloud
POINTS = 3000
GREY, COLOUR = "0.6", CASES["MBC"][0]


@shows("panels")
def plot_residuals(diagnosis: BlockDiagnosis) -> Figure:
    """A row a cut of the computer: residual before (grey) and after, low-passed, on check rows."""
    data, ladder = diagnosis.data, diagnosis.computer
    cuts = () if data is None else data.part.cuts
    columns = max([len(_variables(diagnosis, 0, cut.name)) for cut in cuts], default=1)
    page, axes = plt.subplots(
        max(len(cuts), 1),
        columns,
        sharey="row",
        figsize=(TWO_COLUMNS, 1.9 * max(len(cuts), 1)),
        squeeze=False,
    )
    if data is None or ladder is None:
        return page
    record = next((i for i, r in enumerate(data.rows) if r.use == "check"), 0)
    rows = data.masks[record]["check"]
    for line, cut in zip(axes, cuts, strict=True):
        unit = "N" if diagnosis.experiment.axis(cut.signal) == "prismatic" else "N m"
        variables = _variables(diagnosis, record, cut.name)
        for one, (label, values) in zip(line, variables.items(), strict=False):
            for fit, colour in ((ladder.base, GREY), (ladder.last, COLOUR)):
                made = data.predictions(fit.placed)[record][cut.signal]
                left = data.recorded[record][cut.signal] - np.roll(made, fit.shift)
                every = max(1, int(np.sum(rows)) // POINTS)
                style = "-" if label == "t [s]" else "."
                one.plot(
                    values[rows][::every],
                    left[rows][::every],
                    style,
                    color=colour,
                    ms=1.5,
                    rasterized=True,
                )
            one.set_xlabel(label)
        line[0].set_ylabel(f"residual of {symbol(cut.signal)} [{unit}]")
    return page


def _variables(diagnosis: BlockDiagnosis, record: int, name: str) -> dict[str, Array]:
    """Label -> values at the rows: time, the inputs of the blocks of a cut, and their velocity."""
    assert diagnosis.data is not None
    rows, diagram = diagnosis.data.rows[record], diagnosis.experiment.diagram
    cut = next(c for c in diagnosis.data.part.cuts if c.name == name)
    count = len(next(iter(rows.signals.values())))
    variables: dict[str, Array] = {
        "t [s]": np.asarray(np.arange(count) * rows.period, dtype=np.float64)
    }
    for signal in cut.inputs:
        values = rows.signals[signal]
        motion = diagram.is_position(signal)
        if motion and any(signal in _motions(diagnosis, b) for b in cut.blocks):
            variables[f"velocity of {symbol(signal)}"] = velocity_of(values, rows.period)
        elif not motion:
            variables[symbol(signal)] = values
    return variables


def _motions(diagnosis: BlockDiagnosis, name: str) -> set[str]:
    """Positions on which a controller's motion depends."""
    diagram = diagnosis.experiment.diagram
    block = diagram.block(name) if diagram.has(name) else None
    if not isinstance(block, Control) or not block.motion:
        return set()
    return {x.name for x in diagram.position(block.motion).free_symbols}
