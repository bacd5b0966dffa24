"""Figures of studies whatever their axes are: unsorted, single, four, with infinite values."""

import matplotlib.pyplot as plt
import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.base.errors import ModelError


def value(result):
    return result


def study(function, axes):
    return td.study(function, axes, measures=value, workers=1)


def product(x, y, z=0.0, w=0.0):
    return x * y + z + w


@pytest.fixture(autouse=True)
def closed():
    yield
    plt.close("all")


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


@pytest.mark.parametrize("many", [1, 4, 9])
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


def test_four_parameters_are_drawn_with_the_value_of_the_fourth_in_the_title():
    axes = {n: [1.0, 2.0, 3.0] for n in "xyzw"}
    figure = study(product, axes).plot()
    assert figure.get_suptitle() == "w = 2 1"
    mesh = figure.axes[0].collections[0].get_array()
    np.testing.assert_array_equal(np.ravel(mesh), [4, 5, 6, 5, 6, 7, 6, 7, 8])


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


def test_points_drawn_together_beside_an_axis_have_its_colours():
    axes = [{"y": [1.0, 2.0]}, td.latin_hypercube({"x": (0, 1), "z": (0, 1)}, 20)]
    figure = study(product, axes).plot()
    assert [a.get_xlabel() for a in figure.axes] == ["x (1)", "z (1)"]
    assert [len(a.get_lines()) for a in figure.axes] == [2, 2]
    assert [t.get_text() for t in figure.legends[0].get_texts()] == ["1", "2"]


def test_an_array_hatches_the_region_at_its_coordinates():
    result = study(product, {"x": [2.0, 1.0], "y": [1.0, 3.0]})
    hatched = result.plot.map(x="x", y="y", proved=result["value"] > 5).axes[0].collections[1]
    shown = ~np.ma.getmaskarray(hatched.get_array()).reshape(2, 2)
    assert shown.tolist() == [[False, False], [False, True]]
    with pytest.raises(ModelError, match="proved: found an array over x of shape"):
        result.plot.map(proved=result["value"].isel(y=0))


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


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"at": {"law": "dal"}}, 'found the text "dal", expected one of dahl, lugre; did you mean'),
        ({"at": {"x": "one"}}, "at: x: found the text"),
        ({"x": "x", "y": "x"}, "a map over"),
    ],
)
def test_wrong_values_of_further_axes_are_refused(arguments, text):
    axes = {"law": ["dahl", "lugre"], "x": [1.0, 2.0], "y": [1.0, 2.0]}
    with pytest.raises(ModelError, match=text):
        study(lambda law, x, y: x - len(law), axes).plot.map(**arguments)
