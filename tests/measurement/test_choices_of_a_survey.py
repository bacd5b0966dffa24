"""Which column a survey takes for what, and what a log of many parts has as columns."""

from dataclasses import make_dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from teleopdesign.measurement.doors._log import Log
from teleopdesign.measurement.doors.bag import _WRITTEN, MOST_FIELDS, STAMP, _append
from teleopdesign.measurement.survey import Choices, survey_log
from teleopdesign.measurement.survey.axis_kind import axis_of
from teleopdesign.measurement.tables import open_log

T = 0.005 * np.arange(1200)
Q = np.sin(2 * np.pi * 0.7 * T) + 0.2 * np.sin(2 * np.pi * 2.1 * T)
U = 0.02 * np.gradient(np.gradient(Q, T), T) + 0.3 * np.sign(np.gradient(Q, T))


def look(columns):
    log = Log(tuple(columns), lambda wanted: {n: columns[n] for n in wanted})
    return survey_log(log, "log", Choices())


def test_a_name_of_a_position_counts_more_than_the_unit_of_a_wanted_one():
    survey = look({"t [s]": T, "desired position [rad]": 1.01 * Q, "position": Q, "u": U})
    assert survey.channels["position"]["column"] == "position"


@pytest.mark.parametrize(("unit", "axis"), [("mm", "prismatic"), ("deg", "revolute")])
def test_the_unit_of_the_position_tells_the_axis_whatever_the_forces_are_in(unit, axis):
    other = {"mm": "N*m", "deg": "N"}[unit]
    columns = {"x": SimpleNamespace(unit=unit), "u": SimpleNamespace(unit=other)}
    survey = SimpleNamespace(columns=columns, guesses={})
    assert axis_of(survey, "x", Choices()) == axis and survey.guesses == {}


def test_a_force_that_never_changes_is_none_whatever_its_name():
    survey = look({"t [s]": T, "q [rad]": Q, "torque": 0.0 * T, "b": U})
    assert survey.channels["actuator_force"]["column"] == "b"


@pytest.mark.parametrize("more", [0, 1])
def test_a_sheet_is_named_only_where_there_are_several(more, tmp_path):
    book = pytest.importorskip("openpyxl", reason="needs the extra io").Workbook()
    sheets = [book.active, *(book.create_sheet() for _ in range(more))]
    for row in (["t", "q"], *([float(k), float(np.sin(k))] for k in range(5))):
        sheets[-1].append(row)
    path = tmp_path / "log.xlsx"
    book.save(path)
    assert any("sheet" in note for note in open_log(path, "log.xlsx").notes) == bool(more)


def test_a_message_has_its_first_numbers_and_its_times_and_a_later_one_no_more():
    message = make_dataclass("Message", "first second".split())
    half, rows = MOST_FIELDS // 2, {}
    for k in range(3):
        numbers = 1.0 * k + np.arange(half), 1.0 * k + np.arange(half + (5 if k else -5))
        _append(rows, message(*map(list, numbers)), written=k, begin=0)
    times = {STAMP, _WRITTEN}
    of_first, of_second = (sum(n.startswith(w) for n in rows) for w in ("first", "second"))
    assert (of_first, of_second) == (half, half) and rows.keys() > times
    assert all(len(column) == 3 for column in rows.values())
    assert np.isnan(rows[f"second[{half - 1}]"][0]) and rows[f"second[{half - 1}]"][2] == half + 1
