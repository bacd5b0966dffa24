"""Measured responses beside models, and figures of both in two widths."""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
import pytest
from devices import FEEDBACK, body

from teleopdesign.diagrams import four_cases, haptic_interface, world_haptics_2005
from teleopdesign.frequency import bode, measured_response

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


def test_measured_phase_is_drawn_on_the_turn_of_the_model(model):
    turned = measured_response(model.values() * np.exp(-2j * np.pi), frequency=F)
    figure = model.plot(measured=replace(turned, phase=turned.phase + 720.0))
    line, points = figure.axes[1].lines
    np.testing.assert_allclose(line.get_ydata(), points.get_ydata(), atol=1e-6)
    plt.close(figure)


def test_a_response_that_is_zero_says_so_and_has_no_decibels():
    cases = bode(four_cases(world_haptics_2005()))  # its only impedance is ideal friction
    assert all(cases.is_zero(c) for c in ("none", "MBC", "FF", "hybrid"))
    assert "MBC: zero at every frequency, left out: Z_M.coulomb" in repr(cases)
    figure = cases.plot()
    assert all(len(line.get_xdata()) == 0 for axis in figure.axes for line in axis.lines)
    names = [t.get_text() for t in figure.legends[0].get_texts()]
    assert len(names) == 4 and all(n.endswith("(zero)") for n in names)
