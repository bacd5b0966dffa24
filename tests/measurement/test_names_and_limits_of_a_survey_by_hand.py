"""Names, units and limits of a survey, each rule with columns that are written here."""

import numpy as np
import pytest
from measurement.columns_by_hand import Q, T, U, V, column, look

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.first_guess import FirstGuess
from teleopdesign.measurement.survey import (
    Choices,
    Survey,
    _check_numbers,
    content,
    encoder_counts,
    forces,
    spans_of,
)
from teleopdesign.measurement.survey.axes import of_another_axis, stand_together
from teleopdesign.measurement.survey.axis_kind import axis_of
from teleopdesign.measurement.survey.derivative import is_force, is_velocity, may_be_position
from teleopdesign.measurement.survey.force_entry import _middle_of_input
from teleopdesign.measurement.survey.position import (
    _is_another,
    _step_of_readings,
)
from teleopdesign.measurement.survey.trials import longest_trial, name_trials, trial_column

# names, units and limits


@pytest.mark.parametrize(
    ("one", "other", "together"),
    [("a.q", "a.f", True), ("a.q", "b.f", False), ("a/q", "a/f", True), ("q", "f", False),
     ("J1_pos", "J1_cur", True), ("J1_pos", "J2_cur", False), ("J1_pos", "cur", False)],
)  # fmt: skip
def test_fields_of_one_struct_or_number_stand_together(one, other, together):
    assert stand_together(one, other) == stand_together(other, one) == together


@pytest.mark.parametrize(
    ("one", "other", "more", "apart"),
    [("q_m", "tau_s", "q_s tau_m", True), ("q_m", "tau_m", "q_s tau_s", False),
     ("q_m", "tau_s", "", False), ("xl", "fr", "xr fl", True), ("xl", "fl", "xr fr", False),
     ("q_m", "tau_s", "q_s", False), ("J1", "J2", "", True), ("J1", "J", "", False),
     ("left_x", "right_f", "", True), ("left_x", "left_f", "", False), ("left_x", "f", "", False),
     ("om", "us", "sm os", False)],
)  # fmt: skip
def test_sides_and_numbers_of_names_are_those_of_axes(one, other, more, apart):
    names = [one, other, *more.split()]
    assert of_another_axis(one, other, names) == of_another_axis(other, one, names) == apart


@pytest.mark.parametrize(
    ("columns", "choices", "axis", "why"),
    [({"x": None}, {"axis": "revolute"}, "revolute", None),
     ({"x": "mm"}, {}, "prismatic", None), ({"x": "deg"}, {}, "revolute", None),
     ({"x": None}, {"units": {"x": "rad"}}, "revolute", None),
     ({"x": None}, {"torque_constant": (1.0, "N*m/A")}, "revolute", None),
     ({"x": None}, {"torque_constant": (1.0, "N/A")}, "prismatic", None),
     ({"x": None, "v": "mm/s"}, {}, "prismatic", "a velocity is in mm/s"),
     ({"x": None, "v": "rad/s", "f": "N"}, {}, "revolute", "a velocity is in rad/s"),
     ({"x": None, "v": "rad/s", "w": "m/s", "f": "N"}, {}, "prismatic", "forces are in N"),
     ({"x": None, "f": "N"}, {}, "prismatic", "forces are in N"),
     ({"x": None, "f": "N*m"}, {}, "revolute", "forces are in N*m"),
     ({"x": None, "y": "mm"}, {}, "prismatic", "a column is in mm"),
     ({"x": None, "y": "mm", "f": "N*m"}, {}, "prismatic", "a column is in mm"),
     ({"angle": None}, {}, "revolute", "the name 'angle' is that of an angle"),
     ({"x": None, "torque": None}, {}, "revolute", "the name of a column contains 'torque'"),
     ({"x": None, "i": "A"}, {}, "revolute", "no unit and no name of a column determines"),
     ({"x": "counts"}, {}, "revolute", "no unit and no name of a column determines"),
     ({"x": None, "f": "N", "g": "N*m", "i": "V"}, {}, "prismatic", "no unit and no name")],
)  # fmt: skip
def test_what_tells_whether_an_axis_turns(columns, choices, axis, why):
    survey = Survey("", {}, 1.0, columns={n: column(n, unit=u) for n, u in columns.items()})
    assert axis_of(survey, next(iter(columns)), Choices(**choices)) == axis
    if why is None:
        assert not survey.guesses
    else:
        assert survey.guesses["model.device.axis"].startswith(f"the axis is {axis}: {why}")


@pytest.mark.parametrize(
    ("name", "unit", "velocity", "force", "another"),
    [("velocity", None, True, False, True), ("velocity", "m", False, False, False),
     ("foo", "m/s", True, False, True), ("foo", None, False, False, False),
     ("force", None, False, True, True), ("force", "N", False, True, True),
     ("force", "m", False, False, False), ("foo", "N", False, True, True),
     ("commanded_velocity", None, True, False, True), ("hand", None, False, False, True),
     ("position", None, False, False, False), ("position", "N", False, True, True),
     ("foo", "s", False, False, False)],
)  # fmt: skip
def test_what_is_a_velocity_or_a_force_by_unit_or_name(name, unit, velocity, force, another):
    one = column(name, unit=unit)
    assert (is_velocity(one), is_force(one), _is_another(one)) == (velocity, force, another)


