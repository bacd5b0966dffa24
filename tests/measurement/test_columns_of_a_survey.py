"""What a survey asks of single columns: units, clocks, likely others, currents that acted."""

import numpy as np
import pytest
from measurement.columns_by_hand import Q, T, U, look

from teleopdesign.measurement.survey.balance import (
    current_that_acted,
)
from teleopdesign.measurement.survey.content import (
    AS_LIKELY,
    SurveyedColumn,
    as_likely,
    explain_ambiguity,
    is_unit_of,
    moves,
    reasons,
    rises,
)
from teleopdesign.measurement.survey.words import says


@pytest.mark.parametrize(
    ("unit", "quantities"),
    [
        ("rad", {"position"}),
        ("mm", {"position"}),
        ("counts", {"position"}),
        ("rad/s", {"velocity"}),
        ("m/s", {"velocity"}),
        ("N", {"force"}),
        ("N*m", {"force"}),
        ("A", {"force"}),
        ("mA", {"force"}),
        ("V", {"force"}),
        ("ms", {"time"}),
        ("degC", set()),
        (None, set()),
    ],
)
def test_a_unit_is_that_of_one_quantity_on_either_axis(unit, quantities):
    every = ("position", "velocity", "force", "time")
    assert {q for q in every if is_unit_of(unit, q)} == quantities


def test_a_clock_rises_in_nearly_every_row_and_in_most_of_them_truly():
    t = np.arange(1000.0)
    assert rises(t) and not rises(-t) and not rises(np.ones(100))
    assert rises(np.r_[np.nan, t, np.nan]) and not rises(t[:2]) and rises(t[:3])
    assert rises(np.repeat(t, 2)[:-1]) is False  # half of the rows share a stamp
    assert rises(np.sort(np.r_[t, t[:990]]))  # a little fewer
    back = t.copy()
    back[100::150] -= 2.0  # six steps back in a thousand
    assert rises(back)
    back[100::60] -= 2.0
    assert not rises(back)


def test_columns_almost_as_likely_as_the_best_are_named():
    scores = {"a": 1.0, "b": 1.0 - 0.9 * AS_LIKELY, "c": 1.0 - 1.1 * AS_LIKELY, "d": 1.0}
    assert as_likely(scores, "a") == ["b", "d"]
    assert as_likely({"a": 1.0}, "a") == []
    few = explain_ambiguity("q", ["a", "b", "c"], "the position")
    assert few == "'q' is read as the position: 'a', 'b', 'c' may be the position as well"
    assert "'a', 'b', 'c', ... may be" in explain_ambiguity("q", ["a", "b", "c", "d"], "it")


def test_the_first_three_columns_without_numbers_are_named_with_their_reason():
    assert reasons({}) == ""
    unread = {n: "texts" for n in "abcd"}
    assert reasons(dict(list(unread.items())[:3])) == (
        "; not read as numbers: 'a': texts; 'b': texts; 'c': texts"
    )
    assert reasons(unread).endswith("'c': texts; ...")
    assert reasons(unread, most=4).endswith("'d': texts")


def column(name, values, unit=None):
    return SurveyedColumn(name, np.asarray(values, dtype=float), np.asarray(values), unit)


def test_a_column_moves_where_two_values_differ():
    assert moves(column("x", [1.0, 1.0, 1.1])) and not moves(column("x", [1.0, 1.0]))


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


def test_only_a_measured_current_stands_for_a_command():
    other = np.sin(0.02 * np.arange(4000.0))
    assert acted(other) is not None
    assert acted(other, names=("i_A", "i_meas_A")) is None  # the first is no command
    assert acted(other, names=("i_cmd_A", "i_ref_A")) is None  # the second is one, too
    assert acted(other, names=("i_cmd_A", "temperature")) is None
    assert acted(np.ones(4000)) is None and acted(other[:8], WANTED[:8]) is None
    torque = column("torque_meas_Nm", other, "N*m")
    assert acted(WANTED, more=[torque]) is None


@pytest.mark.parametrize(
    ("name", "current", "torque"),
    [
        ("i_A", True, False),
        ("Motorstrom", True, False),
        ("motor_current", True, False),
        ("iq", True, False),
        ("电机电流", True, False),
        ("torque", False, True),
        ("Drehmoment", False, True),
        ("Antriebsmoment", False, True),
        ("tau_1", False, True),
        ("torque_current", True, False),
        ("position", False, False),
        ("init", False, False),
        ("octau", False, False),
    ],
)
def test_a_name_suggests_a_current_or_a_torque_and_never_both(name, current, torque):
    assert says(name, "current") is current
    assert (says(name, "torque") and not says(name, "current")) is torque


def test_with_position_force_and_hand_stated_there_is_no_guess():
    columns = {"t_s": T, "a": Q, "b": U, "c": np.roll(Q, 3), "d": np.cos(T)}
    stated = {"position": "a", "actuator_force": "b", "interaction_force": "none"}
    survey = look(columns, **stated)
    assert not survey.explained and not survey.relations
    assert set(survey.unused) == {"c", "d"}
    assert not [key for key in survey.guesses if key.endswith(".column")]
    other = look(columns, position="a", actuator_force="b")
    assert other.explained or other.relations
