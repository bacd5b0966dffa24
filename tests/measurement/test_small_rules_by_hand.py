"""Rules that decide in rare cases, each beside the case in which it decides."""

import datetime

import numpy as np
import pytest
from check.made_channels import H, clock_errors, record_of

from teleopdesign import example, load_experiment
from teleopdesign.base.errors import ExperimentError
from teleopdesign.check import sample_clock
from teleopdesign.check.velocity import shift_and_factor
from teleopdesign.measurement.doors._log import Log
from teleopdesign.measurement.doors.hdf5 import _unit
from teleopdesign.measurement.numbers_in_cells import numbers_of
from teleopdesign.measurement.repeated_rows import BESIDE, _chance_of_repeats
from teleopdesign.measurement.survey.clock import numeric_columns
from teleopdesign.measurement.tables import columns_of
from teleopdesign.measurement.uneven_stamps import _places


def log_with(columns, **more):
    return Log(tuple(columns), lambda wanted: {n: columns[n] for n in wanted}, **more)


def test_the_figure_of_a_clock_shows_by_how_many_ms_each_stamp_is_off(monkeypatch):
    record = record_of(2 * sample_clock.POINTS)
    off = 0.1 * H * np.sin(np.arange(len(record.time)))
    monkeypatch.setattr(sample_clock, "stamps_of", lambda *_: record.time + off)
    (finding,) = clock_errors(record)
    (series,) = finding.graph.series
    assert np.array_equal(series.x, record.time[::2])
    assert series.y == pytest.approx(1e3 * off[::2], rel=1e-6)


@pytest.mark.parametrize("before", [0, 3])
def test_the_chance_of_a_repeat_counts_the_rows_beside_it_from_the_first_of_a_log_on(before):
    """One reading that repeats by itself in the first and the last row that count."""
    n, first, past = before + 2 * BESIDE + 2, before + BESIDE, before + BESIDE + 2
    change = np.ones(n)
    same = np.zeros(n, dtype=bool)
    same[first:past] = True
    change[: before + 1] = change[past + BESIDE - 1 :] = change[same] = 0.0
    one = [np.r_[0.0, np.cumsum(change)]]
    (chance,) = _chance_of_repeats(one, same, np.array([first]), np.array([past]))
    assert chance == pytest.approx(2.5 / (2 * BESIDE + 1))


def test_a_clock_of_one_column_stands_beside_a_time_without_one():
    q, f, s = (np.arange(5.0) + k for k in range(3))
    log = log_with({"t": 0.1 * q, "q": q, "f": f, "s": s}, clocks={"f": "s"})
    wanted = {"t": "channels.time", "q": "channels.position", "f": "channels.interaction_force"}
    columns = columns_of(log, "log", wanted)
    assert set(columns.stamps) == {"f"} and np.array_equal(columns.stamps["f"], s)


def test_a_velocity_without_any_part_of_the_slope_is_not_moved_along_for_ever():
    """A position in its place: a sine has no part of its own slope, and lags by no time."""
    t = H * np.arange(4000)
    position = np.sin(2 * np.pi * 1.5 * t)
    shift, factor, left = shift_and_factor(position, position, H)
    assert shift == 0.0 and abs(factor) < 1e-3


def test_rows_keep_their_places_beside_a_first_stamp_that_is_late():
    """The first is 0.45 of a step late, each twentieth 0.4 early: all near their places."""
    stamps = np.arange(200.0)
    stamps[0] += 0.45
    stamps[10::20] -= 0.4
    (period, (places,)) = _places([stamps], 1.0)
    assert period == pytest.approx(1.0, abs=1e-3)
    assert np.array_equal(places, np.arange(200))


def test_a_column_of_which_half_are_numbers_is_none():
    cells = {"q": np.arange(6.0), "half": np.array([1.0, np.nan] * 3)}
    raw, unread, _ = numeric_columns(log_with(cells), "log")
    assert list(raw) == ["q"] and list(unread) == ["half"]


def test_an_empty_cell_before_dates_is_none_of_them():
    start = datetime.datetime(2026, 1, 2)
    later = [start + datetime.timedelta(seconds=k) for k in (0, 1, 3)]
    seconds = numbers_of(np.array([None, *later], dtype=object), "t", "log")
    assert np.array_equal(seconds, [np.nan, 0.0, 1.0, 3.0], equal_nan=True)
    with pytest.raises(ExperimentError, match="row 1"):
        numbers_of(np.array([[1], {}], dtype=object), "t", "log")


def test_the_effects_of_a_body_are_in_the_table_of_an_experiment():
    page = load_experiment(example("rod"))._repr_html_()
    assert "coulomb, viscous" in page and "no effects" not in page


@pytest.mark.parametrize(("value", "unit"), [(3, None), ("  ", None), (b"mm", "mm"), (" N ", "N")])
def test_only_a_text_is_the_unit_of_a_dataset(value, unit):
    item = type("Dataset", (), {"attrs": {"unit": value}})
    assert _unit(item) == unit
