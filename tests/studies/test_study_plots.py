"""Figures of studies show the numbers that they are given; Sobol indices are those of formulas."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.base.errors import ModelError

COLUMNS = {"x": (-np.pi, np.pi), "y": (-np.pi, np.pi), "z": (-np.pi, np.pi)}


def ishigami(x, y, z):
    """Ishigami, Homma, Proc. ISUMA (1990) 398, with a = 7, b = 0.1: its indices are known."""
    return np.sin(x) + 7 * np.sin(y) ** 2 + 0.1 * z**4 * np.sin(x)


def plane(x, y, z=0.0):
    return x - y + z


def value(result):
    return result


@pytest.fixture(autouse=True)
def closed():
    yield
    plt.close("all")


@pytest.fixture(scope="module")
def drawn():
    samples = td.sensitivity_samples(COLUMNS, 1024, seed=1)
    return td.study(ishigami, samples, measures=value, workers=1)


@pytest.fixture(scope="module")
def gridded():
    axes = {"z": [0.0, 1.0], "y": [0.0, 1.0, 2.0, 3.0], "x": np.geomspace(0.5, 8.0, 5)}
    return td.study(plane, axes, measures=value, units={"x": "s", "value": "N"}, workers=1)


def test_sobol_indices_are_those_of_the_formula(drawn):
    """S = (0.3139, 0.4424, 0), S_T = (0.5576, 0.4424, 0.2437): Saltelli et al. (2010), table 1."""
    indices = drawn.sensitivity()
    # ten standard errors of the estimate from 1024 pairs would be 0.1 to 0.4
    np.testing.assert_allclose(indices["first"].values, [0.3139, 0.4424, 0.0], atol=0.04)
    np.testing.assert_allclose(indices["total"].values, [0.5576, 0.4424, 0.2437], atol=0.04)
    assert (indices["first_interval"] < 0.15).all()


def test_indices_are_refused_where_points_failed_or_nothing_varies():
    samples = td.sensitivity_samples({"x": (0, 1), "y": (0, 1)}, 8)
    some = td.study(lambda x, y: {"a": x / (x > 0.5)}, samples, measures={"a": dict})
    with pytest.raises(ModelError, match="are no numbers"):
        some.sensitivity("a")
    same = td.study(lambda x, y: 1.0, samples, measures=value)
    with pytest.raises(ModelError, match="nothing depends"):
        same.sensitivity()


def test_a_map_shows_the_measure_with_proved_region_and_onset(gridded):
    figure = gridded.plot.map(at={"z": 0.0}, x="x", y="y", proved=lambda x: 0.5 * x, onset=0.0)
    mesh = figure.axes[0].collections[0]
    expected = gridded["value"].sel(z=0.0).transpose("y", "x").values
    np.testing.assert_allclose(np.asarray(mesh.get_array()).reshape(expected.shape), expected)
    legend = [t.get_text() for t in figure.legends[0].get_texts()]
    assert legend == ["proved", "onset, simulated"]


def study(function, axes):
    return td.study(function, axes, measures=value, workers=1)


def product(x, y, z=0.0, w=0.0):
    return x * y + z + w


def test_a_map_of_unsorted_values_is_the_map_of_the_sorted_ones():
    """The values 2, 0.1, 1 had cells that covered each other: of nine cells, four were visible."""
    rows = ([2.0, 0.1, 1.0], [0.1, 1.0, 2.0])
    maps = [study(product, {"x": x, "y": x}).plot.map(onset=1.5).axes[0].collections for x in rows]
    for unsorted, in_order in zip(*maps, strict=True):
        if hasattr(unsorted, "get_coordinates"):
            np.testing.assert_array_equal(unsorted.get_coordinates(), in_order.get_coordinates())
        np.testing.assert_array_equal(unsorted.get_array(), in_order.get_array())
    line = study(lambda x: x, {"x": rows[0]}).plot().axes[0].get_lines()[0]
    assert line.get_xdata().tolist() == rows[1]


@pytest.mark.parametrize("many", [1, 4])
def test_any_number_of_panels_is_drawn_each_with_its_ticks(many):
    """Four, five, seven and eight panels ended in an error of matplotlib about its colour bar."""
    axes = {"z": np.arange(float(many)), "y": [1.0, 2.0], "x": [1.0, 2.0]}
    figure = study(product, axes).plot.panels(by="z")
    panels = [a for a in figure.axes if a.get_title(loc="left")]
    assert len(panels) == many
    figure.canvas.draw()
    for k, panel in enumerate(panels):
        lowest = k + min(many, 3) >= many
        assert bool(panel.get_xlabel()) == lowest
        assert any(t.get_visible() for t in panel.get_xticklabels()) == lowest


def test_infinite_values_have_the_colour_of_the_end_and_are_no_failures():
    """A growth beyond all bounds was white, as a failed point, and -inf lay above an onset."""

    def growth(x, y):
        return {6.0: np.inf, 1.0: -np.inf}.get(x * y, x * y)

    figure = study(growth, {"x": [1.0, 2.0, 3.0], "y": [1.0, 2.0]}).plot.map(onset=2.5)
    shown = figure.axes[0].collections[0].get_array()
    assert not np.ma.getmaskarray(shown).any()
    assert shown.max() == 4.0 and shown.min() == 2.0
    assert figure.axes[1]._colorbar.extend == "both"
    corner = figure.axes[0].collections[1].get_paths()[0].vertices.sum(axis=1)
    assert corner.min() > 2.9, "no line beside -inf"


def fails(x):
    raise ModelError("too stiff")


@pytest.mark.parametrize(
    ("function", "axes", "text"),
    [
        (product, {"x": 1.0, "y": 2.0}, "no parameter has several values"),
        (product, {"x": [1.0], "y": 2.0}, "no parameter has several values"),
        (fails, {"x": [1.0, 2.0]}, "every point failed"),
        (lambda x: "a", {"x": [1.0, 2.0]}, "study: value: found texts, expected numbers"),
        (product, [{"x": [1.0], "y": [1.0]}, td.sobol({"z": (0, 1)}, 2)], "over x, y, sample"),
    ],
)
def test_a_study_without_anything_to_draw_is_refused_in_one_line(function, axes, text):
    with pytest.raises(ModelError, match=text):
        study(function, axes).plot()
