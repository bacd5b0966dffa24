"""What is said of a log: units and signs that a survey guesses, spans, velocities, lost rows."""

import datetime
import math
from dataclasses import replace

import numpy as np
import pytest
from check.made_channels import ask
from measurement.columns_by_hand import Q, T, U, look

import teleopdesign as td
from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.doors import workbook
from teleopdesign.measurement.log_clock import _left_out, _order
from teleopdesign.measurement.new_folder import check_spans
from teleopdesign.measurement.record_clock import RecordClock

RATE_OF_Q = np.gradient(Q, T)


# units and signs that a survey guesses


@pytest.mark.parametrize(
    ("axis", "unit", "size", "speed"),
    [
        ("revolute", "deg", math.pi / 180, "rad/s"),
        ("revolute", "rad", 1.0, "rad/s"),
        ("revolute", "turns", 2 * math.pi, "rad/s"),
        ("revolute", "rad", 1.0, "deg/s"),
        ("prismatic", "mm", 1e-3, "m/s"),
        ("prismatic", "m", 1.0, "mm/s"),
        ("prismatic", "um", 1e-6, "mm/s"),
    ],
)
def test_the_unit_of_a_position_is_the_one_whose_derivative_is_the_velocity(
    axis, unit, size, speed
):
    of_speed = {"rad/s": 1.0, "deg/s": math.pi / 180, "m/s": 1.0, "mm/s": 1e-3}[speed]
    columns = {"t_s": T, "pos": Q / size, f"vel [{speed}]": RATE_OF_Q / of_speed, "i_A": U}
    survey = look(columns, axis=axis)
    assert survey.channels["position"]["unit"] == unit
    assert f"agrees with 'vel [{speed}]'" in survey.guesses["channels.position.unit"]


@pytest.mark.parametrize(
    ("axis", "reach", "unit"),
    [
        ("revolute", 49.0, "rad"),
        ("revolute", 51.0, "deg"),
        ("prismatic", 2.9, "m"),
        ("prismatic", 3.1, "mm"),
    ],
)
def test_without_a_velocity_the_unit_is_that_of_the_range(axis, reach, unit):
    turning = T * np.ptp(Q) / T[-1] + 0.01 * Q  # no wrap: it goes on and on
    survey = look({"t_s": T, "pos": reach * turning / np.ptp(turning), "i_A": U}, axis=axis)
    assert survey.channels["position"]["unit"] == unit
    assert "have a range of" in survey.guesses["channels.position.unit"]


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("with_velocity", [False, True])
def test_a_position_that_counts_against_its_force_is_turned_with_its_velocity(sign, with_velocity):
    columns = {"t_s": T, "angle_rad": sign * Q, "torque_Nm": U}
    if with_velocity:
        columns["vel_rad_s"] = sign * RATE_OF_Q
    survey = look(columns)
    for name in ("position", *(["velocity"] if with_velocity else [])):
        assert survey.channels[name].get("sign", 1) == sign
    assert ("channels.position.sign" in survey.guesses) == (sign < 0)
    # once turned, inertia and friction are those of the joint
    assert survey.first.inertia == pytest.approx(0.02, rel=0.2)
    assert survey.first.level == pytest.approx(0.3, rel=0.1)


# a velocity beside its position


def with_velocity(change):
    t = np.arange(4000) / 500
    x = 0.05 * np.sin(2 * np.pi * 0.7 * t) + 0.02 * np.sin(2 * np.pi * 2.3 * t)
    experiment = td.experiment(
        {"t": t, "x": x, "F": np.cos(t), "v": change(t, np.gradient(x, t))},
        axis="prismatic",
        time="t",
        position="x",
        velocity="v",
        actuator_force="F",
        inertia=0.1,
    )
    return ask("velocity", experiment)


@pytest.mark.parametrize("late", [5, -5])
def test_a_velocity_that_is_late_or_early_is_reported_with_the_time(late):
    (finding,) = with_velocity(lambda t, v: np.roll(v, late))
    assert finding.concern == "note" and finding.numbers["shift"] == pytest.approx(
        late / 500, rel=0.05
    )
    word = "lags" if late > 0 else "leads"
    assert f"velocity {word} position by 10 ms" in finding.sentence


@pytest.mark.parametrize(
    ("factor", "is_other"),
    [(1.0, False), (1.04, False), (0.96, False), (1.06, True), (0.94, True), (-1.0, True)],
)
def test_a_velocity_in_other_units_is_reported_from_a_factor_of_a_twentieth(factor, is_other):
    findings = with_velocity(lambda t, v: factor * v)
    assert [f.concern for f in findings] == ["warning"] * is_other
    for one in findings:
        assert one.numbers["factor"] == pytest.approx(factor, rel=1e-3)
        assert "times the derivative of position" in one.sentence