def test_only_a_stated_position_may_always_rise():
    rising, falling = np.arange(200.0), -np.arange(200.0)
    for name, unit, may in (("q", None, True), ("foo", None, False), ("foo", "deg", True),
                            ("position", "s", False), ("foo", "s", False)):  # fmt: skip
        assert may_be_position(name, {name: column(name, rising, unit)}, 0.01) == may
        assert may_be_position(name, {name: column(name, falling, unit)}, 0.01)


@pytest.mark.parametrize(("changes", "step"), [(8, 0.0), (9, 2.0)])
def test_nine_changes_show_a_step(changes, step):
    """Of the first 20 000 readings, over more than twenty steps."""
    values = 2.0 * np.array([0, 1, 3, 4, 6, 9, 13, 17, 22, 25])[: changes + 1]
    assert _step_of_readings(np.repeat(values, 3)) == pytest.approx(step)


def test_the_score_of_a_force_adds_what_physics_and_unit_say():
    def score(name, unit, explained):
        return forces._score_force(
            column(name, unit=unit), FirstGuess(1, 1, 1, explained, (0, 0, 0))
        )

    assert score("foo", None, 0.3) == pytest.approx(0.3) and score("foo", None, -2.0) == 0.0
    assert score("foo", "N", 0.3) == pytest.approx(0.8)
    assert score("foo", "mm", 0.3) == pytest.approx(0.3)
    assert score("force", None, 0.3) == pytest.approx(1.1), "a likeness of 0.8"
    assert score("hand", None, 0.9) == pytest.approx(0.2) == score("velocity", None, 0.9)
    assert score("position", None, 0.9) == pytest.approx(0.3)
    assert score("cmd", None, 0.3) == pytest.approx(0.84 + 0.3 + 0.3)


def test_the_sign_of_a_hand_is_that_which_leaves_less():
    f = np.sin(2 * np.pi * 1.3 * T) + 0.5 * np.sin(2 * np.pi * 3.1 * T)
    assert forces._sign_of_hand(U - f, f, Q, 0.005) == (1.0, None)
    sign, why = forces._sign_of_hand(U + f, f, Q, 0.005)
    assert sign == -1.0 and why.endswith("less of the forces unexplained")


def test_a_gear_is_noted_once_and_taken_by_position_velocity_and_force():
    columns = {"t": T, "q [rad]": Q, "dq [rad/s]": V, "tau [Nm]": U}
    plain, geared = look(columns), look(columns, gear_ratio=30.0)
    note = "forces and positions are those on the output side of the gear of 30"
    assert note in geared.notes and not any("output side" in n for n in plain.notes)
    for key in ("position", "velocity", "actuator_force"):
        assert geared.channels[key]["gear_ratio"] == 30.0
        assert "gear_ratio" not in plain.channels[key]


def test_a_time_that_begins_anew_is_unwrapped():
    """A counter of 16 bits in ms: of 1200 rows 5 ms apart, from 62 s on."""
    ticks = (62_000 + 5 * np.arange(1200)) % 65_536
    survey = look({"t_ms": ticks.astype(float), "q [rad]": Q, "tau [Nm]": U})
    assert survey.duration == pytest.approx(1199 * 0.005) and len(survey.time) == 1200
    assert survey.channels["time"] == {"column": "t_ms", "unit": "ms"}


def test_numbers_that_no_device_has_are_refused():
    _check_numbers(Choices(sample_rate=1e-3, counts_per_turn=0.5, gear_ratio=-30.0), "log")
    for wrong in ({"sample_rate": -1.0}, {"sample_rate": 0.0}, {"counts_per_turn": -1.0},
                  {"counts_per_turn": 0.0}, {"gear_ratio": 0.0}, {"gear_ratio": np.inf},
                  {"sample_rate": np.nan}):  # fmt: skip
        with pytest.raises(ExperimentError, match=f"log: {next(iter(wrong))}: found"):
            _check_numbers(Choices(**wrong), "log")


def test_a_log_is_cut_at_a_trial_within_a_quarter_of_three_fifths():
    assert spans_of(100.0) == ((0.0, 60.0), (60.0, 101.0))
    assert spans_of(100.0, (36.0, 84.0)) == ((0.0, 36.0), (36.0, 101.0))
    assert spans_of(100.0, (34.0, 86.0)) == ((0.0, 60.0), (60.0, 101.0))
    assert spans_of(100.0, (50.0, 65.0, 80.0)) == ((0.0, 65.0), (65.0, 101.0))
    assert spans_of(12.3456, (7.12345,)) == ((0.0, 7.123), (7.123, 13.0))


