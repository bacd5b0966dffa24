"""Stamps that wrap, share rows or begin anew; held commands; numbers, texts and files."""

import math

import numpy as np
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.base.toml import Table, parse_toml
from teleopdesign.check.stated_accuracy import true_step
from teleopdesign.measurement import slower_signals
from teleopdesign.measurement.channel import Channel
from teleopdesign.measurement.description import value_from
from teleopdesign.measurement.doors._cells import number_of
from teleopdesign.measurement.doors._encoding import encoding_of
from teleopdesign.measurement.even_clock import _least_squares_period, _resolution
from teleopdesign.measurement.experiment import _span, load_experiment
from teleopdesign.measurement.repeated_rows import repeated_rows, rows_between_readings
from teleopdesign.measurement.resample import _average_held, _position
from teleopdesign.measurement.stamp_unit import unit_of_steps
from teleopdesign.measurement.tables import LogColumns, open_log
from teleopdesign.measurement.time_grid import _mostly_back
from teleopdesign.measurement.uneven_stamps import _counted_clock, _usual_step
from teleopdesign.measurement.wrapped_stamps import seconds_since_first, unwrap_stamps

# stamps


def test_counters_and_clocks_begin_anew_after_a_period_that_leaves_a_usual_step():
    ticks = (np.arange(65_000.0, 66_000.0, 10.0)) % 65_536
    whole, notes = unwrap_stamps(ticks)
    assert whole == pytest.approx(np.arange(65_000.0, 66_000.0, 10.0)) and len(notes) == 1
    day = (86_390.0 + 0.1 * np.arange(200)) % 86_400.0
    whole, notes = unwrap_stamps(day)
    assert whole == pytest.approx(86_390.0 + 0.1 * np.arange(200))
    assert notes == ("the time of day begins anew at midnight: time counts on",)
    lost = 20.0  # usual steps over the wrap: as many may be lost, and no more
    for over, wraps in ((lost, True), (lost + 1, False)):
        ticks = np.r_[np.arange(65_436.0, 65_536.0), np.arange(100.0) + over - 1]
        assert bool(unwrap_stamps(ticks)[1]) == wraps
    again = np.r_[np.arange(65_436.0, 65_536.0), np.arange(65_535.0 - 65_536.0 + 0.0, 50.0)]
    assert not unwrap_stamps(again)[1], "a step of zero is no step forward"
    assert unwrap_stamps(np.arange(9.0))[1] == () == unwrap_stamps(-np.arange(9.0))[1]


def test_time_goes_on_where_a_clock_was_set_back_by_more_than_five_steps():
    for back, goes_on in ((5, False), (6, True)):
        stamps = np.r_[np.arange(50.0), 49.0 - back + np.arange(50.0)]
        since = seconds_since_first(stamps)
        expected = np.arange(100.0) if goes_on else stamps
        assert since == pytest.approx(expected)
    gap = np.r_[np.nan, 7.0, 8.0, np.nan, 9.0]
    assert np.array_equal(seconds_since_first(gap), [np.nan, 0, 1, np.nan, 2], equal_nan=True)
    assert not np.isfinite(seconds_since_first(np.full(3, np.nan))).any()


@pytest.mark.parametrize(
    ("step", "unit", "is_guess"),
    [(2e-5, "s", False), (0.19, "s", False), (1e-5, "s", True), (0.21, "ms", True),
     (199.0, "ms", True), (201.0, "us", True), (1.9e5, "us", True), (2.1e5, "ns", True)],
)  # fmt: skip
def test_the_unit_of_stamps_is_that_in_which_their_steps_are_usual(step, unit, is_guess):
    result, why = unit_of_steps(step * np.arange(2000.0))
    assert result == unit and bool(why) == is_guess


def test_rows_that_share_stamps_are_counted_between_the_first_and_the_last_change():
    stamps = np.r_[0.0, 0.0, 0.0, np.repeat(np.arange(1.0, 30.0), 4), 30.0]
    made = _counted_clock(stamps, "log")
    assert made.sample_time == pytest.approx(0.25) and made.counted
    assert made.time == pytest.approx(1.0 + 0.25 * (np.arange(len(stamps)) - 3))
    single = np.r_[np.zeros(50), np.full(51, 5.0)]
    assert _counted_clock(single, "log").sample_time == pytest.approx(0.05)
    assert _usual_step([np.cumsum([0, 1.0, 1.0, 1.4]), np.cumsum([0.0, 1.6, 5.0])]) == 1.25
    assert _mostly_back(np.array([3.0, 2, 2, 1, 1])) is False
    assert _mostly_back(np.array([3.0, 2, 1, 1])) is True


