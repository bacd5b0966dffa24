"""The teleoperator on one axis: its two-port from the wiring, and its simulation."""

import numpy as np
import pytest
import sympy as sp
from devices import body

from teleopdesign.blocks import CONTACT
from teleopdesign.controllers import controller
from teleopdesign.derive import block_symbol, counterexample, proved_equal, two_port_functions
from teleopdesign.diagrams import ANY, teleoperator
from teleopdesign.realise.iosystem import to_iosystem
from teleopdesign.realise.lti import S, linear_blocks
from teleopdesign.simulate import simulate, sine

Z_m, Z_s, Z_E, P, C_m, C_s = map(block_symbol, ("Z_m", "Z_s", "Z_E", "P", "C_m", "C_s"))
COUPLING = controller("spring_damper", {"stiffness": 1000.0, "damping": 5.0})
DAHL = controller("dahl", {"level": 0.4, "stiffness": 4e3})


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


def test_an_environment_at_the_slaves_port_gives_the_transmitted_impedance():
    """Z_t = h_11 - h_12 Z_E (I + h_22 Z_E)^-1 h_21, exact on matrices that do not commute."""
    diagram = teleoperator(environment=ANY, master_cancellation=ANY, slave_cancellation=ANY)
    h = two_port_functions(diagram)
    inner = (sp.S(1) + h["h_22"] * Z_E) ** -1
    closed = h["h_11"] - h["h_12"] * Z_E * inner * h["h_21"]
    assert counterexample(h["Z_t"], closed) is None


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


@pytest.mark.slow
def test_python_control_and_the_kernel_agree_on_a_compensated_teleoperator():
    import control

    slave = body(0.3, coulomb__level=0.5, presliding__stiffness=1e4, viscous__damping=2.0)
    diagram = teleoperator(
        body(0.1, viscous__damping=0.5), slave, coupling=COUPLING, slave_cancellation=DAHL
    )
    push = lambda t: 0.8 * np.sin(2 * np.pi * 2.0 * t)  # noqa: E731
    simulation = simulate(
        diagram, duration=0.4, inputs={"F_u": push}, computer="continuous", step=1e-4
    )
    system = to_iosystem(diagram)
    time = simulation["X_s"]["time"].values
    inputs = np.array([push(time) if n == "F_u" else 0 * time for n in system.input_labels])
    response = control.input_output_response(
        system, time, inputs, solve_ivp_kwargs={"rtol": 1e-8, "atol": 1e-11}
    )
    for name in ("X_m", "X_s", "F_P", "F_Cs"):
        reference = response.outputs[system.output_labels.index(name)]
        # python-control interpolates inputs linearly between samples: a few 1e-6 of the largest
        assert np.abs(simulation[name].values - reference).max() < 1e-4 * np.abs(reference).max(), (
            name
        )


def test_contact_pushes_the_slave_and_never_pulls():
    wall = body(0.0).with_effect(
        CONTACT, {"stiffness": 800.0, "damping": 4.0, "contact_position": 1e-3}
    )
    simulation = simulate(
        linear(environment=wall),
        duration=2.0,
        motion={"X_m": sine(amplitude=4e-3, frequency=1.0)},
    )
    force, there = simulation["F_s"].values, simulation["X_s"].values
    assert force.max() <= 0.0 and force.min() < -0.5
    assert np.all(force[there < 1e-3] == 0.0)
