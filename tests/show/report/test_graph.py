"""Graphs of findings, drawn on axes and as elements of a page."""

from base64 import b64decode
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.figure import Figure
from show.report.html_page import HtmlPage

from teleopdesign.base.finding import Graph, Series
from teleopdesign.show.figures.graph import draw_graph, extremes, thin_series
from teleopdesign.show.report.before_and_after import choose_prefix
from teleopdesign.show.report.figures import picture

X = np.linspace(0.0, 1.0, 50)


def axes_with(*series, **options):
    axes = Figure().subplots()
    draw_graph(Graph("velocity (mm/s)", "force (N)", series, **options), axes)
    return axes


def test_labels_and_names_are_drawn_as_they_are():
    axes = axes_with(Series("$a", X, X), Series("_b", X, X, "trend"))
    assert axes.get_xlabel() == "velocity (mm/s)" and axes.get_ylabel() == "force (N)"
    shown = [t.get_text().strip("\u200b") for t in axes.get_legend().get_texts()]
    assert shown == ["$a", "_b"]


def test_one_series_needs_no_legend():
    assert axes_with(Series("force", X, X)).get_legend() is None


@pytest.mark.parametrize(
    ("kind", "marker", "line"),
    [
        ("measured", ".", "None"),
        ("rest", ".", "None"),
        ("model", "None", "-"),
        ("trend", "None", "-"),
        ("limit", "None", "--"),
    ],
)
def test_measured_is_drawn_as_points_and_a_model_as_a_line(kind, marker, line):
    (drawn,) = axes_with(Series("s", X, X, kind)).lines
    assert (drawn.get_marker(), drawn.get_linestyle()) == (marker, line)


def test_of_two_models_the_first_is_before_and_the_second_after():
    first, second = axes_with(Series("a", X, X, "model"), Series("b", X, X, "model")).lines
    assert (first.get_color(), second.get_color()) == ("#D55E00", "#0072B2")


def test_a_band_is_drawn_behind_its_series():
    axes = axes_with(Series("a", X, X, "model", X - 1, X + 1))
    assert len(axes.collections) == 1


def test_a_limit_of_one_point_is_a_level_across_the_graph():
    (line,) = axes_with(Series("noise", X[:1], X[:1], "limit")).lines
    assert list(line.get_xdata()) == [0, 1]


@pytest.mark.parametrize(("x", "scale"), [(np.geomspace(0.1, 100, 50), "log"), (X, "linear")])
def test_a_logarithmic_graph_has_both_axes_so_where_x_spans_decades(x, scale):
    axes = axes_with(Series("a", x, 1 + X), logarithmic=True)
    assert (axes.get_yscale(), axes.get_xscale()) == ("log", scale)


def test_a_graph_without_series_or_with_gaps_is_drawn():
    axes_with()
    axes_with(Series("a", X, np.where(X > 0.5, np.nan, X), "model"), logarithmic=True)


@given(st.integers(1, 2000), st.integers(2, 300))
def test_a_thinned_series_keeps_its_extremes_and_its_order(n, most):
    y = np.sin(np.arange(n) ** 1.3)
    series = thin_series(Series("a", np.arange(float(n)), y, low=y - 1, high=y + 1), most)
    assert len(series.x) <= max(most, 2)
    assert series.y.min() == y.min() and series.y.max() == y.max()
    assert np.all(np.diff(series.x) > 0)
    assert np.array_equal(series.low, series.y - 1)


def test_gaps_do_not_hide_an_extreme():
    y = np.array([np.nan, 3.0, np.nan, -2.0])
    assert {1, 3} <= set(extremes(y, 1).tolist())


def drawn(draw):
    return picture(draw, size=(3, 2), alt='a "figure" & more')


def svg_of(element):
    """The SVG that an <img> element holds."""
    kind, data = element.attributes["src"].split(",", 1)
    assert kind == "data:image/svg+xml;base64"
    return ElementTree.fromstring(b64decode(data))


def test_a_picture_has_its_alternative_text_and_its_texts_as_text():
    def draw(figure):
        figure.subplots().set_title("F < $m$ & x", parse_math=False)

    (element,) = HtmlPage(drawn(draw)).all("img")
    assert element.attributes["alt"] == 'a "figure" & more'
    texts = [e.text for e in svg_of(element).iter("{http://www.w3.org/2000/svg}text")]
    assert "F < $m$ & x" in texts


def test_many_points_are_pixels():
    x = np.arange(4000.0)
    graph = Graph("time (s)", "force (N)", (Series("measured", x, np.sin(x)),))
    assert len(drawn(lambda figure: draw_graph(graph, figure.subplots()))) < 60_000


def test_the_same_figure_gives_the_same_bytes():
    def draw(figure):
        figure.subplots().plot(X, X)

    assert drawn(draw) == drawn(draw)


@pytest.mark.parametrize(
    ("unit", "size", "shown"),
    [
        ("m", 0.012, "mm"),
        ("m", 2.0, "m"),
        ("m", 3e-5, "µm"),
        ("N", 0.08, "mN"),
        ("N*m", 0.7, "N·m"),
        ("rad/s", 1e-9, "mrad/s"),
        ("kg*m^2", 1.0, "kg·m²"),
    ],
)
def test_a_quantity_is_shown_in_the_prefix_that_reads_well(unit, size, shown):
    assert choose_prefix(unit, size).unit == shown


def test_a_cloud_that_is_thinned_keeps_its_middle():
    y = np.random.default_rng(4).standard_normal(20_000)
    series = thin_series(Series("a", np.arange(20_000.0), y, "rest"), 400)
    assert len(series.y) == 400
    # a standard normal has 0.26 of its points within a third of its spread; of 400, +- 0.022
    assert np.mean(np.abs(series.y) < 1 / 3) == pytest.approx(0.26, abs=0.09)
