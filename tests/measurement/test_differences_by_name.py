"""Columns whose names say that they are the error of a controller: neither position nor force."""

import numpy as np
import pytest

from teleopdesign.measurement.column_names import is_difference
from teleopdesign.measurement.doors.arrays import open_arrays
from teleopdesign.measurement.survey import Choices, survey_log

T = np.arange(4000) / 1000.0
Q = 0.5 * np.sin(2 * np.pi * 0.4 * T) + 0.1 * np.sin(2 * np.pi * 1.7 * T)
V = np.gradient(Q, T)
U = 0.01 * np.gradient(V, T) + 0.1 * np.sign(V)
ERROR = 0.5 * np.sin(2 * np.pi * 0.4 * (T + 0.03)) + 0.1 * np.sin(2 * np.pi * 1.7 * (T + 0.03)) - Q


def survey(tmp_path, **columns):
    path = tmp_path / "log.npz"
    np.savez(path, time=T, **columns)
    return survey_log(open_arrays(path, "log.npz"), "log.npz", Choices(axis="revolute"))


@pytest.mark.parametrize(
    "name", ["q_err", "position_error", "Error Position", "Schleppfehler", "deviation", "位置误差"]
)
def test_a_name_of_a_difference_is_known(name):
    assert is_difference(name)


@pytest.mark.parametrize("name", ["q", "position", "ferry", "mirror_angle", "terrain", "erratum"])
def test_a_name_of_anything_else_is_none(name):
    assert not is_difference(name)


def test_an_error_is_not_the_position_beside_a_name_that_says_less(tmp_path):
    proposal = survey(tmp_path, q_err=ERROR, qm=Q, tau=U)
    assert proposal.channels["position"]["column"] == "qm"
    assert proposal.unused["q_err"] == "by its name a difference, such as the error of a controller"


def test_an_error_does_not_make_the_position_a_guess(tmp_path):
    proposal = survey(tmp_path, Position=Q, tau=U, **{"Error Position": ERROR})
    assert proposal.channels["position"]["column"] == "Position"
    assert "channels.position.column" not in proposal.guesses


def test_the_error_of_a_torque_is_not_the_torque(tmp_path):
    noise = np.random.default_rng(2).standard_normal(len(T))
    proposal = survey(tmp_path, angle=Q, torque_error=0.005 * noise + 0.05 * U, tau=U)
    assert proposal.channels["actuator_force"]["column"] == "tau"
    assert "channels.actuator_force.column" not in proposal.guesses


def test_the_error_of_a_position_loop_is_no_velocity(tmp_path):
    """It is nearly in proportion to the speed of the position."""
    proposal = survey(tmp_path, q=Q, tau=U, position_error=ERROR)
    assert not proposal.notes and "difference" in proposal.unused["position_error"]


def test_an_error_alone_stays_the_position(tmp_path):
    proposal = survey(tmp_path, q_err=Q, tau=U)
    assert proposal.channels["position"]["column"] == "q_err"
