"""A matplotlib figure as an <img> element that contains the SVG: the page loads no other file.

Inside an image, identifiers and styles of the SVG cannot conflict with those of the page, and no
text in it can become an element of the page. The same figure gives the same bytes. On a dark page
the style sheet inverts the picture's lightness.
"""

from __future__ import annotations

import warnings
from base64 import b64encode
from collections.abc import Callable
from io import BytesIO
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from ..figures.style import STYLE, further_fonts

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: settings of matplotlib for pictures of a page, besides the house style
SETTINGS: Any = {
    "svg.fonttype": "none",  # text stays text: small, and sharp at every size
    "svg.hashsalt": "teleopdesign",  # the same identifiers in every process
    "text.parse_math": False,  # a name from a file may hold a dollar sign
    "axes.formatter.use_mathtext": False,
    "axes.formatter.limits": (-4, 5),
    "font.size": 7.5,
    "axes.labelsize": 7.5,
    "axes.titlesize": 7.5,
    "figure.facecolor": "none",
    "axes.facecolor": "none",
    "savefig.facecolor": "none",
}
#: pixels per inch of parts that are drawn as pixels: three for each pixel of a usual screen
PIXELS_PER_INCH = 288


def picture(draw: Callable[[Figure], None], *, size: tuple[float, float], alt: str) -> Markup:
    """The drawing by `draw` as an <img> element with an alternative text.

    draw: function that receives an empty figure in house style
    size: width and height, inches;  alt: plain text, escaped here
    """
    import matplotlib.style
    from matplotlib import rc_context
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    fonts = {"font.family": ["DejaVu Sans", *further_fonts()]}  # the first comes with matplotlib
    with matplotlib.style.context(STYLE), rc_context(SETTINGS | fonts), warnings.catch_warnings():
        # the text stays text: the reader's browser has the letters that no font here has
        warnings.filterwarnings("ignore", "Glyph .* missing from font")
        figure = Figure(figsize=size, layout="constrained")
        FigureCanvasSVG(figure)
        draw(figure)
        out = BytesIO()
        figure.savefig(out, format="svg", metadata={"Date": None}, dpi=PIXELS_PER_INCH)
    data = b64encode(out.getvalue()).decode("ascii")
    return Markup('<img alt="{}" src="data:image/svg+xml;base64,{}">').format(alt, data)
