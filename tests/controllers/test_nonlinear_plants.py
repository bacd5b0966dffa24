"""Nonlinear python-control systems of several signals, and as plants: simulated, not derived."""

import control
import numpy as np
import pytest
from devices import two_rods

from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import from_control
from teleopdesign.derive import transfer_function
from teleopdesign.diagrams import (
    Control,
    Diagram,
    Junction,
    controller_parts,
    coupled_plant_parts,
    plant_parts,
)
from teleopdesign.frequency import bode, loop_gain
from teleopdesign.passivity import diagram_claims
from teleopdesign.realise.iosystem import to_iosystem
from teleopdesign.simulate import Sampling, simulate

PENDULUM = control.nlsys(
    lambda t, x, u, p: np.array([x[1], (u[0] - 0.3 * x[1] - 4 * np.sin(x[0])) / 0.2]),
    lambda t, x, u, p: x[0],
    inputs=1,
    outputs=1,
    states=2,
)
#: two links that pull at one another
LINKS = control.nlsys(
    lambda t, x, u, p: np.array(
        [
            x[2],
            x[3],
            5 * (u[0] - 0.4 * x[2] - 3 * np.sin(x[0] - x[1])),
            9 * (u[1] - 0.3 * x[3] + 3 * np.sin(x[0] - x[1]) - 20 * x[1] ** 3),
        ]
    ),
    lambda t, x, u, p: x[:2],
    inputs=2,
    outputs=2,
    states=4,
)
LAW = control.tf([-3.0, -8.0], [0.01, 1.0])
PUSH = {"f": 0.5, "r": 0.2, "f1": 0.5, "f2": -0.2}


def held(analog):
    parts, sums = plant_parts(PENDULUM, name="P", motion="x", command="u", driver="f")
    law = Control("K", from_control(LAW), "e", "u", "", analog)
    outside = {"f": "force", "r": "position"}
    error = Junction("e", {"x": 1.0, "r": -1.0})
    return Diagram("pendulum", (*parts, law), (*sums, error), outside, ("x",))


def linked(analog):
    parts, sums = coupled_plant_parts(
        LINKS, name="P", motions=("x1", "x2"), commands=("u1", "u2"), drivers=("f1", "f2")
    )
    law = control.ss([[-50.0]], [[1.0, 0.5]], [[-90.0], [-40.0]], [[-1.0, 0.2], [0.0, -2.0]])
    controls, more = controller_parts(
        law, name="K", inputs=("x1", "x2"), outputs=("u1", "u2"), motion="", analog=analog
    )
    outside = {"f1": "force", "f2": "force"}
    return Diagram("links", (*parts, *controls), (*sums, *more), outside, ("x1", "x2"))


def with_code(analog):
    """Two rods, and a law of two inputs and outputs that is code, with states that it shares."""
    law = control.nlsys(
        lambda t, x, u, p: np.array([30 * (u[0] - x[0]), 20 * (u[1] - x[1]) - 5 * x[0] ** 3]),
        lambda t, x, u, p: np.array([-80 * x[0] - 9 * x[1] ** 3, -60 * x[1] - u[1] - 2 * x[0]]),
        inputs=2,
        outputs=2,
        states=2,
    )
    return two_rods(law, analog)


@pytest.mark.parametrize("made", [held, linked, with_code])
def test_in_a_computer_they_agree_sample_by_sample(made):
    diagram, time = made(False), 1e-3 * np.arange(21)
    forces = {n: PUSH[n] for n in diagram.outside}
    computer = Sampling(period=1e-3)
    simulation = simulate(diagram, duration=0.02, inputs=forces, computer=computer, jit=False)
    system = to_iosystem(diagram, dt=1e-3)
    inputs = [np.full(21, forces[n]) for n in system.input_labels]
    answer = control.input_output_response(system, time, inputs)
    for name in diagram.measured:
        theirs = answer.outputs[system.output_labels.index(name)]
        assert np.abs(simulation[name].values - theirs).max() < 1e-9 * np.ptp(theirs)


@pytest.mark.parametrize(
    "use",
    [
        lambda d: transfer_function(d, output="x", input="f"),
        lambda d: bode(d, frequency=np.array([1.0])),
        lambda d: loop_gain(d, controller="K"),
        lambda d: diagram_claims(d, rng=np.random.default_rng(1)),
    ],
)
def test_nothing_is_derived_of_a_plant_that_is_code(use):
    with pytest.raises(ModelError, match="is a plant known as code only") as caught:
        use(held(False))
    assert "\n" not in str(caught.value)
