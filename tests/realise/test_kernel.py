"""The compiled kernel: accuracy, the guard of its step, sampling, and what it refuses."""

import numpy as np
import pytest
from devices import CANCELLATION, FEEDBACK, LUGRE, body
from scipy.integrate import solve_ivp

from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface, world_haptics_2005
from teleopdesign.simulate import Sampling, prepare, simulate, sine

REFERENCE = sine(amplitude=0.01, frequency=1.5)


def hand_written(t, y):
    """The fixture `hybrid` in continuous time, written down by hand: an independent statement."""
    x, v, z, w, memory = y
    level = 0.5 + 0.1 * np.exp(-((v / 0.005) ** 2))
    error = 0.01 * np.sin(3 * np.pi * t) - x
    desired = 2e4 * (error + memory)
    acting = desired + w + 0.5 * v / (0.015 + abs(v))
    acceleration = (acting - 1e5 * z - 0.1 * v) / 0.65
    force_error = desired - 0.5 * acceleration
    return [
        v,
        acceleration,
        v - 1e5 / level * abs(v) * z,
        2 * np.pi * 20 * (0.4 / (0.08 + abs(v)) * force_error - w),
        -98 * np.pi * error - 100 * np.pi * memory,
    ]


@pytest.fixture(scope="module")
def radau():
    """Two reversals of the friction, one of the reference: 0.25 s, started at rest."""
    time = 1e-3 * np.arange(251)
    start = [0.0] * 5
    return solve_ivp(hand_written, (0, 0.25), start, "Radau", time, rtol=1e-10, atol=1e-13).y


def test_force_is_within_1e_4_and_position_within_1e_6_of_radau(hybrid, radau):
    """Default step; the bounds are those asked of a kernel for figures of a paper."""
    simulation = simulate(
        hybrid, duration=0.25, inputs={"L_D": REFERENCE.position}, computer="continuous"
    )
    force = simulation["Z_M_friction"].values
    assert simulation.data.attrs["step_s"] == pytest.approx(1e-4)
    assert np.abs(force - 1e5 * radau[2]).max() < 1e-4 * np.abs(force).max()
    assert np.abs(simulation["L"].values - radau[0]).max() < 1e-6 * np.abs(radau[0]).max()


@pytest.mark.parametrize("step", [1e-3, 5e-4])
def test_a_step_too_long_for_the_bristle_is_refined(hybrid, radau, step):
    """At 1 ms the unguarded force is wrong by 5e-3; refined it keeps its bound."""
    simulation = simulate(
        hybrid, duration=0.25, inputs={"L_D": REFERENCE.position}, computer="continuous", step=step
    )
    assert simulation.data.attrs["step_s"] < 3e-4
    error = np.abs(simulation["Z_M_friction"].values - 1e5 * radau[2]).max()
    assert error < 2e-4 * 1e5 * np.abs(radau[2]).max()  # 10 steps a reload: 1e-4 at 14 steps


def test_the_error_falls_with_the_step(hybrid, radau):
    """At kinks of abs(v) in the laws the order is below four; between 1e-4 and 2e-5 s above one."""
    made = prepare(hybrid, duration=0.25, inputs={"L_D": REFERENCE.position}, computer="continuous")
    column = made.program.layout.columns.index("Z_M_friction")
    errors = []
    for inner in (10, 50):
        rows, _ = made.run(made.timing(inner))
        errors.append(np.abs(rows[:, column] - 1e5 * radau[2]).max())
    assert errors[1] < errors[0] / 5


def test_compiled_and_plain_code_give_the_same_numbers(hybrid):
    arguments = dict(duration=0.02, inputs={"L_D": REFERENCE.position}, computer="continuous")
    fast, plain = (simulate(hybrid, jit=jit, **arguments).data for jit in (True, False))
    for name in fast:
        # rounding only: the compiler may contract and reorder
        np.testing.assert_allclose(fast[name], plain[name], rtol=1e-9, atol=1e-12)


