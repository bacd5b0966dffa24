"""Dates and times of day in text, written by the calendar of Python: read as its seconds."""

from datetime import UTC, datetime, timedelta, timezone

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.measurement.doors._cells import stamps_of
from teleopdesign.measurement.tables import open_log, read_columns

DATES = [
    "%Y-%m-%d", "%Y/%m/%d", "%Y.%m.%d", "%d.%m.%Y", "%d-%m-%Y", "%d/%m/%Y", "%m/%d/%Y",
    "%d-%b-%Y", "%d %B %Y",
]  # fmt: skip
CLOCKS = ["%H:%M:%S", "%H:%M:%S.%f", "%H:%M", "%I:%M:%S %p", "%I:%M:%S.%f%p", "%I:%M %p"]
moments = st.datetimes(datetime(2001, 1, 1), datetime(2037, 12, 31)).map(
    lambda d: d.replace(microsecond=d.microsecond // 1000 * 1000)
)


def cut(moment, clock):
    """What is left of a moment that a clock writes."""
    less = {} if "%f" in clock else {"microsecond": 0}
    less |= {} if "%S" in clock else {"second": 0}
    return moment.replace(**less)


@pytest.mark.parametrize("between", [" ", "T", ", "])
@pytest.mark.parametrize("clock", CLOCKS)
@settings(max_examples=12)
@given(
    begin=moments,
    steps=st.lists(st.floats(0.0, 3e5), min_size=1, max_size=4),
    date=st.sampled_from(DATES),
)
def test_a_date_with_a_time_is_the_seconds_from_the_first_day(between, clock, begin, steps, date):
    moved = [begin + timedelta(seconds=round(sum(steps[:k]), 3)) for k in range(len(steps) + 1)]
    if "/%Y" in date and len({(d.day, d.month) for d in moved}) > 1:
        # the day or the month may come first: a thirteenth decides
        moved = [d.replace(day=13 + d.day % 15) for d in moved]
    cells = [d.strftime(f"{date}{between}{clock}") for d in moved]
    midnight = cut(moved[0], clock).replace(hour=0, minute=0, second=0, microsecond=0)
    expected = [(cut(d, clock) - midnight).total_seconds() for d in moved]
    assert stamps_of(cells) == pytest.approx(expected, abs=1e-6)
    # a comma before the parts of a second, and spaces around
    commas = [
        f" {cell.replace('.', ',') if '%f' in clock and '.' not in date else cell} "
        for cell in cells
    ]
    assert stamps_of(commas) == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("clock", CLOCKS)
@settings(max_examples=12)
@given(st.lists(moments, min_size=1, max_size=4))
def test_a_time_of_day_is_the_seconds_from_midnight(clock, moved):
    cells = [d.strftime(clock) for d in moved]
    expected = [
        (cut(d, clock) - d.replace(hour=0, minute=0, second=0, microsecond=0)).total_seconds()
        for d in moved
    ]
    assert stamps_of(cells) == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("clock", ["%H:%M:%S.%f", "%I:%M:%S %p"])
@settings(max_examples=12)
@given(
    begin=moments,
    offsets=st.lists(st.integers(-14 * 4, 14 * 4), min_size=2, max_size=4),
    style=st.sampled_from(["colon", "plain", "space"]),
)
def test_a_time_with_its_zone_counts_in_universal_time(clock, begin, offsets, style):
    cells, expected = [], []
    for k, quarters in enumerate(offsets):
        zone = timezone(timedelta(minutes=15 * quarters))
        here = (begin + timedelta(hours=k)).replace(tzinfo=UTC).astimezone(zone)
        text = here.strftime("%z")
        text = {"colon": f"{text[:3]}:{text[3:]}", "plain": text, "space": f" {text}"}[style]
        cells.append(here.strftime(f"%Y-%m-%dT{clock}") + text)
        expected.append(cut(begin + timedelta(hours=k), clock))
    day = datetime.strptime(cells[0][:10], "%Y-%m-%d")
    assert stamps_of(cells) == pytest.approx([(d - day).total_seconds() for d in expected])


@pytest.mark.parametrize("zone", ["Z", " Z", "UTC", " UTC", " GMT", "+00:00", "-0000"])
def test_universal_time_is_named_in_many_ways(zone):
    assert stamps_of([f"2026-11-22 18:00:01{zone}"]) == pytest.approx([64801.0])


def test_of_a_date_with_slashes_the_reading_with_the_fewest_days_is_taken():
    assert np.diff(stamps_of(["11/12/2026", "11/13/2026"])) == pytest.approx([86400.0])
    assert np.diff(stamps_of(["11/12/2026", "12/12/2026"])) == pytest.approx([86400.0])
    assert np.diff(stamps_of(["12/11/2026", "12/12/2026"])) == pytest.approx([86400.0])
    # with points, the day comes first
    assert np.diff(stamps_of(["11.12.2026", "11.01.2027"])) == pytest.approx([31 * 86400.0])


@pytest.mark.parametrize(
    "cells",
    [
        ["2026-13-01"], ["2026-02-30"], ["31.04.2026"], ["13/13/2026"], ["1 Foo 2026"],
        ["2026-11-22 18"], ["2026-11-22 18:0"], ["2026-11-22T18:00:00 XM"], ["22.11-2026"],
        ["2026-11-22", "x"], ["18:00", "x"], ["18:00", "2026-11-22"], ["26-11-22"], [""],
        ["2026-11-22 18:00:00+1"],
    ],
)  # fmt: skip
def test_what_no_calendar_or_clock_writes_is_no_time(cells):
    assert stamps_of(cells) is None


@pytest.mark.parametrize("separator", ["\t", ",", ";", "|"])
def test_a_blank_between_date_and_time_is_no_separator(separator, tmp_path):
    """Beside tabs, the position was read as the time of day."""
    begin = datetime(2026, 11, 20, 23, 59, 58)
    stamps = [begin + timedelta(milliseconds=20 * k) for k in range(200)]
    rows = [separator.join((f"{s:%Y-%m-%d %H:%M:%S.%f}", f"{k / 8}", "2")) for k, s in
            enumerate(stamps)]  # fmt: skip
    path = tmp_path / "log.txt"
    path.write_text("\n".join([separator.join(("Time", "Pos", "F")), *rows]) + "\n")
    log = open_log(path, "log.txt")
    assert log.names == ("Time", "Pos", "F") and dict(log.units) == {"Time": "s"}
    values = read_columns(path, "log.txt", {"Time": "channels.time", "Pos": ""}).values
    assert np.diff(values["Time"]) == pytest.approx(0.02)
    assert np.array_equal(values["Pos"], np.arange(200) / 8)
