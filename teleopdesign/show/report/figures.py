"""The figures of a report, drawn from the data of its page, each with an alternative text.

A figure is an <img> element that contains the SVG: the page loads no other file. Inside an image,
identifiers and styles of the SVG cannot conflict with those of the page, and no text in it can
become an element of the page. The same figure gives the same bytes. On a dark page the style sheet
inverts the picture's lightness.
"""

from __future__ import annotations

import warnings
from base64 import b64encode
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from markupsafe import Markup

from ...base.finding import Graph
from ...base.sentences import number_on_page as number
from ...base.sentences import percent_on_page as percent
from ...base.sentences import unit_on_page as unit_text
from ..figures.diagnosis import draw_ladder
from ..figures.graph import draw_graph
from ..figures.style import AFTER, BEFORE, STYLE, as_svg, further_fonts
from ..frequency.impedance import legend_below
from ..frequency.response import draw_bode
from .motion import YOURS, ImpedanceView
from .residuals import BodyView, RungResidual

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap
    from matplotlib.figure import Figure

    from .candidate_table import PageRow

#: inches: widths of a panel; a panel fits a telephone, and two or three fit side by side on a
#: screen
PANEL, WIDE = 3.4, 4.0
GREY, RULE = "0.55", "#D9D9D9"


def make_diverging_colormap() -> Colormap:
    """Blue for too little force, grey for none, orange for too much; suits colour blindness.

    The middle is grey, not white, so that cells without data stand out on light and dark pages.
    """
    from matplotlib.colors import LinearSegmentedColormap

    stops = ["#004B87", "#0072B2", "#74AACC", "#D8D8D6", "#EBA477", "#D55E00", "#8F3B00"]
    return LinearSegmentedColormap.from_list("residual", stops)


def ladder_figure(rows: tuple[PageRow, ...], floor: float) -> Markup:
    """Check error of every rung as a bar, fit error as a ring, noise floor as a line."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        draw_ladder(axes, [(r["name"], r["check_error"], r["fit_error"]) for r in rows], floor)
        axes.set_xlabel("force error (% of the measured force)")

    errors = ", ".join(f"{r['name']}: {percent(r['check_error'])}" for r in rows)
    alt = f"Bars of the force error. {errors}. Noise floor: {percent(floor)}."
    height = 0.55 + 0.52 * len(rows)
    return picture(draw, size=(WIDE, height), alt=alt)


def step_figure(view: BodyView, index: int) -> Markup:
    """One rung on one body: mean residual over position and velocity, above its trace over time."""
    step = view.steps[index]

    def draw(figure: Figure) -> None:
        upper, lower = figure.subplots(2, 1, height_ratios=[2.1, 1.0])
        _map(view, step, upper)
        _trace(view, step, lower, BEFORE if index == 0 else AFTER)

    unit, factor = view.force_scale.unit, view.force_scale.factor
    rms = f"{number(factor * step.rms, 3)} {unit}"
    alt = (
        f"{view.body}, {step.name}: mean residual force over position and velocity as colour, and "
        f"the residual over time. Its rms is {rms}."
    )
    # two maps beside each other have more room than three
    size = (PANEL, 3.3) if len(view.steps) in (3, 5, 6, 7) else (WIDE, 3.7)
    return picture(draw, size=size, alt=alt)


def _map(view: BodyView, step: RungResidual, axes: Axes) -> None:
    from matplotlib.ticker import MaxNLocator

    px, vx = view.position_scale, view.velocity_scale
    axes.imshow(
        step.mean,
        origin="lower",
        aspect="auto",
        interpolation="none",
        cmap=make_diverging_colormap(),
        vmin=-view.limit,
        vmax=view.limit,
        extent=(
            px.factor * view.position[0],
            px.factor * view.position[-1],
            vx.factor * view.velocity[0],
            vx.factor * view.velocity[-1],
        ),
    )
    axes.axhline(0, color=GREY, lw=0.5)
    axes.xaxis.set_major_locator(MaxNLocator(7))
    axes.set_xlabel(f"position ({px.unit})")
    axes.set_ylabel(f"velocity ({vx.unit})")


def _trace(view: BodyView, step: RungResidual, axes: Axes, colour: str) -> None:
    factor = view.force_scale.factor
    axes.fill_between(
        view.time, factor * step.low, factor * step.high, color=colour, lw=0.4, alpha=1.0
    )
    largest = factor * max(float(np.max(np.abs([s.low, s.high]))) for s in view.steps)
    axes.set_ylim(-1.05 * largest, 1.05 * largest)
    axes.set_xlim(view.time[0], view.time[-1])
    for joint in view.joints:
        axes.axvline(joint, color=GREY, lw=0.6, ls=":")
    axes.axhline(0, color=GREY, lw=0.5)
    axes.set_xlabel("time along the records (s)" if view.joints else "time (s)")
    axes.set_ylabel(f"residual ({view.force_scale.unit})")


def colour_scale(view: BodyView) -> Markup:
    """The colour scale that all maps of a body share."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        end = view.force_scale.factor * view.limit
        ramp = np.linspace(-1, 1, 128)[None, :]
        axes.imshow(
            ramp,
            aspect="auto",
            cmap=make_diverging_colormap(),
            extent=(-end, end, 0, 1),
            interpolation="none",
        )
        axes.set_yticks([])
        axes.spines[:].set_visible(False)
        axes.set_xticks([-end, -0.5 * end, 0, 0.5 * end, end])
        noise = number(view.force_scale.factor * view.noise, 2)
        beside = f"; rms of sensor noise {noise}" if view.noise > 0 else ""
        axes.set_xlabel(f"mean residual force ({view.force_scale.unit}{beside})")

    end = number(view.force_scale.factor * view.limit, 3)
    alt = f"Colour scale from blue, -{end} {view.force_scale.unit}, over grey to orange, +{end}."
    return picture(draw, size=(PANEL, 0.5), alt=alt)


def graph_figure(graph: Graph, alt: str, *, width: float = PANEL) -> Markup:
    """The picture of a finding's graph; alt: alternative text, width: inches."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots()
        draw_graph(graph, axes, colours={YOURS: BEFORE})

    return picture(draw, size=(width, 0.62 * width), alt=alt)


def impedance_figure(view: ImpedanceView) -> Markup:
    """Force over motion: recorded with coherence, of the model along the motion, and derived."""

    def draw(figure: Figure) -> None:
        axes = figure.subplots(3, 1, sharex=True, height_ratios=[1.0, 1.0, 0.55])
        draw_bode(axes, [view.derived, view.along, view.recorded])
        axes[0].set_ylabel(f"size (dB re 1 {unit_text(view.derived.unit)})")
        axes[1].set_ylabel("phase (deg)")
        legend_below(figure, axes[0])

    what = "size, phase and coherence of force over motion"
    alt = f"{view.body}: {what} over frequency, recorded and of the model."
    return picture(draw, size=(WIDE, 4.4), alt=alt)


#: settings of matplotlib for pictures of a page, besides the house style
SETTINGS: Any = {
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
        data = b64encode(as_svg(figure, dpi=PIXELS_PER_INCH).encode()).decode("ascii")
    return Markup('<img alt="{}" src="data:image/svg+xml;base64,{}">').format(alt, data)
