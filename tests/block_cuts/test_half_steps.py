"""The force of a hand is read just before the command, and with it the acceleration, steps."""

import numpy as np
import pytest
from block_cuts.interface_simulator import draw_interface, write_case
from scipy.signal import butter, sosfiltfilt

import teleopdesign as td
from teleopdesign.block_cuts.half_steps import force_at_half_step


@pytest.fixture(scope="module")
def case(tmp_path_factory):
    place, random = tmp_path_factory.mktemp("half") / "steps", np.random.default_rng(8)
    interface = draw_interface(random)
    write_case(interface, place, random, durations=(4.0, 1.5))
    return place, interface.values


def left_of(force, position, values, period=1e-3):
    """Rms of the force that the true hand leaves, below 60 Hz."""
    low = butter(4, 60.0, fs=1.0 / period, output="sos")
    x, f = sosfiltfilt(low, position), sosfiltfilt(low, force)
    v = np.gradient(x, period)
    left = f - values["k_hand"] * x - values["b_hand"] * v
    left -= values["m_hand"] * np.gradient(v, period)
    return np.sqrt(np.mean(left[250:-250] ** 2))


def test_at_half_of_its_step_the_force_is_the_one_that_the_motion_asks_for(case):
    place, values = case
    experiment = td.load_experiment(place)
    log = experiment.logs[0]
    position = experiment.signal("L", log)
    read = left_of(experiment.signal("R_M", log), position, values)
    half = left_of(force_at_half_step(experiment, "R_M", log), position, values)
    # what is left is the noise of the sensor and its jumps where dry friction turns
    assert half < 0.75 * read
