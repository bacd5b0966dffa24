"""Text tables, line by line: what is a header, a unit, a row, a message, and how many may be."""

import gzip

import numpy as np
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.doors import text
from teleopdesign.measurement.doors._dialect import dialect_of
from teleopdesign.measurement.doors._header import (
    bare_unit,
    is_row_of_units,
    is_unit_cell,
    names_and_units,
    names_of_labelled_rows,
)


def dialect(whole):
    return dialect_of(whole.split("\n"), "utf-8", "log.csv")


def opened(path, whole):
    path.write_text(whole)
    return text.open_text(path, path.name)


ROWS = "0;1;2\n1;3;4\n2;5;6"


def test_one_row_alone_tells_its_separator():
    result = dialect("0.1;2;3")
    assert (result.separator, result.comma, result.first, result.named) == (";", False, 0, False)
    assert result.header == ("column 1", "column 2", "column 3") and result.remarks == ()


@pytest.mark.parametrize(
    ("above", "header", "units"),
    [
        ("t;x;F", ("t", "x", "F"), ()),
        ("t;x;F\ns;mm;N", ("t", "x", "F"), ("s", "mm", "N")),
        ("t;x;F\n[s];[mm];[N]", ("t", "x", "F"), ("s", "mm", "N")),
        ("Y_Unit_Label;mm;N\nX_Value;x;F", ("X_Value", "x", "F"), ("", "mm", "N")),
        ("a title\nt;x;F", ("t", "x", "F"), ()),
        ("t;x;F;Comment", ("t", "x", "F"), ()),
        ("t;x;F;", ("t", "x", "F"), ()),
        ("# t;x;F", ("t", "x", "F"), ()),
        ("% t;x;F", ("t", "x", "F"), ()),
        ("// t;x;F", ("t", "x", "F"), ()),
        (";Run 7;\nt;x;F", ("t", "x", "F"), ()),
        (";Run 7;\n;x;F", ("column 1", "x", "F"), ()),
        ("t;Motor;\n;x;F", ("t", "x", "F"), ()),
        (";Motor;Motor\nt;x;F", ("t", "x", "F"), ()),
        ("t;Motor;Bench\n;x;x", ("t", "x", "x"), ()),
        ("a;Motor;Bench\nt;x;x", ("t", "Motor x", "Bench x"), ()),
        ("a;Motor;\nt;x;x", ("t", "Motor x", "Motor x"), ()),
    ],
)
def test_names_and_units_stand_above_a_table_in_many_ways(above, header, units):
    result = dialect(f"{above}\n{ROWS}")
    assert result.first == above.count("\n") + 1 and result.separator == ";"
    assert tuple(n.partition(" #")[0] for n in result.header) == header
    assert result.units == units
    assert result.remarks == tuple(above.split("\n"))


def test_numbers_above_a_table_are_no_rows_of_it():
    """Another number of cells, or fewer than three such rows; two rows alone are a table."""
    assert dialect("rate;500\nt;x\n0;1\n1;2\n2;3").first == 2
    assert dialect("1;2\n3;4\nt;x\n0;1\n1;2\n2;3").first == 3
    assert dialect("1;2\n3;4\n5;6\nt;x\n0;1\n1;2\n2;3").first == 0
    assert dialect("5;6\nt;x\n0;1\n1;2").first == 2
    assert dialect("t;x\n\n0;1\n\n1;2\n\n2;3").first == 2, "empty lines part no table"


@pytest.mark.parametrize(
    ("rows", "names", "units"),
    [
        (["Name;x;F", "Data-Type;REAL64;REAL64"], ("time", "x", "F"), ("", "", "")),
        (["Name;;F", "Data-Type;;REAL64"], ("time", "", "F"), ("", "", "")),
        (["Name;x;F", "Unit;mm;N"], ("time", "x", "F"), ("", "mm", "N")),
        (["Name;x;F", "Unit;(mm);words"], ("time", "x", "F"), ("", "mm", "")),
        (["Name;x;F", "SampleTime[ms];1;1"], ("time", "x", "F"), ("ms", "", "")),
        (["Name;x;F", "SampleTime[ms];1;1", "Unit;mm;N"], ("time", "x", "F"), ("ms", "mm", "N")),
        (["Name;x;Name;F", "Unit;mm;Unit;N"], ("time", "x", "time", "F"), ("", "mm", "", "N")),
        (
            ["Name;x;Name;F", "SampleTime[us];1;SampleTime[us];1"],
            ("time", "x", "time", "F"),
            ("us", "", "us", ""),
        ),
    ],
)
def test_rows_with_labels_say_what_they_hold(rows, names, units):
    assert names_of_labelled_rows([tuple(r.split(";")) for r in rows]) == (names, units)


def test_rows_without_labels_say_nothing():
    for rows in (["t;x", "s;mm"], ["Name;x", "Other;y"], ["Name;x"], ["Name;x;Name", "Unit;mm;N"]):
        assert names_of_labelled_rows([tuple(r.split(";")) for r in rows]) is None


def test_rows_of_numbers_under_labels_belong_to_the_labels():
    """Three of them: the times begin where the first cell is a number."""
    labels = "Name;x;F\nSampleTime[ms];1;1\nDataSize;8;8\nOffset;0;0"
    result = dialect(f"{labels}\n0;1;2\n1;3;4\n2;5;6")
    assert result.first == 4 and result.header == ("time", "x", "F")
    assert result.units == ("ms", "", "")


