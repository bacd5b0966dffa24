"""Rows above a table as benches write them: groups, units that are unknown, rows of two names."""

import numpy as np
import openpyxl
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.base.units import is_unit, parse_unit
from teleopdesign.measurement.column_names import ALIASES, bare_name, unit_in_name, unit_of_text
from teleopdesign.measurement.doors._cells import is_number, number_of
from teleopdesign.measurement.doors._header import names_and_units
from teleopdesign.measurement.tables import open_log

ROWS = [[k / 100, k % 7, -float(k), 30.5] for k in range(80)]


def written(folder, ending, head):
    """Rows of text above rows of numbers, in a text or a workbook."""
    path = folder / f"log{ending}"
    if ending == ".xlsx":
        book = openpyxl.Workbook()
        for row in [*head, *ROWS]:
            book.active.append([cell or None if isinstance(cell, str) else cell for cell in row])
        book.save(path)
    else:
        path.write_text("\n".join("\t".join(map(str, row)) for row in [*head, *ROWS]) + "\n")
    return open_log(path, path.name)


@pytest.mark.parametrize("ending", [".txt", ".xlsx"])
@pytest.mark.parametrize("form", ["[{}]", "{}", "({})", "<{}>"])
def test_a_row_of_units_may_hold_one_that_is_not_known(tmp_path, ending, form):
    units = ["s", "degrees", "Amps", "°C"]
    log = written(tmp_path, ending, [["Time", "Angle", "Current", "Temp"], map(form.format, units)])
    assert log.names == ("Time", "Angle", "Current", "Temp")
    assert log.units == {"Time": "s", "Angle": "deg", "Current": "A", "Temp": "°C"}


@pytest.mark.parametrize("ending", [".txt", ".xlsx"])
def test_columns_of_one_name_take_the_title_of_their_group(tmp_path, ending):
    head = [
        ["Bench 3, run 12", "", "", ""],
        ["", "Motor", "", "Bench"],
        ["Time", "Angle", "Current", "Angle"],
        ["s", "deg", "A", "deg"],
    ]
    log = written(tmp_path, ending, head)
    assert log.names == ("Time", "Motor Angle", "Current", "Bench Angle")
    assert log.units["Bench Angle"] == "deg"


@pytest.mark.parametrize(
    ("rows", "names"),
    [
        # a motion capture: names of markers, below them those of coordinates
        ([("Frame#", "Time", "Hand", ""), ("", "", "X1", "Y1")], ("Frame#", "Time", "X1", "Y1")),
        # columns of two levels that a frame wrote, with the name of its index in a row below
        (
            [("joint", "j1", "j1", "j2"), ("signal", "q", "tau", "q"), ("t", "", "", "")],
            ("t", "j1 q", "tau", "j2 q"),
        ),
        ([("Title", "", "", ""), ("t", "q", "", "u")], ("t", "q", "", "u")),
        # letters that are units as well stay names
        ([("Motor", "Bench", "Test", "3"), ("t", "q", "A", "V")], ("t", "q", "A", "V")),
    ],
)
def test_rows_of_names(rows, names):
    assert names_and_units(rows)[0] == names


@pytest.mark.parametrize(
    ("name", "bare", "unit"),
    [
        ("angle / °", "angle", "°"), ("speed / (°/s)", "speed", "°/s"), ("t / s", "t", "s"),
        ("pos/vel", "pos/vel", None), ("run1/joint", "run1/joint", None),
    ],
)  # fmt: skip
def test_a_unit_behind_a_slash(name, bare, unit):
    assert bare_name(name) == bare and unit_in_name(name) == unit


def test_units_in_chinese_and_french():
    assert unit_of_text("度/秒") == "deg/s" and unit_of_text("tr/min") == "rpm"


@pytest.mark.parametrize(
    ("cell", "value"), [("1,000.5", 1000.5), ("-12,345.", -12345.0), ("1,234,567", 1234567.0)]
)
def test_thousands_with_commas_between(cell, value):
    assert is_number(cell, comma=False) and number_of(cell) == value


@pytest.mark.parametrize(
    "cell", ["1,00.5", "1,0000", "1,000,5", "a,000", "0,5", "1,000", "0,123", "0,123.4"]
)
def test_other_commas_are_no_thousands(cell):
    assert not is_number(cell, comma=False) and number_of(cell) == cell


def test_thousands_are_read_from_a_table(tmp_path):
    path = tmp_path / "log.csv"
    lines = [f'"{1e3 * r[0] + 900:,.1f}","{r[2] - 990:,.2f}"' for r in ROWS]
    path.write_text("\n".join(['"Time (ms)","Angle (deg)"', *lines]) + "\n")
    log = open_log(path, "log.csv")
    wanted = {"Time (ms)": "", "Angle (deg)": ""}
    assert np.allclose(log.read(wanted)["Time (ms)"], [1e3 * r[0] + 900 for r in ROWS])
    assert np.allclose(log.read(wanted)["Angle (deg)"], [r[2] - 990 for r in ROWS])


@pytest.mark.parametrize("alias", sorted(ALIASES))
def test_no_spelling_of_a_loggers_word_is_a_unit_of_another_size(alias):
    """ "Grad" was a gigaradian, "1/min" a sixtieth of a radian a second, "MA" a megaampere."""
    meant = ALIASES[alias]
    for text in {alias, alias.upper(), alias.capitalize(), alias.title()} - {"NM"}:
        unit = unit_of_text(text)
        assert unit == meant or parse_unit(unit) == parse_unit(meant), text


