"""Parts of the hand-written loop in plain Python: polynomials, filters, another solver."""

import numpy as np
import pytest
from devices import body
from scipy.integrate import solve_ivp

from teleopdesign.controllers import controller
from teleopdesign.diagrams import Control, Diagram, Moving, haptic_interface
from teleopdesign.realise import _free_mass as mass
from teleopdesign.realise import integrator
from teleopdesign.simulate import Trajectory, prepare, simulate

PERIOD, POLE = 1e-3, 0.7


def velocities(order, position, monkeypatch, *, start):
    """What the computer knows of the velocity of these readings, from a wrong start."""
    monkeypatch.setattr(integrator, "OBSERVER", order)
    memory = np.zeros(mass.ROWS)
    memory[mass.LAST_READING] = memory[mass.OBSERVED] = position[0]
    memory[mass.KNOWN] = start
    known, travels = [], []
    for reading in position[1:]:
        integrator.know_velocity(0, reading, PERIOD, POLE, memory, 0)
        memory[mass.LAST_READING] = reading
        known.append(memory[mass.KNOWN])
        travels.append(memory[mass.TRAVEL])
    return np.array(known), np.array(travels)


@pytest.mark.parametrize(("order", "bend"), [(0, 0.0), (2, 0.0), (3, 0.0), (3, 4.0)])
def test_errors_of_velocity_die_out_at_the_one_pole_of_their_observer(order, bend, monkeypatch):
    """Of a motion that it knows exactly in the end, (1 - p/z)^order takes all errors away."""
    t = PERIOD * np.arange(60)
    position = 0.2 + 0.3 * t + bend * t**2 / 2
    known, travels = velocities(order, position, monkeypatch, start=-0.5)
    np.testing.assert_allclose(travels, np.diff(position) / PERIOD, rtol=1e-9)
    error = known - (0.3 + bend * t[1:])
    assert abs(error[0]) > 0.05 and abs(error[-1]) < 1e-4
    for _ in range(max(order, 1)):
        error = error[1:] - POLE * error[:-1]
    assert np.abs(error).max() < 1e-11


def test_an_observer_of_constant_velocity_lags_a_constant_acceleration(monkeypatch):
    """By 2 p / (1 - p) samples, and half a sample less than it: late by 2/w for p = exp(-w h)."""
    t, bend = PERIOD * np.arange(200), 3.0
    known, _ = velocities(2, bend * t**2 / 2, monkeypatch, start=0.0)
    late = (bend * t[-1] - known[-1]) / bend
    w = -np.log(POLE) / PERIOD
    assert late == pytest.approx(2 / w, abs=0.6 * PERIOD)


def ring(monkeypatch, before, after):
    monkeypatch.setattr(integrator, "MANY_LATE", 1)
    return np.array(before, dtype=float), np.array(after, dtype=float), len(before)


@pytest.mark.parametrize(("node", "degree"), [(0, 1), (1, 2), (2, 3), (5, 3)])
@pytest.mark.parametrize("part", [0.0, 0.2, 0.5, 0.9])
def test_between_nodes_a_late_signal_is_the_polynomial_through_those_that_there_are(
    node, degree, part, monkeypatch
):
    def signal(x):
        return sum((0.7 + 0.3 * k) * x**k for k in range(degree + 1))

    both = signal(np.arange(9.0))
    arguments = ring(monkeypatch, both, both)
    value = integrator.earlier(0, node, part, *arguments)
    assert value == pytest.approx(signal(node + part), rel=1e-13)
    if part:  # a polynomial of one degree more is not met
        wrong = both + 0.1 * np.arange(9.0) ** (degree + 1)
        value = integrator.earlier(0, node, part, wrong, wrong, 9)
        assert abs(value - signal(node + part) - 0.1 * (node + part) ** (degree + 1)) > 1e-3


@pytest.mark.parametrize("jump", [1, 2, 3, 4, 5])
def test_a_jump_at_a_node_is_smeared_to_neither_side(jump, monkeypatch):
    """Linear before the jump and behind it: each point lies on the line of its side."""
    x = np.arange(9.0)

    def left(t):
        return 1.0 + 0.5 * t

    def right(t):
        return 9.0 - 2.0 * t

    before = np.where(x <= jump, left(x), right(x))
    after = np.where(x < jump, left(x), right(x))
    arguments = ring(monkeypatch, before, after)
    for node in range(7):
        for part in (0.0, 0.3, 0.8):
            expected = (right if node >= jump else left)(node + part)
            value = integrator.earlier(0, node, part, *arguments)
            assert value == pytest.approx(expected, rel=1e-13), (node, part)
    assert integrator.earlier(0, -1, 0.5, *arguments) == 0.0


@pytest.mark.parametrize("delay", [0.0123, 0.01234, 0.01238])
def test_a_late_cubic_force_moves_a_mass_by_its_integrals(delay):
    free = Diagram(
        "free",
        (
            Moving("M", body(0.1), "x", "u", {"f": 1}, "f"),
            Control("T", controller("delay", {"time": delay}), "w", "u", analog=True),
        ),
        (),
        {"f": "force", "w": "force"},
        measured=("x",),
    )
    force = {"w": lambda t: 1e5 * t**3}
    setup = prepare(free, duration=0.03, inputs=force, computer="continuous", jit=False)
    rows, _ = setup.run(setup.timing(10))  # steps of 0.1 ms: not divided so that the delay is some
    late = np.maximum(1e-3 * np.arange(31) - delay, 0.0)
    column = setup.program.layout.columns.index
    for name, expected in (("x", late**5 / 20), ("x_velocity", late**4 / 4)):
        values = rows[:, column(name)]
        assert np.abs(values - 1e6 * expected).max() < 1e-7 * 1e6 * expected.max(), name


def bristle(step):
    """Deflection of a Dahl bristle that is drawn at a speed which changes, one way."""
    moved = Trajectory(
        lambda t: 0.02 * t - 1e-4 * np.cos(90 * t) / 0.9,
        lambda t: 0.02 + 0.01 * np.sin(90 * t),
        lambda t: 0.9 * np.cos(90 * t),
    )
    diagram = haptic_interface(body(0.2, coulomb__level=0.5, presliding__stiffness=2e3))
    simulation = simulate(diagram, duration=0.012, motion={"L": moved}, step=step, jit=False)
    known = solve_ivp(
        lambda t, z: moved.velocity(t) * (1.0 - 2e3 / 0.5 * z),
        (0, 0.012), [0.0], t_eval=1e-3 * np.arange(13), rtol=1e-11, atol=1e-15,
    ).y[0]  # fmt: skip
    return simulation["Z_M_presliding_bristle"].values, known


def test_a_bristle_is_stepped_to_fourth_order():
    errors = []
    for step in (1e-3, 5e-4):
        forces, known = bristle(step)
        errors.append(np.abs(forces - known).max())
    assert errors[0] < 1e-4 * known.max()
    assert errors[0] / errors[1] > 8.0
