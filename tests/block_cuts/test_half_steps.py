"""The force of a hand is read just before the command, and with it the acceleration, steps."""

import numpy as np
import pytest
from block_cuts.interface_simulator import draw_interface, write_case
from block_cuts.teleoperator_simulator import draw_teleoperator, write_teleoperator
from scipy.signal import butter, sosfiltfilt

import teleopdesign as td
from teleopdesign.block_cuts.half_steps import force_at_half_step, share_of_step


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


def test_a_share_is_that_of_the_inertias(case):
    experiment = td.load_experiment(case[0])
    device, hand = (experiment.diagram.block(n).body for n in ("Z_M", "Z_H"))
    masses = [float(b.parameters["inertia"].value) for b in (device, hand)]
    moving, share = share_of_step(experiment, "R_M")
    assert moving.name == "Z_M" and share == pytest.approx(masses[1] / sum(masses))


def test_the_moments_of_a_sensor_that_the_computer_does_not_read_are_not_known(case, tmp_path):
    text = (case[0] / "experiment.toml").read_text()
    for file in case[0].iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    unread = text.replace('column = "f_h",', 'column = "f_h", read_by_computer = false,')
    (tmp_path / "experiment.toml").write_text(unread)
    assert share_of_step(td.load_experiment(tmp_path), "R_M") is None


def test_a_hand_that_is_no_block_of_the_diagram_has_no_known_share(tmp_path):
    random = np.random.default_rng(9)
    write_teleoperator(draw_teleoperator(random), tmp_path, random, durations=(0.6, 0.6))
    experiment = td.load_experiment(tmp_path)
    assert share_of_step(experiment, "F_m") is None
    assert {c.name for c in experiment.cuts.tested} == {"U_m", "U_s", "Z_m", "Z_s"}
