"""Measured responses beside models, and figures of both in two widths."""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
import pytest
from devices import FEEDBACK, body

from teleopdesign.diagrams import haptic_interface
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
