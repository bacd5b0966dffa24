"""Energy tanks at both ends of a channel, against random channels, late and lossy."""

import numpy as np
import pytest
from devices import body
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller
from teleopdesign.diagrams import energy_tanks, four_channel, teleoperator
from teleopdesign.simulate import Sampling, simulate, sine

PERIOD, RESERVE, TRAVEL = 1e-3, 0.02, 2e-3
SPRING = {"stiffness": 400.0, "damping": 5.0, "bandwidth": 100.0}


def channel(delay, share, seed):
    lost = controller("lossy_hold", {"share": share, "seed": seed})
    return controller("delay", {"time": delay}).then(lost)


def position_force(*, delay, share, seed, gain=1.5):
    """Positions to the slave and force back, all of it late and lost: anything but passive."""
    spring = controller("proportional_derivative", SPRING)
    sides = body(0.3, viscous__damping=1.0), body(0.3, viscous__damping=1.0)
    back = controller("gain", {"gain": gain})
    return four_channel(
        *sides,
        master_control=None,
        slave_control=spring,
        channels={
            "C_1": channel(delay, share, seed).then(spring),
            "C_2": channel(delay, share, 1 - seed).then(back),
        },
        hand=body(0.0, spring__stiffness=50.0, viscous__damping=2.0),
        environment=body(0.0, spring__stiffness=300.0),
    )


def tanked(*, delay, share, seed):
    return energy_tanks(
        position_force(delay=delay, share=share, seed=seed),
        reserve=RESERVE,
        travel=TRAVEL,
        to_first=channel(delay, share, seed / 2),
        to_second=channel(delay, share, 1 - seed / 2),
    )


def moved(diagram, push, duration=1.5, **arguments):
    return simulate(
        diagram,
        duration=duration,
        inputs={"F_u": push},
        computer=Sampling(period=PERIOD, velocity="difference"),
        step=PERIOD,
        **arguments,
    )


def given_out(simulation):
    """Energy (J) that both commands gave to their bodies, held over each travel, at each sample."""
    total = 0.0
    for side in "ms":
        force, position = simulation[f"U_{side}"].values, simulation[f"X_{side}"].values
        total = total + np.cumsum(force[:-1] * np.diff(position))
    return total


def largest_travel(simulation):
    return max(np.abs(np.diff(simulation[f"X_{x}"].values)).max() for x in "ms")


def push(t):
    return 3.0 * np.sin(5 * t) * (t < 1.0)


def check_a_run(*, delay, share, seed, **arguments):
    simulation = moved(tanked(delay=delay, share=share, seed=seed), push, **arguments)
    assert largest_travel(simulation) <= TRAVEL
    assert given_out(simulation).max() <= 2 * RESERVE * (1 + 1e-9)
    for name, other in (("Z_m", "Z_s"), ("Z_s", "Z_m")):
        arrived, intake = (simulation[n].values for n in (f"arrived_{name}", f"taken_{other}"))
        assert np.all(arrived <= intake + 1e-12)
        assert np.all(simulation[f"tank_{name}"].values >= -RESERVE - 1e-9)
    return simulation


@pytest.mark.slow
@settings(max_examples=25)
@given(delay=st.floats(1e-3, 0.08), share=st.floats(0.0, 0.95), seed=st.floats(0.01, 0.99))
def test_no_channel_makes_both_ends_give_out_more_than_their_reserves(delay, share, seed):
    """Any delay, between samples as well, and any share of lost samples."""
    check_a_run(delay=delay, share=share, seed=seed, duration=1.0, jit=False)


def test_the_count_of_a_held_force_is_its_work_exactly():
    """Trapezia would count the force of the next sample; the held one acts along the travel."""
    spring = controller("spring_damper", {"stiffness": 200.0, "damping": 0.0})
    sides = body(0.3), body(0.3)
    diagram = energy_tanks(teleoperator(*sides, coupling=spring), reserve=10.0, travel=TRAVEL)
    simulation = simulate(
        diagram,
        duration=0.3,
        motion={"X_m": sine(amplitude=0.01, frequency=7.0)},
        computer=Sampling(period=PERIOD),
        step=PERIOD,
        jit=False,
    )
    for side in "ms":
        force, position = simulation[f"U_{side}"].values, simulation[f"X_{side}"].values
        work = np.concatenate([[0], force[:-1] * np.diff(position)])
        for name, sign in (("given", 1), ("taken", -1)):
            counted = simulation[f"{name}_Z_{side}"].values
            np.testing.assert_allclose(counted, np.maximum(sign * work, 0).cumsum(), atol=1e-12)


def test_a_second_tank_or_no_body_is_reported_in_one_line():
    made = energy_tanks(teleoperator(), reserve=1.0, travel=1.0)
    with pytest.raises(ModelError, match="has an energy tank already"):
        energy_tanks(made, reserve=1.0, travel=1.0)
    with pytest.raises(ModelError, match="no body that forces move"):
        energy_tanks(teleoperator(), reserve=1.0, travel=1.0, ends=("Z_m", "P"))