def test_a_velocity_of_something_else_is_not_given_a_factor():
    random = np.random.default_rng(0)
    (finding,) = with_velocity(lambda t, v: np.cumsum(random.standard_normal(len(t))))
    assert "does not follow the position's derivative" in finding.sentence
    assert finding.concern == "warning" and finding.numbers["left"] > 0.5
    assert with_velocity(lambda t, v: np.ones(len(t))) == []


# spans of a log


@pytest.mark.parametrize(
    "spans", [((0, 5), (5, 10)), ((5, 10), (0, 5)), ((0, 5), (6, 99)), ((2, 3), (0, 1))]
)
def test_spans_within_a_log_that_do_not_overlap_are_taken(spans):
    check_spans(spans, 10.0, ["log.csv"])


@pytest.mark.parametrize(
    ("spans", "message"),
    [
        (((0, 5), (4.9, 10)), "expected spans that do not overlap"),
        (((4, 9), (0, 4.1)), "expected spans that do not overlap"),
        (((0, 5), (7, 7)), "check span: found 7 to 7 s"),
        (((5, 1), (7, 8)), "fit span: found 5 to 1 s"),
        (((-1, 5), (7, 8)), "fit span: found -1 to 5 s"),
        (((0, 5), (10, 12)), "check span: found 10 to 12 s"),
    ],
)
def test_spans_that_overlap_or_lie_outside_are_refused(spans, message):
    with pytest.raises(ExperimentError, match=message):
        check_spans(spans, 10.0, ["log.csv"])
    with pytest.raises(ExperimentError, match="found 2 logs"):
        check_spans(((0, 5), (5, 10)), 10.0, ["a.csv", "b.csv"])


# rows


@pytest.mark.parametrize("kind", range(3))
def test_each_kind_of_row_that_is_left_out_is_counted_with_its_part(kind):
    masks = [np.zeros(200, dtype=bool) for _ in range(3)]
    assert _left_out("log.csv", *masks, 0.01) == []
    masks[kind][:7] = True
    (step,) = _left_out("log.csv", *masks, 0.01)
    count = ("7 rows with a cell", "7 rows the same", "rows come faster")[kind]
    assert step.observed.startswith(count) and step.effect.startswith("3.5 % of the rows")
    assert ("100 a second" in step.rule) == (kind == 2)


WHOLE = RecordClock(
    np.arange(100), 0.01 * np.arange(100), np.arange(100), 0.01 * np.arange(100), 0.01,
    (slice(0, 100),), (slice(0, 100),),
)  # fmt: skip


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({}, None),
        ({"dropped": 2}, "2 rows with the stamp of another"),
        ({"sorted": 1}, "1 row out of order"),
        ({"restarts": 3}, "time set back 3 times"),
        ({"gaps": 1, "longest_gap": 2.5}, "1 pause, the longest 2.5 s"),
        ({"alone": 1}, "1 row with a pause or an end on both sides"),
        ({"counted": True}, "stamps that many rows share"),
    ],
)
def test_what_was_done_about_stamps_is_reported_once_and_only_where_it_was(changes, message):
    steps = _order(replace(WHOLE, **changes), "log.csv", 100)
    assert [s.observed for s in steps] == ([] if message is None else [message])


@pytest.mark.parametrize(
    ("cell", "seconds"),
    [
        (datetime.time(1, 2, 3, 500_000), 3723.5),
        (datetime.timedelta(days=1, seconds=2), 86402.0),
    ],
)
def test_times_of_a_workbook_are_seconds(cell, seconds):
    assert workbook._column([cell, None, cell])[[0, 2]].tolist() == [seconds] * 2
    assert np.isnan(workbook._column([cell, None])[1])
    assert workbook._column([1, None, 2.5])[[0, 2]].tolist() == [1.0, 2.5]
    assert workbook._column(["a", 1]).dtype == object
    date = workbook._column([datetime.datetime(1970, 1, 1, 0, 0, 2), None])
    assert date[0] == np.datetime64(2, "s") and np.isnat(date[1])


@pytest.mark.parametrize(("unit", "size"), [("rad", 1.0), ("deg", np.pi / 180), ("mm", 1e-3)])
@pytest.mark.parametrize("step", [1e-3, 0.5, 3.0])
def test_the_step_of_an_encoder_is_stated_in_the_unit_of_its_column(unit, size, step):
    """Also where it is below one; a smooth column has none."""
    travel = 400.0 * step
    read = step * np.round(travel * (Q / np.ptp(Q)) / step)
    axis = "prismatic" if unit == "mm" else "revolute"
    force = "u_N" if unit == "mm" else "u_Nm"
    survey = look({"t_s": T, f"pos_{unit}": read, force: U}, axis=axis, position=f"pos_{unit}")
    assert survey.channels["position"]["resolution"] == pytest.approx(step, rel=1e-3)
    assert any(f"moves in steps of {step:.4g} {unit}" in note for note in survey.notes)
    smooth = look(
        {"t_s": T, f"pos_{unit}": travel * Q, force: U}, axis=axis, position=f"pos_{unit}"
    )
    assert smooth.channels["position"].get("resolution", 0.0) < 0.01 * step * 400
