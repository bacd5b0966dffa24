"""Controllers of several inputs and outputs in state space: each state is there once."""

from dataclasses import replace

import control
import numpy as np
import pytest
from devices import body

from teleopdesign.controllers import controller, from_control
from teleopdesign.diagrams import (
    Control,
    Diagram,
    Moving,
    controller_parts,
    with_shared_states,
)
from teleopdesign.passivity import ports
from teleopdesign.passivity.linear.family import family_at
from teleopdesign.realise.iosystem import to_iosystem
from teleopdesign.simulate import simulate

MASSES, DAMPINGS = (0.1, 0.2), (3.0, 3.0)
FORCES = np.array([0.5, -0.3])
#: two rods, positions and velocities, as python-control has them
RODS = control.ss(
    [[0, 1, 0, 0], [0, -30.0, 0, 0], [0, 0, 0, 1], [0, 0, 0, -15.0]],
    [[0, 0], [10.0, 0], [0, 0], [0, 5.0]],
    [[1, 0, 0, 0], [0, 0, 1, 0]],
    np.zeros((2, 2)),
)


def stabilising(pole):
    """A controller with a pole of its own that both axes drive and both feel, s^-1: an observer.

    u = v + (1, 1/2) w, dw/dt = pole w + v_1 + v_2; v by an observer of rods and w. At 0: an
    integrator; > 0: the controller grows by itself, and the loop with it decays
    """
    through = np.array([[1.0], [0.5]])
    a = np.block([[RODS.A, RODS.B @ through], [np.zeros((1, 4)), np.full((1, 1), pole)]])
    b = np.vstack([RODS.B, [[1.0, 1.0]]])
    c = np.hstack([RODS.C, np.zeros((2, 1))])
    k = control.place(a, b, [-3.0, -4.0, -5.0, -15.0, -30.0])
    gain = control.place(a.T, c.T, [-8.0, -9.0, -10.0, -16.0, -31.0]).T
    whole = np.block(
        [[a - b @ k - gain @ c, np.zeros((5, 1))], [-np.ones((1, 2)) @ k, np.full((1, 1), pole)]]
    )
    out = np.hstack([-k, through])
    return control.ss(whole, np.vstack([gain, np.zeros((1, 2))]), out, np.zeros((2, 2)))


def two_rods(system, *, analog=True):
    rods = tuple(
        Moving(f"Z{i}", body(m, viscous__damping=b), f"x{i}", f"u{i}", {f"f{i}": 1.0}, f"f{i}")
        for i, m, b in zip((1, 2), MASSES, DAMPINGS, strict=True)
    )
    controls, sums = controller_parts(
        system, name="K", inputs=("x1", "x2"), outputs=("u1", "u2"), motion="x1", analog=analog
    )
    outside = {"f1": "force", "f2": "force"}
    return Diagram("two rods", (*rods, *controls), sums, outside, ("x1", "x2"))


def closed(pole):
    k = stabilising(pole)
    a = np.block([[RODS.A, RODS.B @ k.C], [k.B @ RODS.C, k.A]])
    assert np.linalg.eigvals(a).real.max() < -2  # the loop decays
    output_matrix = np.hstack([RODS.C, np.zeros((2, 6))])
    return control.ss(a, np.vstack([RODS.B, np.zeros((6, 2))]), output_matrix, 0), a


@pytest.mark.slow
@pytest.mark.parametrize("pole", [0.0, 3.0])
def test_a_loop_with_a_controller_that_grows_by_itself_decays_as_its_matrices_say(pole):
    """A copy of the states for each entry would grow as e^(pole t). 1e-6 of the range."""
    exact, a = closed(pole)
    simulation = simulate(
        two_rods(stabilising(pole)),
        duration=1.0,
        inputs={"f1": FORCES[0], "f2": FORCES[1]},
        computer="continuous",
        step=2e-4,
    )
    time = simulation["time"].values
    answer = control.forced_response(exact, time, np.outer(FORCES, np.ones(len(time)))).outputs
    for x, theirs in zip(("x1", "x2"), answer, strict=True):
        assert np.abs(simulation[x].values - theirs).max() < 1e-6 * np.ptp(theirs)
    system = to_iosystem(two_rods(stabilising(pole)))
    linear = system.linearize(np.zeros(system.nstates), np.zeros(system.ninputs))
    assert system.nstates == len(a)
    rates = (np.sort_complex(np.linalg.eigvals(m)) for m in (linear.A, a))
    np.testing.assert_allclose(*rates, rtol=1e-5)


def test_what_no_output_shows_is_there_all_the_same():
    """A state that grows, driven by the second input alone and seen by no output."""
    hidden = control.ss([[-5.0, 0], [0, 2.0]], np.eye(2), [[-3.0, 0]], [[0, 0]])
    controls, sums = controller_parts(
        hidden, name="K", inputs=("x", "v"), outputs=("u",), motion="x", analog=True
    )
    rod = Moving("Z", body(0.1, viscous__damping=2.0), "x", "u", {"f": 1.0}, "f")
    late = Control("D", controller("low_pass", {"bandwidth": 9.0}), "x", "v", "x", True)
    diagram = Diagram("hidden", (rod, late, *controls), sums, {"f": "force"}, ("x",))
    assert family_at(diagram, ports(diagram)).undecayed == pytest.approx([2.0])


@pytest.mark.parametrize(("b", "c"), [(1.0, 0.0), (0.0, 1.0), (0.0, 0.0)])
def test_one_entry_that_is_zero_keeps_its_states(b, c):
    unseen = control.ss([[2.0]], [[b]], [[c]], [[0.0]])
    controls, sums = controller_parts(unseen, name="K", inputs=("x",), outputs=("u",), motion="x")
    rod = Moving("Z", body(0.1, viscous__damping=2.0), "x", "u", {"f": 1.0}, "f")
    diagram = Diagram("zero", (rod, *controls), sums, {"f": "force"}, ("x",))
    assert family_at(diagram, ports(diagram)).undecayed == pytest.approx([2.0])


@pytest.mark.slow
def test_a_loop_of_static_laws_has_no_pivot_that_is_zero():
    """Systems without a straight way, each in a sum of all: D = 0 was divided by."""
    system = stabilising(0.0)
    together = with_shared_states(two_rods(system))
    first = control.ss([[0.0]], [[1.0]], [[1.0]], [[0.0]])
    as_laws = replace(
        together,
        blocks=tuple(
            replace(b, controller=from_control(first, name="one")) if isinstance(b, Control) else b
            for b in together.blocks
        ),
    )
    ends = [
        simulate(d, duration=0.05, inputs={"f1": 1.0}, computer="continuous", step=1e-3, jit=False)[
            "x1"
        ].values[-1]
        for d in (together, as_laws)
    ]
    assert ends[1] == pytest.approx(ends[0], rel=1e-6)