def test_labels_of_which_no_row_begins_with_a_number_end_where_numbers_begin():
    result = dialect("Name;x;F\nData-Type;a;b\nr1;1;2\nr2;3;4\nr3;5;6")
    assert result.first == 2


def test_a_row_of_units_is_all_units_or_mostly_with_fewer_above():
    names = ["t", "x", "speed", "F"]
    assert is_row_of_units(["s", "mm", "", "N"], names)
    assert is_row_of_units(["[s]", "[furlong]", "[x]", "[y]"], names)
    assert not is_row_of_units(["", "", "", ""], names) and not is_row_of_units(["s"], [""])
    assert is_row_of_units(["s", "mm", "furlong/h", "N"], names), "three of four, none above"
    assert not is_row_of_units(["s", "mm", "furlong", "day of"], ["one", "two", "three", "four"])
    assert not is_row_of_units(["s", "m", "words of", "N"], ["s", "m", "A", "V"])
    assert bare_unit("[mm]") == "mm" and bare_unit("(furlong)") == "furlong"
    assert all(map(is_unit_cell, ("", "[]", "-", "counts", "(mm)", "ticks")))
    assert not is_unit_cell("furlong")


def test_a_title_is_that_of_its_group_up_to_the_next():
    rows = [("Motor", "", "Bench", ""), ("Angle", "Torque", "Angle", "Speed"), ("deg", "", "", "")]
    names, units = names_and_units(rows)
    assert names == ("Motor Angle", "Torque", "Bench Angle", "Speed") and units[0] == "deg"
    assert names_and_units([("", "One", "", ""), ("a", "b", "a", "c")])[0] == ("a", "b", "a", "c")
    assert names_and_units([]) == ((), ())
    assert names_and_units([("s", "mm")]) == (("s", "mm"), ()), "one row is that of names"


# rows and messages


def rows_of(tmp_path, lines):
    """What is read of a table: its first column, and what is said of other lines."""
    log = opened(tmp_path / "log.csv", "".join(lines))
    return log.read({"t": ""})["t"].tolist(), log.left_out()


def test_messages_repeated_headers_and_comments_are_left_out(tmp_path):
    lines = ["t;x\n", "0;1\n", "\n", "# note;a\n", "t;x\n", "1;2\n", "stop\n", "2;3\n"]
    said = ("2 lines that are no rows, the first one before row 2: left out",)
    assert rows_of(tmp_path, lines) == ([0.0, 1.0, 2.0], said)
    assert rows_of(tmp_path, [*lines, "3"]) == ([0.0, 1.0, 2.0], said), "a last row was cut off"


@pytest.mark.parametrize("wrong", ["0;1;;\n", "0;1;2\n"])
def test_a_row_of_more_cells_than_the_header_is_refused_with_its_place(tmp_path, wrong):
    table = ["t;x\n", *["0;1\n"] * 4, wrong, *["0;1\n"] * 4]
    with pytest.raises(ExperimentError, match=r"row 5: found \d cells, expected 2"):
        rows_of(tmp_path, table)


@pytest.mark.parametrize(("rows", "most"), [(20, text.FEW_STRAYS), (5000, 50)])
def test_as_many_messages_are_left_out_as_are_few(tmp_path, rows, most):
    table = ["t;x\n", *["0;1\n"] * rows]
    after = ["0;1\n"] * 60
    assert f"{most} lines" in rows_of(tmp_path, [*table, *["stop\n"] * most, *after])[1][0]
    with pytest.raises(ExperimentError, match=f"row {rows + 1}: found 1 cells"):
        rows_of(tmp_path, [*table, *["stop\n"] * (most + 1), *after])


def test_only_a_plain_table_with_separators_may_end_in_a_row_that_was_cut_off(tmp_path):
    table = "t,x\n" + "".join(f"{k},{k + 1}\n" for k in range(5))
    assert opened(tmp_path / "a.csv", table).notes == ()
    assert opened(tmp_path / "b.csv", table + "5").notes == ("a last row that was cut off",)
    assert opened(tmp_path / "c.csv", table + "5\n\n").notes == ("a last row that was cut off",)
    spaces = table.replace(",", " ")
    assert opened(tmp_path / "d.csv", spaces + "5").notes == ("spaces between columns",)
    packed = tmp_path / "e.csv.gz"
    packed.write_bytes(gzip.compress(table.encode(), compresslevel=0))
    assert text.open_text(packed, "e").notes == ()


def test_a_decimal_comma_and_no_header_are_noted(tmp_path):
    log = opened(tmp_path / "a.csv", "0,5;1,5\n1,5;2,5\n2,5;3,5\n")
    assert log.notes == (
        "semicolons between columns, decimal comma",
        "no header: columns are named by their number",
    )
    values = log.read({"column 2": "x"})
    assert np.array_equal(values["column 2"], [1.5, 2.5, 3.5])


# names and values in each line


def test_four_fifths_of_the_lines_are_pairs_of_the_same_names(tmp_path):
    row = "t=1 x=2mm"
    for lines in ([row] * 4 + ["stop"], ["x=2mm", row, row, row, row]):
        log = opened(tmp_path / "a.txt", "\n".join(lines))
        assert log.names == ("t", "x") and log.units == {"x": "mm"}
        assert log.read({"x": ""})["x"].tolist() == [2.0] * 4
    for lines in ([row] * 7 + ["stop"] * 2, ["t=1 t=2"] * 3, [row] * 2):
        with pytest.raises(ExperimentError):
            opened(tmp_path / "a.txt", "\n".join(lines))
