"""A measured frequency response is a block where a response is enough, and nowhere else."""

import control
import numpy as np
import pytest
from devices import body

from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller, from_control
from teleopdesign.diagrams import controller_parts, haptic_interface, plant_parts
from teleopdesign.frequency import bode, delay_margin, loop_gain, matrix_response

W = np.geomspace(1.0, 1000.0, 61)
FILTER = control.tf([30.0], [1.0, 30.0])
MEASURED = from_control(control.frd(FILTER, W), name="drive")
F = W / (2 * np.pi)


def interface(law):
    return haptic_interface(body(0.15), hand=body(0.5, viscous__damping=4.0), force_feedback=law)


def test_responses_are_those_of_the_system_that_was_measured():
    """At its own frequencies, where nothing lies between; 1e-12: rounding."""
    known = interface(from_control(FILTER))
    expected = bode(known, frequency=F).values()
    diagram = interface(MEASURED)
    np.testing.assert_allclose(bode(diagram, frequency=F).values(), expected, rtol=1e-12)
    matrix = matrix_response(diagram, ["R_M"], ["R_D"], F).data.values.ravel()
    np.testing.assert_allclose(matrix, expected, rtol=1e-10)
    np.testing.assert_allclose(loop_gain(diagram)(1j * W), loop_gain(known)(1j * W), rtol=1e-12)


def test_in_series_it_is_a_factor_and_between_two_frequencies_a_line():
    """1 %: the filter bends by less between 20 frequencies a decade."""
    both = MEASURED.then(controller("gain", {"gain": 2.0}))
    between = 1j * np.sqrt(W[1:] * W[:-1])
    response, known = (loop_gain(interface(law))(between) for law in (both, from_control(FILTER)))
    np.testing.assert_allclose(response / known, 2.0, rtol=0.01)


def test_a_delay_margin_is_that_of_the_system_that_was_measured():
    """1 %: lines between 20 frequencies a decade. A gain below 1 throughout bears any delay."""
    for gain in (0.5, 9.0):
        law = controller("gain", {"gain": gain})
        response, known = (
            delay_margin(loop_gain(interface(block.then(law))))
            for block in (MEASURED, from_control(FILTER))
        )
        assert response == pytest.approx(known, rel=0.01)


def test_a_matrix_of_responses_is_a_block_for_each_entry_and_a_plant_needs_a_mass():
    both = control.append(FILTER, 2 * FILTER)
    parts, _ = controller_parts(
        control.frd(both, W), name="K", inputs=("a", "b"), outputs=("c", "d"), motion="x"
    )
    assert [part.name for part in parts][0] == "K_1_1"
    with pytest.raises(ModelError, match="show a mass of"):
        plant_parts(control.frd(FILTER, W), name="P", motion="x", command="u", driver="f")
