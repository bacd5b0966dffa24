"""Clocks of tables, spans, held commands, jitter, and forces that a survey writes down, by hand."""

import numpy as np
import pytest
from check.made_channels import H, channel, record_of

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.channel import Channel
from teleopdesign.measurement.doors import bag
from teleopdesign.measurement.doors._log import Log
from teleopdesign.measurement.encoder import sampling_jitter
from teleopdesign.measurement.filtering import spectrum
from teleopdesign.measurement.held_command import held_command
from teleopdesign.measurement.resample import _interpolate_in_steps
from teleopdesign.measurement.spans import cut_to
from teleopdesign.measurement.survey import Choices, Survey, SurveyedColumn, survey_log
from teleopdesign.measurement.survey.derivative import derivative_factor, wrap_of
from teleopdesign.measurement.survey.force_entry import describe_force
from teleopdesign.measurement.survey.forces import _find_hand
from teleopdesign.measurement.tables import LogColumns, columns_of, tables_in
from teleopdesign.measurement.uneven_stamps import rows_in_order
from teleopdesign.measurement.value_text import lever_arm, motor_constant


def test_columns_of_other_clocks_keep_their_stamps_beside_the_time_of_a_log():
    t, x, f, s = (np.arange(5.0) + k for k in range(4))
    columns = {"t": t, "x": x, "f": f, "s": s}
    wanted = {"t": "channels.time", "x": "channels.position", "f": "channels.interaction_force"}

    def stamps(clocks):
        log = Log(tuple(columns), lambda w: {n: columns[n] for n in w}, clocks=clocks)
        return {n: v.tolist() for n, v in columns_of(log, "log", wanted).stamps.items()}

    assert stamps({}) == {}
    assert stamps({"f": "s"}) == {"f": s.tolist()}
    assert stamps({"x": "t", "f": "s"}) == {"f": s.tolist()}, "the time itself is one of them"
    # the time lies on a clock: what lies on the same clock goes with it
    assert stamps({"t": "s", "x": "s"}) == {}
    assert stamps({"t": "s", "x": "s", "f": "x"}) == {"f": x.tolist()}
    assert stamps({"t": "t", "f": "s"}) == {"f": s.tolist()}


def test_tables_of_a_folder_are_its_logs_that_are_no_bags(tmp_path):
    for name in ("b.csv", "a.csv", "c.bag", "d.png", "e.mcap"):
        (tmp_path / name).write_text("")
    (tmp_path / "inner.csv").mkdir()
    assert [p.name for p in tables_in(tmp_path)] == ["a.csv", "b.csv"]
    (tmp_path / "experiment.toml").write_text("")
    assert tables_in(tmp_path) == []


def test_a_span_holds_its_begin_and_not_its_end_in_the_unit_of_the_time():
    columns = LogColumns({"t": 7.0 + np.arange(10.0), "x": np.arange(10.0), "own": np.zeros(3)})
    columns = LogColumns(columns.values, {"own": np.arange(3.0)}, ("a note",))
    for unit, second in (("s", 1.0), ("ms", 1e-3)):
        known = {"time": Channel("time", None, "t", unit, None, None)}
        cut = cut_to(columns, (2 * second, 5 * second), known, {}, None, "log")
        assert cut.values["x"].tolist() == [2.0, 3.0, 4.0] and len(cut.values["own"]) == 3
        assert cut.notes == ("a note",)
    counted = cut_to(columns, (0.02, 0.05), {}, {}, 100.0, "log")
    assert counted.values["x"].tolist() == [2.0, 3.0, 4.0]
    with pytest.raises(ExperimentError, match="no row from 9.5 to 10 s, the log ends at 9 s"):
        cut_to(columns, (9.5, 10.0), {}, {}, 1.0, "log")
    for wrong in ((1.0, 1.0), (2.0, 1.0), (0.0, np.inf), (1.0,)):
        with pytest.raises(ExperimentError, match="span: found"):
            cut_to(columns, wrong, {}, {}, 1.0, "log")


def test_a_held_command_is_computed_anew_for_another_delay_or_smoothing():
    n, h = 400, 0.01
    command, grid = np.cumsum(np.random.default_rng(1).standard_normal(n)), spectrum(n, h)
    held = held_command(command, grid)
    assert held_command(command, grid) is held is not held_command(command.copy(), grid)
    low, lower = grid.lowpass(5.0), grid.lowpass(2.0)
    by_hand = grid.back(grid.transform(command) * grid.hold() * low)
    assert held.smooth(0.0, low) == pytest.approx(by_hand)
    assert held.smooth(0.0, low) is held.smooth(0.0, low)
    late = grid.back(grid.transform(command) * grid.hold() * low * grid.ahead(0.03))
    assert held.smooth(0.03, low) == pytest.approx(late)
    assert held.smooth(0.03, lower) != pytest.approx(late)
    assert held.smooth(0.03, low) == pytest.approx(late)
    assert held_command(command, spectrum(n, 2 * h)) is not held