def moved(**sampling):
    """Commanded cancellation for a prescribed motion."""
    diagram = haptic_interface(body(0.1), cancellation=CANCELLATION)
    return simulate(
        diagram,
        duration=0.1,
        motion={"L": REFERENCE},
        computer=Sampling(**sampling),
        every_step=True,
        jit=False,
    )


def test_the_command_is_held_and_acts_after_the_delay():
    at_once, late = moved(), moved(delay=3e-4)
    force = at_once["R_M"] + 0.1 * at_once["L_acceleration"]  # = acting force
    delayed = late["R_M"] + 0.1 * late["L_acceleration"]
    inside = np.arange(len(force)) % 10
    kept = inside[:-3] != 0  # rows at samples still show the force before
    np.testing.assert_allclose(delayed[3:][kept], force[:-3][kept], atol=1e-12)
    changes = np.abs(np.diff(force)) > 1e-9
    assert set(inside[:-1][changes]) == {0}


def test_velocity_is_the_filtered_difference_of_encoder_steps():
    step, period = 1e-4, 1e-3
    simulation = moved(encoder_step=step, velocity_bandwidth=50.0)
    x = np.floor(simulation["L"].values[::10] / step + 0.5) * step
    keep, v, forces = np.exp(-2 * np.pi * 50 * period), 3 * np.pi * 0.01, []
    for n in range(len(x)):
        v = v if n == 0 else keep * v + (1 - keep) * (x[n] - x[n - 1]) / period
        forces.append(0.5 * v / (0.015 + abs(v)))
    np.testing.assert_allclose(simulation["R_MBC"].values[::10], forces, atol=1e-12)


def test_a_delay_that_is_no_whole_number_of_steps_is_refused():
    with pytest.raises(ModelError, match="no whole number of steps"):
        moved(delay=1.37e-4)


def test_force_feedback_may_be_analog_beside_a_sampled_cancellation():
    diagram = world_haptics_2005()
    simulation = simulate(
        diagram, duration=0.02, motion={"L": REFERENCE}, every_step=True, jit=False
    )
    changes = np.abs(np.diff(simulation["R_FF"].values)) > 0
    held = np.abs(np.diff(simulation["R_MBC"].values)) > 0
    assert changes.sum() > 150 and held.sum() <= 20


def test_an_unstable_loop_is_no_result():
    wild = controller("lead", {"gain": 1e8, "zero": 1.0, "pole": 2.0})
    diagram = haptic_interface(body(0.1), position_loop=wild)
    with pytest.raises(ModelError, match="grow beyond all bounds"):
        simulate(diagram, duration=1.0, inputs={"L_D": 1.0}, jit=False, step=1e-3)


def test_fast_sliding_does_not_overflow_the_stribeck_level():
    """At 60 times the Stribeck velocity exp(-(v/v_S)^2) is 0, and was once written 1/inf."""
    moved = sine(amplitude=0.01, frequency=5.0)
    simulation = simulate(
        haptic_interface(body(**LUGRE)), duration=0.1, motion={"L": moved}, jit=False
    )
    assert np.abs(simulation["Z_M_friction"]).max() < 0.56


def test_dahl_cancellation_is_sampled_exactly_in_a_closed_loop():
    """The sampled bristle stays within its level also when positions jump by encoder steps."""
    dahl = controller("dahl", {"level": 0.4, "stiffness": 2e4})
    diagram = haptic_interface(
        body(**LUGRE), hand=body(0.5), cancellation=dahl, force_feedback=FEEDBACK
    )
    simulation = simulate(
        diagram,
        duration=0.2,
        inputs={"R_D": lambda t: 2 * np.sin(2 * np.pi * 5 * t)},
        computer=Sampling(encoder_step=2e-5, delay=1e-3),
        jit=False,
    )
    assert 0.3 < np.abs(simulation["R_MBC"]).max() <= 0.4 * (1 + 1e-12)


def test_a_simulation_that_would_fill_the_memory_is_refused():
    with pytest.raises(ModelError, match=r"1e\+09 steps of 0.0001 s need .* GB: use a longer"):
        simulate(haptic_interface(body(0.1)), duration=1e5, inputs={"R_D": 0.0}, jit=False)