def test_the_step_of_even_stamps_is_the_slope_over_all_stretches():
    stamps = np.array([0.0, 0.1, 0.2, 7.0, 7.3])
    parts = slice(0, 3), slice(3, 5)
    # slopes 0.1 with weight 2 and 0.3 with weight 1/2
    assert _least_squares_period(stamps, parts) == pytest.approx((0.1 * 2 + 0.3 * 0.5) / 2.5)
    ones = tuple(slice(k, k + 1) for k in range(5))
    assert _least_squares_period(stamps, ones) is None
    assert _least_squares_period(-stamps, parts) is None
    for digits in range(1, 9):
        assert _resolution(np.array([5.0, 5.0 + round(1 / 3, digits)])) == 10.0**-digits
    assert _resolution(np.array([5.0, 12.0])) == 1.0
    assert _resolution(np.array([0.0, 1 / 3])) == 1e-9


# rows, commands and positions


def test_a_slower_source_that_rests_has_one_reading_a_period():
    source = np.repeat(np.arange(200), 4)
    moving = np.where(source < 90, source, np.where(source < 110, 90, source - 20))
    x, u = 10.0 * np.sin(0.1 * moving), np.cos(0.3 * moving)
    between = rows_between_readings([x, u], [x], 0.001 * np.arange(800))
    kept = np.flatnonzero(~between)
    assert np.all(kept % 4 == 0) and np.array_equal(kept, np.arange(4, 800, 4)[: len(kept)])
    assert 440 in kept and 444 in kept and len(kept) == 199


@pytest.mark.parametrize(("rows", "lost"), [(12, True), (9, False)])
def test_a_record_that_stops_amid_a_fast_motion_is_lost_from_there(rows, lost):
    n = 400
    x = 1000.0 * np.sin(0.05 * (np.arange(n) - (n - rows)))  # fastest where it stops
    u = np.cumsum(np.random.default_rng(1).standard_normal(n))
    x[n - rows :], u[n - rows :] = x[n - rows - 1], u[n - rows - 1]
    mask = repeated_rows([x, u], [x], [])
    assert np.flatnonzero(mask).tolist() == (list(range(n - rows, n)) if lost else [])


@pytest.mark.parametrize("beyond", [0, 1, 4])
def test_the_mean_of_a_held_command_is_that_of_brute_force(beyond):
    random = np.random.default_rng(4)
    at = np.cumsum(random.uniform(0.4, 1.6, 12))
    at = at - at[0] + 0.3
    values, grid = random.standard_normal(12), np.arange(float(int(at[-1]) - beyond))
    fine = grid[:, None] + (np.arange(4000) + 0.5) / 4000
    held = np.maximum(np.searchsorted(at, fine, side="right") - 1, 0)
    assert _average_held(values, at, grid) == pytest.approx(values[held].mean(axis=1), abs=2e-3)


def test_a_position_keeps_its_last_reading_beyond_its_ends():
    at, values = np.array([1.0, 2.0, 3.0, 4.0]), np.array([10.0, 20.0, 40.0, 70.0])
    made = _position(values, at, np.array([0.0, 0.4, 1.0, 2.5, 4.0, 4.6, 9.0]), 0.0)
    # the parabola 10 + 5 (t - 1) + 5 (t - 1)^2 through all four
    assert made == pytest.approx([10.0, 10.0, 10.0, 28.75, 70.0, 70.0, 70.0])
    stepped = _position(values, at, np.array([0.0, 4.6, 2.5]), 30.0)
    assert stepped == pytest.approx([10.0, 70.0, 20.0]), "few steps apart: a line in such steps"


# slower bodies, scatter, texts


def test_the_time_of_rows_for_slower_bodies():
    channels = {"time": Channel("time", None, "t", "ms", None, None)}

    def stamps(t, rate=None, to_seconds=1e-3):
        columns = LogColumns({"t": np.asarray(t, dtype=float), "s": np.zeros(999)}, {"s": None})
        return slower_signals._stamps(columns, channels, "log", rate, to_seconds)

    assert stamps([5.0, 7.0, 11.0]) == pytest.approx([0.005, 0.007, 0.011])
    assert stamps([2e9, 2e9 + 2, 2e9 + 6], to_seconds=1.0).tolist() == [0.0, 2.0, 6.0]
    assert stamps([5.0, np.nan]) is None is stamps([])
    assert stamps(np.zeros(100), rate=50.0) == pytest.approx(0.02 * np.arange(100))
    assert stamps([5.0, 7.0], to_seconds=None) == pytest.approx([5.0, 7.0])


