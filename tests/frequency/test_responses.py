"""Measured responses beside models, and figures of both in two widths."""

from dataclasses import replace

import control
import matplotlib.pyplot as plt
import numpy as np
import pytest
from devices import FEEDBACK, body

from teleopdesign.base.errors import ModelError
from teleopdesign.diagrams import four_cases, haptic_interface, world_haptics_2005
from teleopdesign.frequency import bode, measured_response, quasi_linear_impedance
from teleopdesign.show import plot_spread

HAND = body(0.2, viscous__damping=4.0, spring__stiffness=300.0)
DIAGRAM = haptic_interface(body(viscous__damping=2.0), hand=HAND, force_feedback=FEEDBACK)
F = np.array([1.0, 3.0, 10.0, 30.0])


@pytest.fixture
def model():
    return bode(DIAGRAM, frequency=F)


def test_python_control_data_and_arrays_give_the_same_response(model):
    from_frd = measured_response(model.as_frd())
    from_arrays = measured_response(model.values(), frequency=F)
    np.testing.assert_allclose(from_frd.values(), model.values(), rtol=1e-12)
    np.testing.assert_allclose(from_arrays.data["phase"], from_frd.data["phase"], rtol=1e-9)
    np.testing.assert_allclose(from_frd.data["frequency"], F)
    assert from_frd.measured and not model.measured
    assert repr(from_frd).endswith("measured")


@pytest.mark.parametrize(
    ("values", "frequency", "message"),
    [
        ([1, 2], None, "need frequency"),
        ([1, 2], [1.0], "shape"),
        ([1, 2], [2.0, 1.0], "must be positive and rise"),
        (control.frd(np.ones((2, 2, 3)), [1, 2, 3]), None, "2 inputs and 2 outputs"),
    ],
)
def test_wrong_data_is_reported_in_one_line(values, frequency, message):
    with pytest.raises(ModelError, match=message):
        measured_response(values, frequency=frequency)


def test_an_unknown_case_names_the_nearest():
    response = bode(four_cases(DIAGRAM), frequency=F)
    with pytest.raises(ModelError, match='did you mean "FF"'):
        response.values("F")


def test_a_ratio_of_unlike_signals_has_their_unit():
    assert bode(DIAGRAM, output="L", input="R_D", frequency=F).data["magnitude"].units == "m/N"


def test_measured_is_drawn_as_grey_points_and_the_model_as_line(model):
    measured = measured_response(model.values(), frequency=F)
    for figure in (model.plot(measured=measured), model.plot_nyquist(measured=measured)):
        lines = [a for a in figure.axes[0].lines if len(a.get_xdata()) == len(F)]
        styles = {(line.get_linestyle(), line.get_marker()) for line in lines}
        assert ("-", "None") in styles and ("None", "o") in styles
        plt.close(figure)


def test_measured_phase_is_drawn_on_the_turn_of_the_model(model):
    turned = measured_response(model.values() * np.exp(-2j * np.pi), frequency=F)
    figure = model.plot(measured=replace(turned, phase=turned.phase + 720.0))
    line, points = figure.axes[1].lines
    np.testing.assert_allclose(line.get_ydata(), points.get_ydata(), atol=1e-6)
    plt.close(figure)


@pytest.mark.parametrize(("columns", "width"), [(1, 3.5), (2, 7.16)])
def test_every_figure_comes_in_two_widths(model, columns, width):
    cases = {"none": four_cases(world_haptics_2005())["none"]}
    grid = quasi_linear_impedance(cases, amplitude=[1e-3, 1e-2], frequency=[1.0, 10.0])
    figures = [
        model.plot(columns=columns),
        model.plot_nyquist(columns=columns),
        grid.plot(columns=columns),
        grid.plot("amplitude", model=grid, columns=columns),
        plot_spread(grid, columns=columns),
    ]
    for figure in figures:
        assert figure.get_figwidth() == width
        for axis in figure.axes:
            assert "(" in axis.get_ylabel() or "part" in axis.get_ylabel()
        plt.close(figure)


def test_a_response_that_is_zero_says_so_and_has_no_decibels():
    cases = bode(four_cases(world_haptics_2005()))  # its only impedance is ideal friction
    assert all(cases.is_zero(c) for c in ("none", "MBC", "FF", "hybrid"))
    assert "MBC: zero at every frequency, left out: Z_M.coulomb" in repr(cases)
    figure = cases.plot()
    assert all(len(line.get_xdata()) == 0 for axis in figure.axes for line in axis.lines)
    names = [t.get_text() for t in figure.legends[0].get_texts()]
    assert len(names) == 4 and all(n.endswith("(zero)") for n in names)