@pytest.mark.parametrize(
    ("name", "quantity", "unit"),
    [("Winkel [Grad]", "position", "deg"), ("Winkel (Grad)", "position", "deg"),
     ("Geschwindigkeit [Grad/s]", "velocity", "deg/s"), ("n [1/min]", "velocity", "rpm"),
     ("Umdrehungen (Umdr)", "position", "turns"), ("Drehmoment [Newtonmeter]", "force", "Nm")],
)  # fmt: skip
def test_german_units_are_those_of_a_german(name, quantity, unit):
    assert unit_in_name(name, quantity, "revolute") == unit


@pytest.mark.parametrize("text", ["Grad", "Mrad", "Mm", "Gs", "MA", "crad"])
def test_a_prefix_that_nobody_uses_is_a_letter_of_another_word(text):
    assert not is_unit(text)


def scope(folder, labels, rows, *, separator=";"):
    """A log as a scope of a controller writes it: each row above the numbers has its label."""
    head = [["Name", "Scope 1"], ["File", "C:\\scope"], [], *labels, []]
    path = folder / "scope.csv"
    lines = (separator.join(map(str, row)) for row in [*head, *rows])
    path.write_text("\n".join(lines) + "\n")
    return open_log(path, path.name)


NUMBERS = [[k, 0.5 + k % 7, -float(k % 5)] for k in range(80)]


def test_rows_with_labels_name_the_columns_and_the_unit_of_the_time(tmp_path):
    labels = [
        ["Name", "Axis 1.ActPos", "Axis 1.ActTorque"],
        ["SymbolComment", "", ""],
        ["Data-Type", "REAL64", "REAL64"],
        ["SampleTime[ms]", 1, 1],
        ["VariableSize", 8, 8],
    ]
    log = scope(tmp_path, labels, NUMBERS)
    assert log.names == ("time", "Axis 1.ActPos", "Axis 1.ActTorque")
    assert log.units["time"] == "ms"
    columns = log.read({"time": "time", "Axis 1.ActTorque": "actuator_force"})
    np.testing.assert_array_equal(columns["time"], np.arange(80.0))
    np.testing.assert_array_equal(columns["Axis 1.ActTorque"], [row[2] for row in NUMBERS])


def test_a_label_before_each_column_stands_over_its_times(tmp_path):
    twice = [["Name", "pos", "Name", "cur"], ["SampleTime[ms]", 1, "SampleTime[ms]", 1]]
    units = [["Unit", "mm", "Unit", "A"], ["Start", 3, "Monday", "12:00"]]
    rows = [[k, x, k, y] for k, x, y in NUMBERS]
    log = scope(tmp_path, [units[1], *twice, units[0]], rows, separator="\t")
    assert log.names == ("time", "pos", "cur")
    assert log.units == {"time": "ms", "pos": "mm", "cur": "A"}


def test_a_first_column_called_name_is_no_label_where_nothing_else_is_labelled(tmp_path):
    path = tmp_path / "log.csv"
    rows = [["name", "x", "f"], ["-", "mm", "N"], *NUMBERS]
    path.write_text("\n".join(",".join(map(str, row)) for row in rows) + "\n")
    assert open_log(path, path.name).names == ("name", "x", "f")


def test_a_broken_first_cell_does_not_move_the_first_row(tmp_path):
    path = tmp_path / "log.csv"
    rows = [["t", "x", "f"], ["abc", 1.0, 2.0], *NUMBERS]
    path.write_text("\n".join(",".join(map(str, row)) for row in rows) + "\n")
    log = open_log(path, path.name)
    assert log.names == ("t", "x", "f")
    with pytest.raises(ExperimentError, match="row 1.*abc"):
        log.read({"t": "time", "x": "position"})


@pytest.mark.parametrize("separator", [",", "\t", " "])
@pytest.mark.parametrize("hole", ["", "nan"])
def test_a_row_may_end_in_a_semicolon_as_in_a_matrix(tmp_path, separator, hole):
    """The last column held "no numbers" before."""
    rows = [separator.join(map(str, row)) + (";" if k % 2 else "; ") for k, row in enumerate(ROWS)]
    if hole and separator != " ":
        rows[9] = separator.join(["0.09", "2", "-9", hole]) + ";"
    path = tmp_path / "log.txt"
    path.write_text("\n".join(["%" + separator.join(["time", "angle", "current", "heat"]), *rows]))
    log = open_log(path, path.name)
    assert log.names == ("time", "angle", "current", "heat")
    columns = log.read(dict.fromkeys(log.names, ""))
    for name, values in zip(log.names, np.array(ROWS).T, strict=True):
        read = np.delete(columns[name], 9)
        np.testing.assert_allclose(read, np.delete(values, 9))


def test_a_semicolon_that_separates_stays(tmp_path):
    path = tmp_path / "log.txt"
    path.write_text("\n".join(["t;x;F;", *(f"{k},5;{k % 7};{-k};" for k in range(80))]))
    log = open_log(path, path.name)
    assert log.names[:3] == ("t", "x", "F")
    assert log.read({"t": ""})["t"][2] == 2.5
