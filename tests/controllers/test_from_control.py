"""Systems of python-control as blocks of a diagram."""

import control
import numpy as np
import pytest
import sympy as sp
from devices import body
from scipy.signal import butter

from teleopdesign.controllers import from_control, invert_plant, parameter_symbol
from teleopdesign.diagrams import haptic_interface
from teleopdesign.realise.lti import S
from teleopdesign.simulate import Trajectory, simulate, sine

NOTCH = control.tf([1.0, 6.0, 4e3], [1.0, 120.0, 4e3])
#: two resonances and a slow pole
FIFTH = NOTCH * control.tf([3.0], [1.0, 0.5]) * control.tf([20.0, 1e3], [1.0, 4.0, 900.0])
MOTION = {"L": sine(amplitude=0.01, frequency=3.0)}


def sampled(made, **arguments):
    diagram = haptic_interface(body(0.1), cancellation=made)
    return simulate(
        diagram, **{"duration": 0.1, "motion": MOTION, "jit": False, "step": 1e-3} | arguments
    )


@pytest.mark.parametrize("system", [NOTCH, FIFTH, control.tf(3.0, 1)])
def test_a_computer_realises_it_exactly_for_an_input_held_over_a_sample(system):
    """Against python-control's own discretisation by zero-order hold; 1e-12: rounding."""
    steps = sampled(from_control(system))
    discrete = control.sample_system(control.ss(system), 1e-3, method="zoh")
    response = control.forced_response(discrete, steps["time"].values, steps["L"].values)
    expected = response.outputs
    np.testing.assert_allclose(steps["R_MBC"], expected, atol=1e-12 * np.abs(expected).max())


def test_a_filter_of_high_order_keeps_its_digits():
    """Butterworth of order 8 at 100 Hz, entries up to 2e22: its step as a sum of exponentials."""
    zeros, poles, gain = butter(8, 2 * np.pi * 100, analog=True, output="zpk")
    filtered = from_control(control.tf(*butter(8, 2 * np.pi * 100, analog=True)))
    one = {"L": Trajectory(np.ones_like, np.zeros_like, np.zeros_like)}
    steps = sampled(filtered, motion=one, duration=0.05)
    expected = np.zeros(len(steps["time"]), dtype=complex)
    for i, pole in enumerate(poles):
        share = gain / pole / np.prod(pole - np.delete(poles, i))
        expected += share * (np.exp(pole * steps["time"].values) - 1)
    assert len(zeros) == 0
    np.testing.assert_allclose(steps["R_MBC"], expected.real, atol=1e-12)


def test_an_inverse_leaves_the_low_pass_alone():
    """T is of relative degree one: a rod of 0.2 kg with 4 N s/m, force to velocity."""
    plant = control.tf([1.0, 9.0], [0.2, 4.0, 300.0])
    made = invert_plant(plant, bandwidth=25.0)
    form = made.linear_form("K", S, sp.S(0))
    form = form.subs({parameter_symbol("K", n): v for n, v in made.names().items()})
    for f in (0.1, 5.0, 80.0):
        point = 2j * np.pi * f
        whole = complex(form.subs(S, point)) * complex(plant(point))
        assert whole == pytest.approx(1 / (1 + 1j * f / 25.0), rel=1e-9)
