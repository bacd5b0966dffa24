"""Nonlinear python-control systems as controllers: in simulations, and never left out unsaid."""

import control
import numpy as np
import pytest
from devices import body

from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller, from_control
from teleopdesign.derive import transfer_function
from teleopdesign.diagrams import Control, Diagram, Junction, Moving, haptic_interface
from teleopdesign.frequency import delay_margin, loop_gain
from teleopdesign.passivity import diagram_claims
from teleopdesign.realise.iosystem import to_iosystem
from teleopdesign.simulate import simulate, sine

MOTION = {"L": sine(amplitude=0.01, frequency=3.0)}


def cubic(**options):
    """A spring that hardens, on its own state: dx/dt = 50 (u - x), y = -9e5 x^3."""
    return control.nlsys(
        lambda t, x, u, p: 50 * (u - x),
        lambda t, x, u, p: -9e5 * x**3,
        inputs=1,
        outputs=1,
        states=1,
        name="cubic",
        **options,
    )


def along(made, **arguments):
    diagram = haptic_interface(body(0.1), cancellation=made)
    return simulate(diagram, **{"duration": 0.1, "motion": MOTION, "step": 1e-3} | arguments)


@pytest.mark.slow
def test_an_analog_system_is_the_same_through_the_kernel_and_through_python_control():
    """1e-6 of the range: two integrators at tight tolerances."""
    device = body(0.15, viscous__damping=2.0)
    diagram = haptic_interface(device, cancellation=from_control(cubic()), analog=("C",))
    time = np.linspace(0, 0.2, 201)
    push = 2.0 * np.sin(30.0 * time)  # straight lines between these times in both
    simulation = simulate(
        diagram,
        duration=0.2,
        inputs={"R_V": lambda t: np.interp(t, time, push)},
        computer="continuous",
        step=2e-4,
    )
    system = to_iosystem(diagram)
    answer = control.input_output_response(
        system,
        time,
        [push * (n == "R_V") for n in system.input_labels],
        solve_ivp_kwargs={"rtol": 1e-10, "atol": 1e-14, "max_step": 5e-4},
    )
    theirs = answer.outputs[system.output_labels.index("L")]
    assert np.abs(simulation["L"].values - theirs).max() < 1e-6 * np.ptp(theirs)
    assert "plain Python" in simulation.data.attrs["scheme"]


@pytest.mark.parametrize("dt", [1e-3, True])
def test_a_discrete_system_is_stepped_as_python_control_steps_it(dt):
    """An integrator that saturates, with a gain that follows time: to rounding."""
    saturated = control.nlsys(
        lambda t, x, u, p: np.clip(x + 0.2 * u, -4e-3, 4e-3),
        lambda t, x, u, p: 100.0 * x * (1.0 + 5.0 * t) + u**3,
        inputs=1,
        outputs=1,
        states=1,
        dt=dt,
    )
    forces = along(from_control(saturated))
    time, u = forces["time"].values, forces["L"].values
    x, expected = 0.0, []
    for t, value in zip(time, u, strict=True):
        expected.append(100.0 * x * (1.0 + 5.0 * t) + value**3)
        x = float(np.clip(x + 0.2 * value, -4e-3, 4e-3))
    np.testing.assert_allclose(forces["R_MBC"].values, expected, rtol=0, atol=1e-15)


def behind_a_sum(made):
    """A rod that follows a reference: the law reads the difference, which the computer makes."""
    return Diagram(
        "behind a sum",
        (
            Moving("M", body(0.2, viscous__damping=4.0), "x", "u", {"f": 1}, "f"),
            Control("K", made, "e", "u", "x"),
        ),
        (Junction("e", {"r": 1, "x": -1}),),
        {"f": "force", "r": "position"},
        measured=("x",),
    )


def test_a_system_in_a_loop_without_delay_through_itself_is_refused():
    """What it gives stands in the sum that it reads: no state between."""
    times = control.nlsys(None, lambda t, x, u, p: 40.0 * u, inputs=1, outputs=1)
    open_loop = behind_a_sum(from_control(times))
    sums = (Junction("e", {"r": 1, "x": -1, "u": 0.1}),)
    diagram = Diagram("loop", open_loop.blocks, sums, open_loop.outside, measured=("x",))
    with pytest.raises(ModelError, match="loop: e enters an equation other than linearly"):
        simulate(diagram, duration=0.01, jit=False)


def test_no_claim_and_no_margin_leaves_it_out_unsaid():
    held = body(0.05, viscous__damping=3.0, spring__stiffness=400.0)
    feedback = controller("low_pass", {"bandwidth": 20.0})
    diagram = haptic_interface(
        body(0.1, viscous__damping=2.0),
        hand=held,
        cancellation=from_control(cubic()),
        force_feedback=feedback,
    )
    _, left_out = transfer_function(diagram)
    assert left_out == ("C",)
    with pytest.raises(ModelError, match=r"C \(state_space\) has no linear form"):
        loop_gain(diagram, controller="C")
    assert loop_gain(diagram, controller="H").left_out == ("C",)
    with pytest.raises(ModelError, match="loop: C has no linear form"):
        delay_margin(loop_gain(diagram, controller="H"))
    claims = diagram_claims(diagram, rng=np.random.default_rng(1))
    assert "C" in claims.nonlinear
    whole = [one for one in claims.claims if "port" in one.topic]
    assert whole
    for one in whole:
        assert one.claim.status == "unknown"
        assert "C is known as code only" in str(one.claim.verdict)