def test_the_true_step_is_the_largest_multiple_on_which_readings_lie():
    x = 4.0 * np.random.default_rng(1).integers(0, 300, 900)
    assert true_step(x, 1.0) == 4.0 == true_step(x, 4.0) and true_step(x, 3.0) is None
    assert true_step(1e3 * x, 1e3) == 4e3 and true_step(1e-6 * x, 1e-6) == pytest.approx(4e-6)
    assert true_step(x[x <= 40.0], 1.0) == 2.0, "a tenth of the travel is no step"


def test_rows_at_rest_lie_on_any_grid_and_tell_no_step():
    """A servo that rested in 92 % of the rows was said to move in steps of 36 counts."""
    strokes = np.array([65.0, 246.0, 377.0, 394.0, 329.0, 149.0, 17.0])
    assert true_step(np.r_[np.zeros(90), strokes, np.zeros(90)], 1.0) == 1.0


def test_a_number_may_have_an_exponent_of_fortran_and_a_text_may_have_100_points():
    for cell, number in (("1d3", 1e3), ("-1.5D-2", -0.015), ("1e3", 1e3), ("inf", math.inf)):
        assert number_of(cell) == number
    assert math.isnan(number_of("nan")) and number_of("dd") == "dd"
    key, long = ".".join("a" * 99), ".".join("a" * 100)
    assert parse_toml(f'x = "{"." * 200}"') == {"x": "." * 200}
    assert parse_toml(f"{key} = 1")["a"] and parse_toml('"a.b" = 1') == {"a.b": 1}
    for text in (f"{long} = 1", f"[{long}]", f'x = 1\n"a".{".".join("b" * 99)} = 1'):
        with pytest.raises(ValueError, match="a key of 100 words or more"):
            parse_toml(text)


def test_standard_errors_and_spans_that_a_file_may_state():
    zero = value_from(Table({"m": {"value": 1.0, "stderr": 0.0}}, "f"), "m")
    assert zero.stderr == 0.0
    with pytest.raises(ExperimentError, match="stderr: found -1, expected 0 or more"):
        value_from(Table({"m": {"value": 1.0, "stderr": -1.0}}, "f"), "m")
    assert _span(Table({"span": [0, 1]}, "f")) == (0.0, 1.0) and _span(Table({}, "f")) is None
    for wrong in ([1, 1], [0, 1e9], [-1, 1], [True, 2], [0, True], ["a", 2], [1], [0, 1, 2], 3):
        with pytest.raises(ExperimentError, match="span: found"):
            _span(Table({"span": wrong}, "f"))


def test_a_folder_inside_an_experiment_is_none(rod):
    inner = rod / "inner"
    inner.mkdir()
    with pytest.raises(ExperimentError, match=r"inner: no experiment.toml, found an empty folder"):
        load_experiment(inner)
    for k in range(10):
        (inner / f"{k}").write_text("")
    with pytest.raises(ExperimentError, match=r"found 0, 1, 2, 3, 4, 5, 6, 7, 8, 9$"):
        load_experiment(inner)
    (inner / "a").write_text("")
    with pytest.raises(ExperimentError, match=r"8, 9, \.\.\.$"):
        load_experiment(inner)
    assert load_experiment(rod / "fit.csv").folder == load_experiment(rod).folder


def test_a_file_without_an_ending_is_a_table_by_its_lines(tmp_path):
    table = b"t,x\n" + b"".join(b"%d,%d\n" % (k, k) for k in range(5))
    for content, is_log in ((table, True), (b"PK" + table, False), (table + b"\0", False),
                            (b"\x1f\x8b" + table, False), (b"t,x", False)):  # fmt: skip
        path = tmp_path / "run12"
        path.write_bytes(content)
        if is_log:
            assert open_log(path, "run12").names == ("t", "x")
        else:
            with pytest.raises(ExperimentError, match="run12: found a file of kind"):
                open_log(path, "run12")


def test_letters_of_cyrillic_words_tell_their_encoding():
    words = "время;сила\n0;1\n".encode("cp1251")
    assert encoding_of(words, "f", whole=True) == "cp1251"
    single = "posição;força\n0;1\n".encode("cp1252")
    assert encoding_of(single, "f", whole=True) in ("cp1252", "latin-1")
    plain = "t,x\n0,1\n" * 9
    assert encoding_of(plain.encode("utf-16"), "f", whole=True) == "utf-16"