@pytest.mark.parametrize("late", [5e-5, 2e-4, 5e-4, 8e-4])
def test_the_jitter_of_two_speeds_is_the_difference_of_their_scatters(late):
    """Scatter is jitter times speed: of the slow half it is no noise at rest.

    Up to most of a row, which makes more of the step between two readings than the motion.
    """
    random = np.random.default_rng(7)
    n = 64 * 400
    slow = np.arange(n) < n // 2
    speed = np.where(slow, 1.0, 2.5)
    x = 1e-3 * np.cumsum(speed) + speed * late * random.standard_normal(n)
    assert sampling_jitter(x, 0.0, 1e-3) == pytest.approx(late, rel=0.06)


def test_steps_between_two_readings():
    part = np.array([0.0, 0.5, 0.6, 1.0])
    assert _interpolate_in_steps(np.full(4, 3.0), np.full(4, 9.0), part, 0.0).tolist() == [
        3,
        3,
        9,
        9,
    ]
    assert _interpolate_in_steps(3.0, 9.0, part, 4.0).tolist() == [3.0, 7.0, 7.0, 11.0]


def test_a_graph_shows_a_hundred_samples_to_either_side():
    signal = channel(np.arange(500.0))
    graph = signal.around(200, np.array([99, 100, 299, 300]), name="odd")
    assert graph.series[0].y.tolist() == list(range(100, 300))
    assert graph.series[1].y.tolist() == [100.0, 299.0]
    assert graph.series[1].x == pytest.approx([0.1, 0.299])
    near = signal.around(20, np.array([0, 119, 120]), name="odd").series
    assert near[0].y.tolist() == list(range(120)) and near[1].y.tolist() == [0.0, 119.0]
    end = signal.around(490, np.array([499]), name="odd", span=30).series
    assert end[0].y.tolist() == list(range(460, 500)) and end[1].y.tolist() == [499.0]
    assert list(channel(np.arange(9.0), segments=(slice(0, 4), slice(4, 9))).stretches)[1][0] == 4
    assert record_of(9).time[-1] == pytest.approx(8 * H)


# values, names and units


def test_lengths_and_constants_as_users_type_them():
    assert lever_arm("0.5 m", where="x") == (0.5, "m")
    assert motor_constant("0.037 Nm/A", where="x")[0] == 0.037
    for text in ("0 m", "-1 m", "0.5", "0.5 N", "m"):
        with pytest.raises(ExperimentError, match="x: found"):
            lever_arm(text, where="x")
    for text in ("0.037", "3 N", "3 m/A", "3 N/s"):
        with pytest.raises(ExperimentError, match="x: found"):
            motor_constant(text, where="x")


def test_type_names_of_messages_have_as_many_letters_as_names_may():
    bag._check_type_name("a" * bag.LONGEST, "f")
    bag._check_field("a" * bag.LONGEST, ("a/b", 3), "f")
    for name in ("a" * (bag.LONGEST + 1), "", "a b", "a//b"):
        with pytest.raises(ExperimentError, match="found a message type"):
            bag._check_type_name(name, "f")
    for name, kind in (("a" * (bag.LONGEST + 1), "b"), ("a b", "b"), ("a", "b c"), ("a", 1.5)):
        with pytest.raises(ExperimentError, match="f: f"):
            bag._check_field(name, kind, "f")


def surveyed(**units):
    columns = {
        n: SurveyedColumn(n, np.array([0.5, -1.5]), np.array([0.5, -1.5]), u)
        for n, u in units.items()
    }
    return Survey("revolute", {}, 1.0, columns=columns)


def test_the_hand_is_the_force_with_its_name_that_is_not_the_command():
    free = surveyed(hand=None, ext=None, foo=None).columns
    assert _find_hand(free, "foo", Choices()) == "hand"
    assert _find_hand(free, "hand", Choices()) == "ext"
    assert (
        _find_hand({"foo": free["foo"]}, "bar", Choices()) is None is _find_hand({}, "a", Choices())
    )
    assert _find_hand(free, "foo", Choices(interaction_force="none")) is None
    assert _find_hand(free, "foo", Choices(interaction_force="foo")) == "foo"


CONSTANT = (0.05, "N*m/A")


