"""A drawing: shapes on a sheet, written as SVG or painted by matplotlib."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ....base.files import write_text
from .figure import figure
from .shapes import SheetShape
from .svg import svg

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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
        return svg(self.shapes, width=self.width, height=self.height, title=self.title)

    def plot(self) -> Figure:
        """The drawing as a matplotlib figure of the same size, for `save_figure`."""
        return figure(self.shapes, width=self.width, height=self.height)

    def to_svg(self, path: str | Path) -> None:
        """Write the drawing to an SVG file."""
        write_text(path, self.svg())