@pytest.mark.parametrize(
    ("values", "middle"),
    [([], 0.0), ([np.nan], 0.0), ([511, 513], 512.0), ([511.5, 512.5], 0.0), ([-1, 513], 0.0),
     ([0, 1023], 512.0), ([0, 1024], 0.0), ([461, 461], 512.0), ([460, 460], 0.0),
     ([563, 563], 512.0), ([564, 564], 0.0), ([120, 130], 128.0), ([2000, 2100], 2048.0),
     ([32768, 32768], 32768.0), ([70000, 70000], 0.0)],
)  # fmt: skip
def test_an_analog_input_lies_within_a_tenth_about_the_middle_of_its_range(values, middle):
    assert _middle_of_input(np.array(values, dtype=float)) == middle


@pytest.mark.parametrize(
    ("name", "reach", "counts"),
    [("enc", 50, False), ("enc", 51, True), ("x", 1000, False), ("x", 1001, True),
     ("angle", 10**6, False), ("angle_counts", 51, True)],
)  # fmt: skip
def test_whole_numbers_over_a_wide_range_are_counts(name, reach, counts):
    assert encoder_counts.is_counter(column(name, [0, np.nan, reach])) == counts
    assert not encoder_counts.is_counter(column(name, [0.5, reach]))


@pytest.mark.parametrize(
    ("factor", "counts"),
    [(2 * np.pi / 4096, 4096.0), (2 * np.pi / 4096 * 1.009, 4096.0),
     (2 * np.pi / 4050, 4096.0), (2 * np.pi / 4150, 4096.0), (2 * np.pi / 4200, 0.0),
     (2 * np.pi / 3960, 4000.0), (-2 * np.pi / 4096, 0.0),
     (2 * np.pi / 128, 128.0), (2 * np.pi / 2**24, 2.0**24), (2 * np.pi / 8e4, 8e4),
     (2 * np.pi / 100, 100.0), (0.0, 0.0)],
)  # fmt: skip
def test_counts_of_a_turn_are_those_of_an_encoder_within_a_fiftieth(monkeypatch, factor, counts):
    monkeypatch.setattr(encoder_counts, "derivative_factor", lambda *_: (factor, 1.0))
    columns = {"v": column("v", unit="rad/s"), "n": column("n", unit="N"), "u": column("u")}
    survey = Survey("revolute", {}, 1.0, time=T, columns=columns)
    one = column("q", 100 * Q)
    assert encoder_counts._counts_by_velocity(survey, one, "v") == counts
    assert encoder_counts._counts_by_velocity(survey, one, "n") == 0.0
    assert encoder_counts._counts_by_velocity(survey, one, "u") == 0.0


def test_what_is_as_likely_and_what_rises():
    scores = {"a": 1.0, "b": 0.96, "c": 0.94, "d": 1.0}
    assert content.as_likely(scores, "a") == ["b", "d"]
    unread = {n: "why" for n in "abcd"}
    assert content.reasons(unread).endswith("'c': why; ...") and content.reasons({}) == ""
    assert content.reasons({"a": "x", "b": "y", "c": "z"}).endswith("'c': z")
    three, four = (content.explain_ambiguity("q", n, "the p") for n in ("abc", "abcd"))
    assert "'a', 'b', 'c' may be" in three and "'a', 'b', 'c', ... may be" in four
    assert content.rises(np.arange(3.0)) and not content.rises(np.arange(2.0))
    assert content.rises(np.repeat(np.arange(50.0), 2)[:-2]) is False, "half of the steps"
    assert content.rises(np.repeat(np.arange(50.0), 2)[::-1]) is False
    assert content.rises(np.r_[np.repeat(np.arange(50.0), 2), 50.0, 51.0])
    steps = np.ones(200)
    steps[:3] = -1.0  # the first value, and two of 199 steps
    assert not content.rises(np.cumsum(steps)) and content.rises(np.cumsum(steps[1:]))


def test_trials_are_numbered_by_whole_numbers_that_change_once_in_fifty_rows():
    def numbered(rows, name="trial"):
        return trial_column({"q": np.arange(rows), name: (np.arange(rows) >= rows // 2) * 1.0})

    assert numbered(51) == "trial" and numbered(50) is None and numbered(51, "foo") is None
    assert trial_column({"trial": np.zeros(60)}) is None
    assert trial_column({"trial": 0.5 * (np.arange(60) > 9)}) is None
    label = np.repeat([0.0, 1.0], [600, 599])
    survey = Survey("", {}, 6.0, time=0.01 * np.arange(1199))
    survey.columns = {"trial": column("trial", label), "q": column("q", np.arange(1199.0))}
    name_trials(survey, {"trial": label})
    assert survey.trials == (6.0,) and survey.channels["segment"] == {"column": "trial"}
    assert survey.notes == ["'trial' numbers 2 trials: each is a segment"]
    assert longest_trial(survey)["q"].values.tolist() == list(range(600))
    survey.time = survey.time[:998]
    survey.columns = {"trial": column("trial", label[101:1099]), "q": column("q", np.arange(998.0))}
    assert longest_trial(survey) is survey.columns, "499 rows are few"
