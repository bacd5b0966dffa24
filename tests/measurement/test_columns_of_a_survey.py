"""Which columns a survey asks about, and which it takes for a force."""

import numpy as np
import pytest
from measurement.columns_by_hand import Q, T, U, log_of, look

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.survey import Choices, survey_logs

RNG = np.random.default_rng(0)


def test_with_position_force_and_hand_stated_there_is_no_guess():
    columns = {"t_s": T, "a": Q, "b": U, "c": np.roll(Q, 3), "d": np.cos(T)}
    stated = {"position": "a", "actuator_force": "b", "interaction_force": "none"}
    survey = look(columns, **stated)
    assert not survey.explained and not survey.relations
    assert set(survey.unused) == {"c", "d"}
    assert not [key for key in survey.guesses if key.endswith(".column")]
    other = look(columns, position="a", actuator_force="b")
    assert other.explained or other.relations


def test_a_log_in_which_the_command_rests_leaves_the_roles_to_the_next_one():
    """A run at one command tells no force by its motion; that of a later run does."""
    columns = {"t_s": T, "ch1": Q, "ch2": U}
    rests = columns | {"ch1": 0.1 * np.sin(T), "ch2": np.full(len(T), 0.3)}
    with pytest.raises(ExperimentError, match="force"):
        look(rests, axis="revolute")
    logs = [log_of(rests), log_of(columns)]
    survey = survey_logs(logs, ["rests", "moves"], Choices(axis="revolute"))
    assert survey.channels["actuator_force"]["column"] == "ch2"


def test_a_second_reading_of_the_position_is_no_force_and_a_torque_is():
    """A slider on a crank is a function of the motor's angle; it leaves nothing to a motion."""
    noise = 1e-3 * RNG.standard_normal((3, len(T)))
    slider = 0.05 * (np.sin(0.8 * Q) + noise[0])
    with pytest.raises(ExperimentError, match="second position"):
        look({"t_s": T, "ch1": Q + noise[1], "ch2": slider})
    survey = look({"t_s": T, "ch1": Q + noise[1], "ch2": slider, "ch3": U + noise[2]})
    assert survey.channels["actuator_force"]["column"] == "ch3"
