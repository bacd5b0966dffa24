"""A drawing of shapes as SVG: plain elements, no style sheet, so that any program reads it."""

from __future__ import annotations

from collections.abc import Sequence
from xml.sax.saxutils import escape, quoteattr

from .shapes import SIZES, SMALLER, Box, Circle, Dot, SheetPoint, SheetShape, Text, Wire, readable

ARROW = (6.0, 2.2)  # length, half width
FONT = "'STIX Two Text', STIXGeneral, 'Times New Roman', serif"
#: how far below its middle the line on which letters stand lies, in sizes
BASELINE = 0.32
RAISED = {0: 0.0, -1: 0.22, 1: -0.38}


def svg(shapes: Sequence[SheetShape], *, width: float, height: float, title: str) -> str:
    """The text of an SVG file, on a sheet of that size (points); title: alternative text."""
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}pt" height="{height:g}pt" '
        f'viewBox="0 0 {width:g} {height:g}" role="img" fill="none" stroke="black" '
        f'stroke-width="0.8" font-family={quoteattr(FONT)}>',
        f"<title>{escape(readable(title))}</title>",
        *(_element(shape) for shape in shapes),
        "</svg>",
    ]
    return "\n".join(lines) + "\n"


def _element(shape: SheetShape) -> str:
    if isinstance(shape, Box):
        left, top = shape.x - shape.width / 2, shape.y - shape.height / 2
        size = f'width="{shape.width:g}" height="{shape.height:g}"'
        return f'<rect x="{left:g}" y="{top:g}" {size} fill="white"/>'
    if isinstance(shape, Circle):
        return f'<circle cx="{shape.x:g}" cy="{shape.y:g}" r="{shape.radius:g}" fill="white"/>'
    if isinstance(shape, Dot):
        return f'<circle cx="{shape.x:g}" cy="{shape.y:g}" r="1.8" fill="black" stroke="none"/>'
    return _wire(shape) if isinstance(shape, Wire) else _text(shape)


def _wire(wire: Wire) -> str:
    points = " ".join(f"{x:g},{y:g}" for x, y in shaft(wire))
    line = f'<polyline points="{points}"/>'
    if not wire.arrow:
        return line
    head = " ".join(f"{x:g},{y:g}" for x, y in arrow_head(wire))
    return f'{line}<polygon points="{head}" fill="black" stroke="none"/>'


def shaft(wire: Wire) -> tuple[SheetPoint, ...]:
    """The points of a wire's line; under an arrow it ends before the tip, which stays sharp."""
    if not wire.arrow:
        return wire.points
    tip, left, right = arrow_head(wire)
    foot = (left[0] + right[0]) / 2, (left[1] + right[1]) / 2
    return *wire.points[:-1], ((tip[0] + foot[0]) / 2, (tip[1] + foot[1]) / 2)


def arrow_head(wire: Wire) -> tuple[tuple[float, float], ...]:
    """The corners of the arrow head at the wire's last point, tip first."""
    (x0, y0), (x, y) = wire.points[-2:]
    length = abs(x - x0) + abs(y - y0)  # along one axis
    dx, dy = (x - x0) / length, (y - y0) / length
    back, half = ARROW
    foot = x - back * dx, y - back * dy
    return (
        (x, y),
        (foot[0] - half * dy, foot[1] + half * dx),
        (foot[0] + half * dy, foot[1] - half * dx),
    )


def _text(text: Text) -> str:
    size = SIZES[text.role]
    out, level = "", 0.0
    for run in text.runs:
        raised = RAISED[run.level]
        style = ' font-style="italic"' if run.italic else ""
        small = f' font-size="{size * SMALLER:.4g}"' if run.level else ""
        moved = f' dy="{(raised - level) * size:.4g}"' if raised != level else ""
        out += f"<tspan{style}{small}{moved}>{escape(run.text)}</tspan>"
        level = raised
    place = f'x="{text.x:g}" y="{text.y + BASELINE * size:.5g}"'
    fill = 'fill="black" stroke="none"'
    return f'<text {place} font-size="{size:g}" text-anchor="{text.anchor}" {fill}>{out}</text>'
