"""A delay block is e^(-s T) in every form, and its simulation is exact."""

from math import factorial

import numpy as np
import pytest
import sympy as sp
from devices import body
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller
from teleopdesign.derive import all_transfers, transfer, transfer_function
from teleopdesign.diagrams import Control, Diagram, Junction, Moving
from teleopdesign.frequency import bode, delay_margin, loop_gain, matrix_response
from teleopdesign.realise.iosystem import to_iosystem
from teleopdesign.simulate import simulate

STIFFNESS, MASS = 20.0, 0.1


def late(time):
    return controller("delay", {"time": time})


def held(time, *, analog=True, damping=0.0):
    """A mass that a spring pulls to where it was: m x'' + d x' + k x(t - T) = f."""
    device = body(MASS, viscous__damping=damping) if damping else body(MASS)
    spring = controller("spring_damper", {"stiffness": STIFFNESS, "damping": 0.0})
    return Diagram(
        "held",
        (
            Moving("M", device, "x", "u", {"f": 1}, "f"),
            Control("T_1", late(time), "x", "x_late", analog=analog),
            Control("P", spring, "x_late", "F", "x", analog=analog),
        ),
        (Junction("u", {"F": -1}),),
        {"f": "force"},
        measured=("x",),
    )


def step_response(time, t):
    """x for f = 1 N: sum of (-k/m)^n (t - n T)^(2n+2)/(2n+2)! / m, each from t = n T."""
    total = np.zeros_like(t)
    for n in range(int(t[-1] / time) + 2):
        ramp = np.maximum(t - n * time, 0.0)
        total += (-STIFFNESS / MASS) ** n * ramp ** (2 * n + 2) / factorial(2 * n + 2) / MASS
    return total


@pytest.mark.parametrize("time", [0.02, 0.0255, 0.0204321])
def test_a_delayed_loop_is_its_analytic_solution(time):
    """1e-9 of the range: order four at steps of 0.1 ms; the last T is no whole number of them."""
    simulation = simulate(held(time), duration=0.3, inputs={"f": 1.0}, computer="continuous")
    expected = step_response(time, simulation["time"].values)
    assert np.abs(simulation["x"].values - expected).max() < 1e-9 * np.ptp(expected)


def test_a_jump_passes_an_analog_delay_as_a_jump():
    """A force of 1 N on a free mass, late: nothing before T, a parabola behind; rounding alone."""
    time = 0.0123
    free = Diagram(
        "free",
        (
            Moving("M", body(MASS), "x", "u", {"f": 1}, "f"),
            Control("T_1", late(time), "w", "u", analog=True),
        ),
        (),
        {"f": "force", "w": "force"},
        measured=("x",),
    )
    simulation = simulate(free, duration=0.05, inputs={"w": 1.0}, computer="continuous", jit=False)
    t = simulation["time"].values
    expected = np.maximum(t - time, 0.0) ** 2 / (2 * MASS)
    np.testing.assert_allclose(simulation["x"].values, expected, atol=1e-14)
    assert not simulation["u"].values[t < time].any()
    assert (simulation["u"].values[t >= time] == 1.0).all()


@given(samples=st.integers(1, 40))
@settings(max_examples=8, deadline=None)
def test_whole_samples_are_exact_in_a_computer(samples):
    diagram = held(samples * 1e-3, analog=False)
    simulation = simulate(diagram, duration=0.08, inputs={"f": 1.0}, jit=False)
    x, x_late = simulation["x"].values, simulation["x_late"].values
    assert not x_late[:samples].any()
    np.testing.assert_array_equal(x_late[samples:], x[: len(x) - samples])


def test_between_samples_a_computers_delay_lies_on_the_line_that_joins_them():
    diagram = held(5.25e-3, analog=False)
    simulation = simulate(diagram, duration=0.05, inputs={"f": 1.0}, jit=False)
    x = simulation["x"].values
    between = 0.75 * x[1:-5] + 0.25 * x[:-6]
    np.testing.assert_allclose(simulation["x_late"].values[6:], between, rtol=1e-14)


def test_the_derivation_has_the_dead_time_as_a_factor_that_commutes():
    x = transfer(held(0.02), "x", ("f",))["f"]
    m, p, s, v = (sp.Symbol(n) for n in ("M", "P", "s", "V_P"))  # V_P: the damper, on x itself
    plain = x.xreplace({a: sp.Symbol(a.name) for a in x.free_symbols})
    assert sp.simplify(plain - 1 / (m + v + p * sp.exp(-s * sp.Symbol("T_1")))) == 0
    assert "exp(-s T_1) P" in all_transfers(held(0.02))["x/f"].text()


@given(time=st.floats(1e-4, 1.0), frequency=st.floats(0.1, 50.0))
@settings(max_examples=20, deadline=None)
def test_responses_hold_the_dead_time_exactly(time, frequency):
    diagram, f = held(time, damping=2.0), np.array([frequency])
    s = 2j * np.pi * f
    expected = 1 / (MASS * s**2 + 2.0 * s + STIFFNESS * np.exp(-s * time))
    np.testing.assert_allclose(
        bode(diagram, output="x", input="f", frequency=f).values(), expected, rtol=1e-9
    )
    by_matrix = matrix_response(diagram, ["x"], ["f"], f).data.values.ravel()
    np.testing.assert_allclose(by_matrix, expected, rtol=1e-9)


def test_a_delay_block_costs_its_time_in_the_delay_margin():
    margins = [delay_margin(loop_gain(held(t, damping=4.0), controller="P")) for t in (0.0, 0.03)]
    assert margins[0] - margins[1] == pytest.approx(0.03, rel=1e-9)


@pytest.mark.slow
def test_python_control_has_a_pade_approximation_where_its_order_is_asked_for():
    """Order 8 for 10 ms, moved at some Hz: 1e-6 of the range."""
    import control

    diagram = held(0.01, damping=4.0)
    with pytest.raises(ModelError, match="holds no dead time: delay_order=4") as caught:
        to_iosystem(diagram)
    assert "\n" not in str(caught.value)
    system = to_iosystem(diagram, delay_order=8)
    t = np.linspace(0.0, 0.5, 501)
    force = 1 - np.cos(20 * t)
    fine = simulate(
        diagram,
        duration=0.5,
        inputs={"f": lambda t: 1 - np.cos(20 * t)},
        computer="continuous",
        jit=False,
    )
    response = control.input_output_response(
        system, t, force, solve_ivp_kwargs={"rtol": 1e-10, "atol": 1e-12}
    )
    x = response.outputs[system.output_labels.index("x")]
    expected = fine["x"].values
    # input_output_response joins inputs by lines, 1 ms apart: 2e-5
    assert np.abs(x - expected).max() < 1e-4 * np.ptp(expected)
    rational, _ = transfer_function(diagram, output="x", input="f", delay_order=8)
    assert rational(20j) == pytest.approx(
        1 / (MASS * (20j) ** 2 + 80j + STIFFNESS * np.exp(-0.2j)), rel=1e-9
    )
