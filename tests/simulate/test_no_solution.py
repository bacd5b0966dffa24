"""Diagrams whose equations have no solution at their values, and forces that many parts use."""

import numpy as np
import pytest
from devices import body

import teleopdesign as td
from teleopdesign.base.errors import GrowsWithoutBound, ModelError
from teleopdesign.controllers import controller
from teleopdesign.diagrams import Control, Diagram, Junction, Moving, haptic_interface
from teleopdesign.frequency import bode, transfer_function
from teleopdesign.simulate import Sampling, simulate, sine

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


MOTION = {"L": sine(amplitude=0.01, frequency=5.0)}


def device(half_difference):
    return haptic_interface(
        body(0.1, coulomb__level=0.5, coulomb_asymmetry__half_difference=half_difference)
    )


@pytest.mark.parametrize(("half_difference", "way"), [(0.6, "backward"), (-0.6, "forward")])
def test_a_level_below_zero_is_refused_with_its_direction(half_difference, way):
    """It was simulated: 1e35 N after 4 ms, which is finite."""
    with pytest.raises(ModelError, match=f"Z_M: friction of -0.1 N {way} .*no less than 0"):
        simulate(device(half_difference), duration=0.01, motion=MOTION, jit=False)


def test_a_level_that_falls_below_zero_in_fast_sliding_alone_is_refused():
    slippery = body(
        0.1,
        coulomb__level=0.5,
        stribeck__extra_static_level=0.3,
        stribeck__stribeck_velocity=0.01,
        coulomb_asymmetry__half_difference=0.6,
    )
    with pytest.raises(ModelError, match="friction of -0.1 N backward"):
        simulate(haptic_interface(slippery), duration=0.01, motion=MOTION, jit=False)


def test_a_level_of_zero_one_way_is_simulated():
    simulation = simulate(device(0.5), duration=0.01, motion=MOTION, jit=False)
    assert np.isfinite(simulation["R_V"].values).all()


PERIOD = 1e-3


def test_a_command_is_held_for_a_period():
    """A spring as the position loop of a device that is led: each command is the spring's force at
    the last sample.
    """
    law = controller("gain", {"gain": 1000.0})
    diagram = haptic_interface(body(), position_loop=law)
    motion = sine(amplitude=0.01, frequency=2.0)
    simulation = simulate(
        diagram,
        duration=0.1,
        motion={"L": motion},
        computer=Sampling(period=PERIOD),
        every_step=True,
        jit=False,
    )
    time = simulation["time"].values
    middles = (time / PERIOD) % 1.0
    rows = (middles > 0.2) & (middles < 0.8) & (time > 3 * PERIOD)  # away from the changes
    sample = np.floor(time[rows] / PERIOD) * PERIOD
    expected = -1000.0 * motion.position(sample)
    assert rows.sum() > 100
    # the held command is exact; what remains is the rounding of times
    assert simulation["R_D"].values[rows] == pytest.approx(expected, abs=1e-9)
