"""A drawing: shapes on a sheet, painted by matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ....base.files import write_text
from ..style import as_svg, house_style, plt
from .shapes import (
    BASELINE,
    FONT,
    RAISED,
    SIZES,
    SMALLER,
    Box,
    Circle,
    Dot,
    SheetShape,
    Text,
    Wire,
    arrow_head,
    readable,
    run_width,
    shaft,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


POINTS_PER_INCH = 72.0
LINE = 0.8


def figure(shapes: Sequence[SheetShape], *, width: float, height: float) -> Figure:
    """A matplotlib figure with the shapes on a sheet of that size (points)."""
    with plt.style.context(house_style()):
        size = width / POINTS_PER_INCH, height / POINTS_PER_INCH
        page = plt.figure(figsize=size, layout="none")
        axes = page.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set_axis_off()
        axes.set_xlim(0.0, width)
        axes.set_ylim(height, 0.0)
        for shape in shapes:
            if isinstance(shape, Text):
                _write(shape, axes)
            else:
                _paint(shape, axes)
    return page


def _paint(shape: Box | Circle | Dot | Wire, axes: Axes) -> None:
    from matplotlib import patches

    open_shape: Any = {"facecolor": "white", "edgecolor": "black", "linewidth": LINE, "zorder": 3}
    if isinstance(shape, Box):
        corner = shape.x - shape.width / 2, shape.y - shape.height / 2
        axes.add_patch(patches.Rectangle(corner, shape.width, shape.height, **open_shape))
    elif isinstance(shape, Circle):
        axes.add_patch(patches.Circle((shape.x, shape.y), shape.radius, **open_shape))
    elif isinstance(shape, Dot):
        dot = patches.Circle((shape.x, shape.y), 1.8, facecolor="black", edgecolor="none", zorder=4)
        axes.add_patch(dot)
    else:
        x, y = zip(*shaft(shape), strict=True)
        ends: Any = {"solid_joinstyle": "miter", "solid_capstyle": "butt"}
        axes.plot(x, y, color="black", linewidth=LINE, zorder=2, **ends)
        if shape.arrow:
            head = patches.Polygon(arrow_head(shape), facecolor="black", edgecolor="none", zorder=4)
            axes.add_patch(head)


def _write(text: Text, axes: Axes) -> None:
    size = SIZES[text.role]
    widths = [run_width(run, size) for run in text.runs]
    start = {"start": 0.0, "middle": -0.5, "end": -1.0}[text.anchor]
    x = text.x + start * sum(widths)
    for run, width in zip(text.runs, widths, strict=True):
        axes.text(
            x,
            text.y + (BASELINE + RAISED[run.level]) * size,
            run.text,
            fontsize=size * (SMALLER if run.level else 1.0),
            fontfamily=FONT,
            fontstyle="italic" if run.italic else "normal",
            verticalalignment="baseline",
            parse_math=False,  # a user's name may hold a dollar sign
            zorder=5,
        )
        x += width


@dataclass(frozen=True, repr=False)
class Drawing:
    """Shapes on a sheet of size width x height (points);  title: alternative text."""

    shapes: tuple[SheetShape, ...]
    width: float
    height: float
    title: str

    def __repr__(self) -> str:
        size = f"{self.width:.0f} x {self.height:.0f} points"
        return f"Drawing of {self.title}: {len(self.shapes)} shapes, {size}"

    def _repr_svg_(self) -> str:
        return self.svg()

    def svg(self) -> str:
        """The drawing as SVG text; the same drawing gives the same text."""
        return as_svg(self.plot(), title=readable(self.title))

    def plot(self) -> Figure:
        """The drawing as a matplotlib figure of the same size, for `save_figure`."""
        return figure(self.shapes, width=self.width, height=self.height)

    def to_svg(self, path: str | Path) -> None:
        """Write the drawing to an SVG file."""
        write_text(path, self.svg())
