"""Diagrams whose equations have no solution at their values, and forces that many parts use."""

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.base.errors import GrowsWithoutBound, ModelError
from teleopdesign.diagrams import Control, Diagram, Junction, Moving
from teleopdesign.frequency import bode, transfer_function

BODY = td.Body("prismatic", {"inertia": 0.2}).with_effect(td.EFFECTS["viscous"], {"damping": 3.0})
NOTHING = BODY.with_values({"inertia": 0.0})
MASSLESS = "nothing on L has inertia, .* Z_M.inertia must be more than 0"


def pushed_and_read(law, *, analog=False):
    """The force f pushes the body and is an input of the computer, too."""
    parts = (
        Moving("M", BODY, "x", "u", {"f": 1}, "f"),
        Control("G", law, "w", "F", analog=analog),
    )
    sums = (Junction("w", {"F": 1, "f": 1}), Junction("u", {"F": 1}))
    return Diagram("pushed and read", parts, sums, {"f": "force"}, ("x",))


@pytest.mark.parametrize("computer", [td.Sampling(), "continuous"])
def test_a_device_without_mass_is_not_called_an_unstable_loop(computer):
    """The growth of a motion was infinite there, so a study counted it as unstable."""
    device = td.haptic_interface(NOTHING)
    with pytest.raises(ModelError, match=MASSLESS) as caught:
        td.simulate_diagram(
            device, duration=0.02, inputs={"R_D": 1.0}, computer=computer, jit=False
        )
    assert not isinstance(caught.value, GrowsWithoutBound)


def test_a_mass_of_the_hand_is_enough():
    held = td.haptic_interface(NOTHING, hand=td.hand(mass=0.2, damping=0.0, stiffness=0.0))
    alone = td.haptic_interface(BODY)
    moved = [
        td.simulate_diagram(d, duration=0.02, inputs={"R_D": 1.0}, jit=False)["L"].values
        for d in (held, alone)
    ]
    assert np.allclose(*moved, rtol=1e-9)


def test_a_prescribed_motion_needs_no_mass():
    motion = {"L": td.sine(amplitude=0.01, frequency=2.0)}
    run = td.simulate_diagram(td.haptic_interface(NOTHING), duration=0.02, motion=motion, jit=False)
    assert np.allclose(run["R_V"], 3.0 * run["L_velocity"])


def test_one_case_without_mass_leaves_the_others_alone():
    masses = [0.0, 0.2, 0.4]
    run = td.simulate_many(
        td.haptic_interface(BODY), {"Z_M.inertia": masses}, duration=0.02, inputs={"R_D": 1.0}
    )
    assert "nothing on L has inertia" in str(run["reason"].values[0])
    assert list(run["reason"].values[1:]) == ["", ""]


def test_a_loop_without_delay_has_no_solution_at_gain_one():
    """Its Bode plot ended in a KeyError, its system in a TypeError."""
    loop = pushed_and_read(td.controller("gain", {"gain": 1.0}))
    with pytest.raises(ModelError, match="no finite numbers at the start: a loop without delay"):
        td.simulate_diagram(loop, duration=0.02, inputs={"f": 1.0}, jit=False)
    for response in (bode, transfer_function):
        with pytest.raises(ModelError, match="x/f: a loop has no solution at these values"):
            response(loop, output="x", input="f")


@pytest.mark.parametrize("analog", [False, True])
@pytest.mark.parametrize(
    "law",
    [
        td.controller("gain", {"gain": 0.5}),
        td.controller("low_pass", {"bandwidth": 5.0}).then(td.controller("gain", {"gain": 0.5})),
    ],
)
def test_a_force_that_the_computer_reads_still_pushes_the_body(law, analog):
    """The compiler refused it: the force was an input of the computer only."""
    loop = pushed_and_read(law, analog=analog)
    inputs = {"f": lambda t: np.sin(40 * t)}
    fine = td.Sampling(period=1e-4)
    runs = [
        td.simulate_diagram(loop, duration=0.02, inputs=inputs, computer=computer, jit=False)
        for computer in (fine, "continuous")
    ]
    sampled, continuous = (float(run["x"][-1]) for run in runs)
    assert sampled == pytest.approx(continuous, rel=2e-2)
