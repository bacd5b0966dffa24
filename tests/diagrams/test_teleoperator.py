"""The teleoperator on one axis: its two-port from the wiring, and its simulation."""

import numpy as np
import pytest
import sympy as sp
from devices import body

from teleopdesign.controllers import controller
from teleopdesign.derive import block_symbol, proved_equal, two_port_functions
from teleopdesign.diagrams import ANY, teleoperator
from teleopdesign.realise.lti import S, linear_blocks
from teleopdesign.simulate import simulate, sine

Z_m, Z_s, Z_E, P, C_m, C_s = map(block_symbol, ("Z_m", "Z_s", "Z_E", "P", "C_m", "C_s"))
COUPLING = controller("spring_damper", {"stiffness": 1000.0, "damping": 5.0})


def linear(**parts):
    """Master and slave with damping, joined by spring and damper."""
    return teleoperator(
        body(0.1, viscous__damping=0.5),
        body(0.3, viscous__damping=2.0),
        coupling=COUPLING,
        **parts,
    )


def with_values(expression, diagram):
    """A symbolic expression of blocks as a function of s."""
    blocks = linear_blocks(diagram).blocks
    numbers = {block_symbol(n): z for n, z in blocks.items()}
    return sp.lambdify(S, expression.subs(numbers))


def test_the_two_port_of_two_sides_without_cancellation_is_that_of_the_textbook():
    functions = two_port_functions(teleoperator(environment=ANY))
    slave = (Z_s + P) ** -1
    assert proved_equal(functions["h_11"], Z_m + P - P * slave * P)
    assert proved_equal(functions["h_12"], -P * slave)
    assert proved_equal(functions["h_21"], slave * P)
    assert proved_equal(functions["Z_t"], Z_m + P - P * (Z_s + Z_E + P) ** -1 * P)


def test_a_perfect_slave_side_is_felt_as_nothing():
    """C_s = Z_s: the slave follows at once and only the master remains."""
    h = two_port_functions(teleoperator(slave_cancellation=ANY))
    exact = {C_s: Z_s}
    assert proved_equal(h["h_21"].subs(exact), sp.S(1))
    assert proved_equal(h["h_11"].subs(exact), Z_m)


@pytest.mark.parametrize(("frequency", "cycles"), [(0.7, 4), (8.0, 16)])
def test_the_simulated_transmitted_impedance_is_the_derived_one(frequency, cycles):
    environment = body(0.0, spring__stiffness=300.0, viscous__damping=1.0)
    diagram = linear(environment=environment)
    amplitude = 2e-3
    simulation = simulate(
        diagram,
        duration=cycles / frequency,
        motion={"X_m": sine(amplitude=amplitude, frequency=frequency)},
        computer="continuous",
        step=1e-4,
    )
    time = simulation["F_m"]["time"].values
    last = time >= (cycles - 1) / frequency - 1e-9
    angle = 2 * np.pi * frequency * time[last]
    waves = np.column_stack([np.sin(angle), np.cos(angle)])
    real, imaginary = np.linalg.lstsq(waves, simulation["F_m"].values[last], rcond=None)[0]
    phasor = (real + 1j * imaginary) / amplitude
    derived = with_values(two_port_functions(diagram)["Z_t"], diagram)(2j * np.pi * frequency)
    # the slave on its springs decays at 13/s: after 1.9 s nothing is left
    assert abs(phasor - derived) < 1e-3 * abs(derived)
