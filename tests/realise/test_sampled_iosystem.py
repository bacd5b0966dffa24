"""A diagram with its computer as a python-control system in discrete time."""

import control
import numpy as np
import pytest
from devices import body
from scipy.linalg import expm

from teleopdesign.controllers import controller, from_control
from teleopdesign.diagrams import Control, Diagram, Moving, haptic_interface
from teleopdesign.realise.iosystem import to_iosystem

DT = 1e-3
MASS, DAMPING = 0.2, 4.0
DISCRETE = control.tf([-90.0, 80.0], [1.0, -0.6], DT)


def rod(law, *, analog=False, late=0.0, damping=DAMPING):
    """A rod that a law pulls, its reading late."""
    blocks = [
        Moving("M", body(MASS, viscous__damping=damping), "x", "u", {"f": 1}, "f"),
        Control("K", law, "x_late" if late else "x", "u", "x", analog),
    ]
    if late:
        blocks.append(Control("T", controller("delay", {"time": late}), "x", "x_late", "", analog))
    return Diagram("rod", tuple(blocks), (), {"f": "force"}, measured=("x",))


def discrete_steps(system, forces, **options):
    time = DT * np.arange(len(forces))
    response = control.input_output_response(system, time, [forces], **options)
    return response, {name: response.outputs[i] for i, name in enumerate(system.output_labels)}


def test_its_linearisation_has_the_poles_of_the_exact_loop():
    """Poles by differences, 1e-5; a state that is only remembered adds poles at zero."""
    system = to_iosystem(rod(from_control(DISCRETE)), dt=DT)
    poles = control.linearize(system, np.zeros(system.nstates), [0.0], eps=1e-6).poles()
    plant = control.sample_system(control.tf([1.0], [MASS, DAMPING, 0.0]), DT, method="zoh")
    for pole in control.feedback(plant, DISCRETE, sign=1).poles():
        assert np.abs(poles - pole).min() < 1e-5


def test_parameters_are_its_params():
    law = controller("spring_damper", {"stiffness": -200.0, "damping": -2.0})
    system = to_iosystem(rod(law), dt=DT)
    changed = {"M.inertia": 0.5, "K.spring_damper.stiffness": -50.0}
    other = to_iosystem(rod(law).with_values(changed), dt=DT)
    forces = np.ones(21)
    one, two = (
        discrete_steps(s, forces, params=p)[1]["x"] for s, p in ((system, changed), (other, {}))
    )
    np.testing.assert_allclose(one, two, rtol=1e-12)
    assert abs(one[-1] / discrete_steps(system, forces)[1]["x"][-1] - 1) > 0.1


@pytest.mark.parametrize("stiffness", [2e5, 2e7, 2e8])
def test_a_body_that_swings_fast_is_stepped_as_finely_as_it_asks_for(stiffness):
    """At 1 to 31 thousand rad/s: the held step of the exact system, though steps are 0.1 ms."""
    drag = 2 * 0.3 * (stiffness * MASS) ** 0.5
    device = body(MASS, viscous__damping=drag, spring__stiffness=stiffness)
    system = to_iosystem(haptic_interface(device), dt=DT)
    forces = np.random.default_rng(1).normal(size=12)
    names = list(system.input_labels)
    inputs = np.zeros((len(names), 12))
    inputs[names.index("R_D" if "R_D" in names else names[0])] = forces
    response = control.input_output_response(system, DT * np.arange(12), inputs)
    a = np.array([[0.0, 1.0], [-stiffness / MASS, -drag / MASS]])
    whole = expm(np.vstack([np.column_stack([a, [0.0, 1 / MASS]]), np.zeros(3)]) * DT)
    x, expected = np.zeros(2), []
    for force in forces:
        expected.append(x[0])
        x = whole[:2, :2] @ x + whole[:2, 2] * force
    here = response.outputs[list(system.output_labels).index("L")]
    assert np.abs(here - expected).max() < 5e-3 * np.ptp(expected)
