"""What a survey asks of single columns: units, clocks, likely others, currents that acted."""

import numpy as np
import pytest
from measurement.columns_by_hand import Q, T, U, log_of, look

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.survey import Choices, survey_logs
from teleopdesign.measurement.survey.balance import (
    current_that_acted,
)
from teleopdesign.measurement.survey.content import (
    SurveyedColumn,
)


def column(name, values, unit=None):
    return SurveyedColumn(name, np.asarray(values, dtype=float), np.asarray(values), unit)


RNG = np.random.default_rng(0)
WANTED = np.cumsum(RNG.standard_normal(4000)) / 20.0


def acted(measured, wanted=WANTED, names=("i_cmd_A", "i_meas_A"), unit="A", more=()):
    columns = [column(names[0], wanted, unit), column(names[1], measured, unit), *more]
    by_name = {c.name: c for c in columns}
    return current_that_acted(names[0], by_name, dict.fromkeys(by_name, 1.0) | {"other_A": 0.5})


@pytest.mark.parametrize("late", [0, 1, 4])
@pytest.mark.parametrize("factor", [1.0, -0.3])
def test_a_drive_that_follows_its_command_is_taken_at_its_word(late, factor):
    """Late by up to four rows, smoothed, with another scale, an offset and noise of each row."""
    follows = factor * np.r_[np.full(late, WANTED[0]), WANTED[: len(WANTED) - late]] + 0.4
    assert acted(follows) is None
    smooth = np.convolve(follows, [0.5, 0.3, 0.2], "full")[: len(follows)]
    assert late > 2 or acted(smooth[10:], WANTED[10:]) is None
    assert acted(follows + 0.3 * np.std(follows) * RNG.standard_normal(4000)) is None


@pytest.mark.parametrize(("share", "differs"), [(0.05, False), (0.2, True), (1.0, True)])
def test_a_current_that_a_drive_limits_or_adds_to_is_the_force_that_acted(share, differs):
    """Something else is added, slower than rows: its part of the whole is what is reported."""
    other = np.sin(0.02 * np.arange(4000.0))
    other -= other.mean()
    spread = np.std(WANTED) / np.std(other)
    result = acted(WANTED + share * spread * other)
    assert (result is not None) == differs
    if result is not None:
        name, part = result
        assert name == "i_meas_A"
        assert part == pytest.approx(share / np.hypot(1.0, share), rel=0.3)


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
