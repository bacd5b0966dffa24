"""A law along recorded rows gives what the simulated computer made there."""

import numpy as np
import pytest
from devices import body

from teleopdesign.controllers import CONTROLLERS, Controller, Stage, controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.realise.controller_along import controller_along
from teleopdesign.simulate import Sampling, Trajectory, simulate

PERIOD, W = 1e-3, 30.0
MOTION = Trajectory(
    lambda t: 0.01 * (1 - np.cos(W * t)),
    lambda t: 0.01 * W * np.sin(W * t),
    lambda t: 0.01 * W**2 * np.cos(W * t),
)


def probe(name):
    law = CONTROLLERS[name]
    values = {n: min(max(2.0, p.lower), p.upper) for n, p in law.parameters.items()}
    return Controller((Stage(law, values),))


LAWS = [n for n in CONTROLLERS if CONTROLLERS[n].takes != "force"]
SOME = ("dahl", "low_pass", "delay", "velocity_schedule")


@pytest.mark.parametrize(
    "name", [n if n in SOME else pytest.param(n, marks=pytest.mark.slow) for n in LAWS]
)
def test_every_law_along_the_readings_is_the_law_of_the_simulation(name):
    block = probe(name)
    if name == "delay":
        block = controller("delay", {"time": 2.5e-3})
    run = simulate(
        haptic_interface(body(0.1), cancellation=block),
        duration=0.1,
        motion={"L": MOTION},
        computer=Sampling(period=PERIOD),
        step=PERIOD,
        jit=False,
    )
    x = np.asarray(run["L"].values)
    v = np.diff(x, prepend=x[:1]) / PERIOD
    made = controller_along(block, input=x, velocity=v, travel_rate=v, period=PERIOD)
    expected = np.asarray(run["R_MBC"].values)
    # rounding, and the order of sums
    assert np.abs(made - expected).max() < 1e-9 * (1.0 + np.ptp(expected))
