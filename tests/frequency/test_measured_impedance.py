"""Impedance measured in simulation: linear mechanisms, Coulomb friction, errors, files."""

import json

import numpy as np
import pytest
from devices import body

from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.frequency import bode, measured_impedance, simulated_response

LINEAR = body(0.2, viscous__damping=3.0, spring__stiffness=500.0)


@pytest.fixture(scope="module")
def coulomb():
    diagram = haptic_interface(body(coulomb__level=0.5))
    return measured_impedance(diagram, amplitude=[1e-3, 4e-3, 1e-2], frequency=[2.0, 5.0])


def test_a_linear_mechanism_has_the_same_impedance_at_every_amplitude():
    impedance = measured_impedance(
        haptic_interface(LINEAR), amplitude=[1e-4, 1e-2], frequency=[0.5, 8.0, 60.0]
    )
    s = 2j * np.pi * np.array([0.5, 8.0, 60.0])
    expected = 0.2 * s**2 + 3.0 * s + 500.0
    # exact but for (omega step)^2/8 of reading cycles between steps
    np.testing.assert_allclose(impedance.data["impedance"][0, :, 0], expected, rtol=1e-4)
    assert float(impedance.spread()["size"].max()) < 1e-6
    assert float(impedance.data["distortion"].max()) < 1e-3


def test_coulomb_friction_and_mass_are_as_the_describing_function_says(coulomb):
    omega = 2 * np.pi * coulomb.data["frequency"]
    expected = -0.15 * omega**2 + 1j * 4 * 0.5 / (np.pi * coulomb.data["amplitude"])
    ratio = (coulomb.data["impedance"].isel(case=0) / expected).values
    # the contact gives by 1e-5 of the amplitude: 0.4 % of friction, in phase with position
    assert np.abs(ratio - 1).max() < 5e-3


def test_phase_loss_over_a_decade_stays_below_its_bound(coulomb):
    """At most 54.9 degrees a decade of amplitude for mass and Coulomb friction (P21)."""
    spread = coulomb.spread()["phase"]
    assert float(spread.max()) < 54.9 + 0.3  # 0.3: the contact's give
    assert float(spread.max()) > 50


def test_beyond_an_actuators_reach_there_is_no_number(coulomb, tmp_path):
    limited = coulomb.up_to(lambda f: 0.02 / f)
    known = np.isfinite(limited.decibel.isel(case=0).values)
    np.testing.assert_array_equal(known, [[True, True, True], [True, True, False]])
    assert float(limited.spread()["size"][0, 1]) < float(coulomb.spread()["size"][0, 1])
    limited.to_json(tmp_path / "map.json")
    written = json.loads((tmp_path / "map.json").read_text(), parse_constant=pytest.fail)
    assert written["cases"]["haptic interface"]["size"][1][2] is None


@pytest.mark.slow
def test_a_linear_loop_simulated_agrees_with_its_symbolic_response():
    """Analog force feedback on a hand: 0.1 % at every frequency."""
    feedback = controller("low_pass", {"bandwidth": 20.0})
    diagram = haptic_interface(
        body(viscous__damping=5.0), hand=LINEAR, force_feedback=feedback, analog=("H",)
    )
    f = np.array([0.5, 2.0, 5.0, 20.0, 100.0])
    response = simulated_response(diagram, amplitude=1.0, frequency=f)
    np.testing.assert_allclose(response.values(), bode(diagram, frequency=f).values(), rtol=1e-3)
