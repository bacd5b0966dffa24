"""Figures of studies show the numbers that they are given; Sobol indices are those of formulas."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.text import Text

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.show.studies.data import words

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


def test_indices_need_points_that_were_drawn_for_them(gridded):
    with pytest.raises(ModelError, match="need points of sensitivity_samples"):
        gridded.sensitivity()
    flat = td.study(plane, td.sensitivity_samples({"x": (0, 1), "y": (0, 1)}, 4), measures=len)
    with pytest.raises(ModelError, match="every point failed"):
        flat.sensitivity("len")


def test_indices_are_refused_where_points_failed_or_nothing_varies():
    samples = td.sensitivity_samples({"x": (0, 1), "y": (0, 1)}, 8)
    some = td.study(lambda x, y: {"a": x / (x > 0.5)}, samples, measures={"a": dict})
    with pytest.raises(ModelError, match="are no numbers"):
        some.sensitivity("a")
    same = td.study(lambda x, y: 1.0, samples, measures=value)
    with pytest.raises(ModelError, match="nothing depends"):
        same.sensitivity()


def test_bars_stand_for_the_indices_with_the_largest_total_on_top(drawn):
    axis = drawn.plot().axes[0]
    names = [t.get_text() for t in axis.get_yticklabels()]
    assert names == ["z", "y", "x"]
    widths = [bar.get_width() for bar in axis.patches]
    indices = drawn.sensitivity().sel(parameter=names)
    np.testing.assert_allclose(widths[:3], indices["total"].values)
    np.testing.assert_allclose(widths[3:], indices["first"].values)


def test_curves_show_one_line_for_each_value_of_the_second_axis(gridded):
    axis = gridded.plot.curves(over="x", at={"z": 1.0}).axes[0]
    lines = axis.get_lines()
    assert len(lines) == 4
    np.testing.assert_allclose(lines[2].get_ydata(), gridded["value"].sel(z=1.0, y=2.0).values)
    assert axis.get_xscale() == "log"
    assert axis.get_xlabel() == "x (s)" and axis.get_ylabel() == "value (N)"


def test_a_map_shows_the_measure_with_proved_region_and_onset(gridded):
    figure = gridded.plot.map(at={"z": 0.0}, x="x", y="y", proved=lambda x: 0.5 * x, onset=0.0)
    mesh = figure.axes[0].collections[0]
    expected = gridded["value"].sel(z=0.0).transpose("y", "x").values
    np.testing.assert_allclose(np.asarray(mesh.get_array()).reshape(expected.shape), expected)
    legend = [t.get_text() for t in figure.legends[0].get_texts()]
    assert legend == ["proved", "onset, simulated"]


def test_each_point_lies_in_the_middle_of_its_cell_on_even_and_on_logarithmic_axes(gridded):
    mesh = gridded.plot.map(at={"z": 0.0}, x="x", y="y").axes[0].collections[0]
    corners = mesh.get_coordinates()
    x, y = corners[0, :, 0], corners[:, 0, 1]
    np.testing.assert_allclose(np.sqrt(x[1:] * x[:-1]), gridded["x"].values)
    np.testing.assert_allclose(0.5 * (y[1:] + y[:-1]), gridded["y"].values, atol=1e-12)


def test_words_on_an_axis_stand_beside_their_cells():
    axes = {"law": ["dahl", "lugre", "relay"], "x": [1.0, 2.0, 4.0]}
    dataset = td.study(lambda x, law: x - len(law), axes, measures=value, workers=1)
    figure = dataset.plot.map(x="x", y="law", onset=-2.0)
    figure.canvas.draw()
    axis, corners = figure.axes[0], figure.axes[0].collections[0].get_coordinates()
    assert [t.get_text() for t in axis.get_yticklabels()] == axes["law"]
    middle = 0.5 * (corners[1:, 0, 1] + corners[:-1, 0, 1])
    np.testing.assert_allclose(axis.get_yticks(), middle, atol=1e-12)


def test_points_that_failed_stay_empty_in_a_map():
    dataset = td.study(lambda x, y: x / (y > 0), {"x": [1.0, 2.0], "y": [0.0, 1.0]}, measures=value)
    shown = dataset.plot.map(x="x", y="y").axes[0].collections[0].get_array()
    assert np.ma.getmaskarray(shown).sum() == 2


def test_a_region_that_a_measure_calls_proved_is_hatched_there_alone():
    def claim(x, y):
        return {"margin": y - x, "status": "proved" if x < y else "unknown"}

    axes = {"x": [1.0, 2.0, 3.0], "y": [1.5, 2.5]}
    dataset = td.study(claim, axes, measures={"m": dict})
    hatched = dataset.plot.map("margin", x="x", y="y", proved="status").axes[0].collections[1]
    shown = ~np.ma.getmaskarray(hatched.get_array())
    assert shown.reshape(2, 3).tolist() == [[True, False, False], [True, True, False]]


def test_panels_share_one_scale_of_colours(gridded):
    figure = gridded.plot()
    meshes = [a.collections[0] for a in figure.axes[:2]]
    assert meshes[0].get_clim() == meshes[1].get_clim()
    assert "z = 1" in figure.axes[1].get_title(loc="left")


def test_points_drawn_together_are_shown_over_each_parameter():
    dataset = td.study(ishigami, td.latin_hypercube(COLUMNS, 20, seed=1), measures=value)
    figure = dataset.plot()
    assert [a.get_xlabel() for a in figure.axes] == ["x (1)", "y (1)", "z (1)"]


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda plot: plot.map("valu"), 'did you mean "value"'),
        (lambda plot: plot.map(), "a map has two axes"),
        (lambda plot: plot.map(at={"w": 1.0}), 'no axis "w"'),
        (lambda plot: plot.curves(over="x"), "give values of all but two"),
        (lambda plot: plot.panels(by="xx"), 'did you mean "x"'),
        (lambda plot: plot.scatter(), "points drawn together"),
    ],
)
def test_figures_that_the_axes_do_not_allow_are_refused(gridded, call, text):
    with pytest.raises(ModelError, match=text):
        call(gridded.plot)


@pytest.mark.parametrize(
    ("name", "shown"),
    [
        ("tracking_error", "tracking error"),
        ("rms_R_FF", r"rms $R_{\mathrm{FF}}$"),
        ("growth_X_s", "growth $X_{s}$"),
        ("peak_X_m_velocity", r"peak $\dot X_{m}$"),
        ("E", "E"),
        ("cancelled friction $f_D$", "cancelled friction $f_D$"),
        ("C_s.dahl.level", "C_s.dahl.level"),
    ],
)
def test_a_label_shows_signals_as_symbols_and_leaves_formulas_and_paths(name, shown):
    assert words(name) == shown


def test_a_figure_has_the_house_font_also_where_matplotlib_writes_it(gridded):
    """A generic family would be looked up when the figure is written, by whatever style is then."""
    figure = gridded.plot.curves(over="x", at={"z": 1.0})
    texts = [t for t in figure.findobj(Text) if t.get_text()]
    assert {t.get_fontfamily()[0] for t in texts} == {"STIXGeneral"}


@pytest.mark.parametrize("delays", [[0.0, 1e-3], np.linspace(0.0, 1e-3, 9)])
def test_labels_of_small_values_do_not_lie_on_one_another(delays):
    """Of two panels over a delay of the computer the numbers of the x-axis were one black line."""
    axes = {"z": [0.0, 1.0], "y": [0.1, 0.2], "x": delays}
    study = td.study(plane, axes, measures=value, units={"x": "s"}, workers=1)
    figure = study.plot.panels("value", x="x", y="y")
    figure.canvas.draw()
    for axis in figure.axes:
        boxes = [t.get_window_extent() for t in axis.get_xticklabels() if t.get_text()]
        assert all(a.x1 < b.x0 for a, b in zip(boxes, boxes[1:], strict=False))


def test_a_limit_of_no_such_name_lists_margins_and_claims():
    """Only measures were listed: "delay margn" was none of them."""
    with pytest.raises(ModelError, match=r'passive.*delay margin.*did you mean "delay margin"'):
        td.limit("delay margn", least=1e-3)
