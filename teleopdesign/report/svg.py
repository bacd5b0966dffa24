"""A matplotlib figure as SVG for a page: its texts, identifiers and colours become the page's.

Text stays text, in the page's font. Colours are those of the page's theme, so that one drawing
serves light and dark. Identifiers are unlike those of every other figure of the page. The same
figure gives the same bytes.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from io import StringIO
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

from markupsafe import Markup

from ..plot.diagnosis import AFTER, BACKWARD, BEFORE, FORWARD, MEASURED, STYLE

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: colours as matplotlib writes them -> the page's
THEME = {
    "#000000": "var(--ink)",
    "#ffffff": "var(--paper)",
    "#d9d9d9": "var(--rule)",
    "#8c8c8c": "var(--measured)",
    BEFORE.lower(): "var(--before)",
    AFTER.lower(): "var(--after)",
    FORWARD.lower(): "var(--forward)",
    BACKWARD.lower(): "var(--backward)",
}
assert MEASURED == "0.55", "the theme names the grey of measured points as #8c8c8c"
#: what a figure of a page sets beside the house style
SETTINGS: Any = {
    "svg.fonttype": "none",
    "svg.hashsalt": "teleopdesign",
    "text.parse_math": False,  # a name from a file may hold a dollar sign
    "axes.formatter.use_mathtext": False,
    "axes.formatter.limits": (-4, 5),
    "font.family": "sans-serif",
    "font.sans-serif": "DejaVu Sans",  # comes with matplotlib, and is wider than a page's font
    "font.size": 7.5,
    "axes.labelsize": 7.5,
    "axes.titlesize": 7.5,
    "figure.facecolor": "none",
    "axes.facecolor": "none",
    "savefig.facecolor": "none",
}
#: the font as matplotlib names it in one property or in several
_FONT = re.compile(r"font: (?:[a-z0-9]+ )*?([0-9.]+px) [^;]*")
_FAMILY = re.compile(r"font-family: [^;]*;? ?")
_COLOUR = re.compile(r"#[0-9a-f]{6}")
_REFERENCE = re.compile(r"url\(#([^)]*)\)")
_NUMBER = re.compile(r"-?\d+\.\d{3,}")


def inline_svg(
    draw: Callable[[Figure], None], *, size: tuple[float, float], name: str, alt: str
) -> Markup:
    """What `draw` draws, as an <svg> element with an alternative text.

    draw: is given an empty figure in house style;  size: inches
    name: unlike that of every other figure of the page;  alt: plain text, escaped here
    """
    import matplotlib.style
    from matplotlib import rc_context
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    with matplotlib.style.context(STYLE), rc_context(SETTINGS):
        figure = Figure(figsize=size, layout="constrained")
        FigureCanvasSVG(figure)
        draw(figure)
        out = StringIO()
        figure.savefig(out, format="svg", metadata={"Date": None})
    return Markup(_inlined(out.getvalue(), name, alt))


def _inlined(text: str, name: str, alt: str) -> str:
    # written by matplotlib a moment ago: no file of a user is parsed here
    root = ElementTree.fromstring(text)
    for parent in list(root.iter()):
        for child in list(parent):
            if _local(child.tag) in ("metadata", "style"):
                parent.remove(child)
    for element in root.iter():
        element.tag = _local(element.tag)
        element.attrib = {_local(k): v for k, v in element.attrib.items()}
        if element.tag != "text":
            element.text = element.text if (element.text or "").strip() else None
        element.tail = element.tail if (element.tail or "").strip() else None
    named = _named(root)
    for element in root.iter():
        own = element.attrib
        element.attrib = {k: _own(v, k, name) for k, v in own.items() if k != "id" or v in named}
    _points_as_one_path(root)
    root.attrib = {"viewBox": root.attrib["viewBox"], "role": "img", "aria-label": alt}
    return ElementTree.tostring(root, encoding="unicode")


def _local(name: str) -> str:
    return name.rpartition("}")[2]


def _named(root: ElementTree.Element) -> set[str]:
    """Identifiers that something in the figure refers to."""
    found = set()
    for element in root.iter():
        found.add(element.attrib.get("href", "").removeprefix("#"))
        found.update(*(_REFERENCE.findall(v) for v in element.attrib.values()))
    return found


def _own(value: str, attribute: str, name: str) -> str:
    """An attribute with the page's colours and font, and identifiers of this figure alone."""
    if attribute == "id":
        return f"{name}-{value}"
    if attribute == "href" and value.startswith("#"):
        return f"#{name}-{value[1:]}"
    if attribute == "style":
        value = _FAMILY.sub("", _FONT.sub(r"font-size: \1", value))
        return _COLOUR.sub(lambda m: THEME.get(m[0], m[0]), value)
    if attribute in ("d", "x", "y", "width", "height", "transform"):
        # a hundredth of a point is finer than any screen; a matrix keeps its digits
        short = value if value.startswith("matrix") else _NUMBER.sub(_short, value)
        return " ".join(short.split())
    return _REFERENCE.sub(rf"url(#{name}-\1)", value)


def _short(number: re.Match[str]) -> str:
    return f"{float(number[0]):.2f}"


#: from so many equal markers on, they are drawn as one path of dots
_MANY = 20
_FILL = re.compile(r"fill: ([^;]+)")
_EDGE = re.compile(r"stroke-width: ([0-9.]+)")


def _points_as_one_path(root: ElementTree.Element) -> None:
    """Round markers of one series as a single path of dots, a fifth of the size."""
    for parent in list(root.iter("g")):
        definition = parent.find("defs/path")
        if definition is None:
            continue
        for group in parent.findall("g"):
            uses = list(group)
            radius = _radius(definition)
            fill = _FILL.search(uses[0].attrib.get("style", "")) if uses else None
            if len(uses) < _MANY or radius is None or fill is None or fill[1] == "none":
                continue
            edge = _EDGE.search(definition.attrib.get("style", ""))
            width = 2 * radius + (float(edge[1]) if edge else 1.0)
            dots = " ".join(f"M{u.attrib['x']} {u.attrib['y']}h0" for u in uses)
            style = f"fill: none; stroke: {fill[1]}; stroke-width: {width:.2f}; "
            for use in uses:
                group.remove(use)
            ElementTree.SubElement(group, "path", d=dots, style=style + "stroke-linecap: round")


def _radius(path: ElementTree.Element) -> float | None:
    """Radius of a marker that is a circle; None for any other."""
    outline = path.attrib.get("d", "")
    first = re.match(r"M 0 (?P<r>[0-9.]+) C ", outline)
    return float(first["r"]) if first and outline.count("C") == 8 else None