@pytest.mark.parametrize(
    ("name", "unit", "constant", "entry"),
    [("foo", "N*m", None, {"unit": "N*m"}), ("foo", None, None, {"unit": "N*m"}),
     ("foo", "N*m", CONSTANT, {"unit": "N*m"}), ("tau", None, CONSTANT, {"unit": "N*m"}),
     ("foo", None, CONSTANT, {"unit": "A", "torque_constant": {"value": 0.05, "unit": "N*m/A"}}),
     ("foo", "mA", CONSTANT, {"unit": "mA", "torque_constant": {"value": 0.05, "unit": "N*m/A"}}),
     ("foo", "V", None, {"unit": "V", "torque_constant": {"value": 1.0, "unit": "N*m/V"}}),
     ("current", None, None, {"unit": "A", "torque_constant": {"value": 1.0, "unit": "N*m/A"}}),
     ("foo", "N", None, {"unit": "N", "lever_arm": {"value": 1.0, "unit": "m"}})],
)  # fmt: skip
def test_the_entry_of_a_command_follows_from_unit_name_and_constant(name, unit, constant, entry):
    survey = surveyed(**{name: unit})
    made = describe_force(survey, name, "actuator_force", Choices(torque_constant=constant))
    assert made == {"column": name, **entry}
    unused = constant is not None and "torque_constant" not in entry
    assert ("channels.actuator_force.column" in survey.guesses) == unused
    if constant is None and "torque_constant" in entry:
        why = survey.guesses["channels.actuator_force.torque_constant"]
        assert "is a placeholder for the motor's constant" in why
    hand = describe_force(surveyed(**{name: unit}), name, "interaction_force", Choices())
    if unit == "N*m":
        assert hand == {"column": name, "unit": "N*m"}


def test_a_velocity_is_the_derivative_times_its_factor():
    t = 0.002 * np.arange(3000)
    x = np.sin(2 * np.pi * 1.5 * t) + 0.3 * np.cos(2 * np.pi * 3.7 * t)
    v = 2 * np.pi * (1.5 * np.cos(2 * np.pi * 1.5 * t) - 0.3 * 3.7 * np.sin(2 * np.pi * 3.7 * t))
    factor, agree = derivative_factor(5.0 + x, 7.0 + 40.0 * v, 0.002)
    assert factor == pytest.approx(40.0, rel=1e-3) and agree == pytest.approx(1.0, abs=1e-4)
    assert derivative_factor(x, -v, 0.002)[1] == pytest.approx(-1.0, abs=1e-4)
    assert derivative_factor(np.zeros(3000), v, 0.002) == (0.0, 0.0)
    assert derivative_factor(x, np.zeros(3000), 0.002) == (0.0, 0.0)
    assert abs(derivative_factor(x, x, 0.002)[1]) < 0.1


@pytest.mark.parametrize("period", [360.0, 2 * np.pi, 400.0, 2.0**8, 2.0**16, 4000.0, 2.0**32])
def test_the_period_of_a_wrap_is_read_off_its_jumps(period):
    whole = period * (0.3 + 2.2 * np.sin(2 * np.pi * 0.001 * np.arange(2000)))
    whole = np.round(whole) if period > 400.0 or period == 2.0**8 else whole
    assert wrap_of(whole % period) == period and wrap_of(whole) is None
    assert wrap_of(np.zeros(9)) is None


def test_rows_out_of_order_are_sorted_and_a_clock_set_back_begins_a_stretch():
    none = np.zeros(40, dtype=bool)
    stamps = np.arange(40.0)
    stamps[[10, 11]] = stamps[[11, 10]]
    (part,), dropped, moved, restarts = rows_in_order(stamps, (slice(0, 40),), none)
    assert part.tolist() == [*range(10), 11, 10, *range(12, 40)]
    assert (dropped, moved, restarts) == (0, 2, 0)
    for back, parts in ((5.9, 1), (6.1, 2)):
        stamps = np.r_[np.arange(20.0), 19.0 - back + 0.5 + np.arange(20.0)]
        stretches, _, _, restarts = rows_in_order(stamps, (slice(0, 40),), none)
        assert len(stretches) == parts == restarts + 1
    again = np.arange(40.0)
    again[20] = 19.0
    (part,), dropped, _, _ = rows_in_order(again, (slice(0, 40),), none)
    assert dropped == 1 and 20 not in part and len(part) == 39
    near = np.arange(40.0)
    near[20:] -= 0.8
    same = none.copy()
    assert rows_in_order(near, (slice(0, 40),), same)[1] == 0
    same[20] = True
    assert rows_in_order(near, (slice(0, 40),), same)[1] == 1


def test_a_second_velocity_and_a_column_of_other_length_say_why_they_are_left_out():
    t = 0.005 * np.arange(1200)
    q = np.sin(2 * np.pi * 0.7 * t) + 0.2 * np.sin(2 * np.pi * 2.1 * t)
    v = np.gradient(q, t)
    force = 0.02 * np.gradient(v, t) + 0.3 * np.sign(v)
    columns = {"t": t, "q [rad]": q, "dq [rad/s]": v, "tau [Nm]": force, "few": np.arange(7.0) % 3}
    columns["w [rad/s]"] = v + 0.05 * np.random.default_rng(1).standard_normal(1200)
    log = Log(tuple(columns), lambda wanted: {n: columns[n] for n in wanted})
    left_out = survey_log(log, "log", Choices()).unused
    assert left_out["w [rad/s]"] == "a second velocity for 'q [rad]'"
    assert left_out["few"] == "has 7 rows, another number than the time"
