"""Names of columns in comments that number them, as programs of robots write above their logs."""

import pytest

from teleopdesign.measurement.doors._header import names_by_number
from teleopdesign.measurement.doors.text import open_text

LINES = (
    "logfile of a robot:",
    "1    time 3.042 sec, by robot 81",
    "2 3  (mission 0), state 8",
    "4  5 Motor voltage [V] left, right: 1.00 1.07",
    "6 8  Wheel velocity [m/s] left, right: 0.02 0.01 delay 0.02 (sec)",
    "9 10 Pose x,tilt [m,rad]: 0.87 3.04",
)
NAMES = (
    "time 3.042 sec", "(mission 0)", "state 8", "Motor voltage left", "Motor voltage right",
    "Wheel velocity left, right", "Wheel velocity left, right", "Wheel velocity left, right",
    "Pose x", "Pose tilt",
)  # fmt: skip


def test_a_list_of_columns_names_them_with_units():
    assert names_by_number(LINES, 10) == (
        NAMES,
        ("", "", "", "V", "V", "m/s", "m/s", "m/s", "m", "rad"),
    )


@pytest.mark.parametrize(
    "lines",
    [
        (*LINES[:3], *LINES[4:]),  # a column that no line names
        LINES[2:],  # not from the first one
        LINES[:-1],  # not to the last one
        ("10 kHz", "2 motors", "8192 counts per turn"),
        ("1 run of 10",),
        (),
    ],
)
def test_numbers_of_other_things_name_no_columns(lines):
    assert names_by_number(lines, 10) is None


@pytest.mark.parametrize(
    ("first", "second", "names"),
    [
        ("% column 1: t (s)", "% columns 2, 3: q [rad], u", ("t", "columns")),
        ("# 0: t", "# 1 = q", ("t", "q")),
        ("// 1) t", "// 2) angle", ("t", "angle")),
    ],
)
def test_the_numbers_are_written_in_many_ways(first, second, names, tmp_path):
    width = 3 if "columns 2, 3" in second else 2
    rows = [" ".join(f"{0.1 * k + j:g}" for j in range(width)) for k in range(80)]
    log = tmp_path / "log.txt"
    log.write_text("\n".join([first, second, *rows]))
    read = open_text(log, "log.txt")
    assert read.names[0] == names[0]
    assert read.names[1:] == (("q", "u") if width == 3 else names[1:])
    assert "no header: columns are named by their number" not in read.notes
