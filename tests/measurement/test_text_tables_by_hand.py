"""Text tables line by line: encodings, rows of names and units, lines that are no rows, pairs."""

import numpy as np
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.doors._encoding import encoding_of
from teleopdesign.measurement.doors._header import is_row_of_units, names_and_units
from teleopdesign.measurement.doors._pairs import names_in_lines, pairs_of
from teleopdesign.measurement.tables import open_log


@pytest.mark.parametrize(
    ("encoding", "text"),
    [
        ("utf-8", "Zeit (s),Kraft (N),größe µm"),
        ("utf-8-sig", "Zeit,größe"),
        ("utf-16", "Zeit (s),größe (µm),Kraft"),
        ("cp1252", "Zeit;Übersetzung;Größe (µm);Drehmoment °"),
        ("cp1252", "Temps;Vitesse;Déplacement é è à"),
        ("cp932", "時間,位置,速度,トルク"),
        ("cp932", "じかん,ちから"),
        ("gb18030", "时间,位置,速度,电流,力矩"),
        ("big5", "時間,位置,角度,電流,轉速"),
        ("cp949", "시간,위치,토크,전류"),
        ("cp1251", "время;положение;скорость;момент"),
    ],
)
def test_the_encoding_of_a_header_is_that_in_which_it_makes_words(encoding, text):
    raw = f"{text}\n0,1,2\n".encode(encoding)
    assert encoding_of(raw, "log", whole=True) == encoding
    # the first bytes of a file may end within a letter
    if encoding.startswith(("utf", "cp125")):
        return
    cut = f"0,1\n{text}".encode(encoding)[:-1]
    assert encoding_of(cut, "log", whole=False) == encoding


def test_bytes_that_are_no_text_are_refused_and_odd_letters_are_western():
    with pytest.raises(ExperimentError, match=r"not a text \(byte 3 is 0\)"):
        encoding_of(b"abc\0de", "log", whole=True)
    for mark in (b"\xff\xfe", b"\xfe\xff"):
        with pytest.raises(ExperimentError, match="begins as UTF-16 does, and does not go on so"):
            encoding_of(mark + bytes(range(1, 250)) * 4, "log", whole=True)
    assert encoding_of("a ¤ b ¤".encode("cp1252"), "log", whole=True) == "cp1252"
    assert encoding_of(b"plain", "log", whole=True) == "utf-8"


@pytest.mark.parametrize(
    ("rows", "names", "units"),
    [
        ([["t", "x"]], ("t", "x"), ()),
        ([["t", "x"], ["s", "mm"]], ("t", "x"), ("s", "mm")),
        ([["t", "x"], ["[s]", "[-]"]], ("t", "x"), ("s", "-")),
        ([["t", "x"], ["(s)", "(counts)"]], ("t", "x"), ("s", "counts")),
        ([["time", "", "x"], ["s", "", "mm"]], ("time", "", "x"), ("s", "", "mm")),
        ([["Motor", "Bench", ""], ["Angle", "Angle", "Time"]],
         ("Motor Angle", "Bench Angle", "Time"), ()),
        ([["Motor", "", "Bench", ""], ["Angle", "Force", "Angle", "Force"]],
         ("Motor Angle", "Motor Force", "Bench Angle", "Bench Force"), ()),
        ([["Motor", "", "Bench", ""], ["q", "tau", "q", "tau"], ["rad", "N", "rad", "N"]],
         ("Motor q", "Motor tau", "Bench q", "Bench tau"), ("rad", "N", "rad", "N")),
        ([["Motor", "Bench", "Time"], ["Angle", "Force", ""]], ("Angle", "Force", "Time"), ()),
        ([["only", "", ""], ["Angle", "Angle", "Force"]], ("Angle", "Angle", "Force"), ()),
        ([["a", "b"], ["c", "d"]], ("c", "d"), ()),
    ],
)  # fmt: skip
def test_rows_above_a_table_are_titles_names_and_units(rows, names, units):
    assert names_and_units(rows) == (names, units)


@pytest.mark.parametrize(
    ("cells", "names", "is_units"),
    [
        (["s", "mm"], ["t", "x"], True),
        (["", ""], ["t", "x"], False),
        (["s", "mm"], ["", ""], False),
        (["[foo]", "[bar]"], ["t", "x"], True),
        (["[foo]", "bar"], ["t", "x"], False),
        (["Position", "Force"], ["t", "x"], False),
        (["s", "mm", "N", "odd"], ["Time", "Way", "Pull", "Else"], True),
    ],
)
def test_a_row_is_one_of_units_where_most_cells_are(cells, names, is_units):
    assert is_row_of_units(cells, names) is is_units


def table(path, lines, header="t,x"):
    path.write_text(header + "\n" + "\n".join(lines) + "\n")
    return open_log(path, "log.csv")


def rows(count):
    return [f"{0.01 * k:.2f},{k % 7}" for k in range(count)]


@pytest.mark.parametrize(("strays", "count", "fits"), [
    (1, 100, True), (10, 100, True), (11, 100, False), (11, 1200, True), (12, 1200, False),
])  # fmt: skip
@pytest.mark.parametrize("line", ["restarted", "# a remark"])
def test_a_few_lines_that_are_no_rows_are_left_out(tmp_path, strays, count, fits, line):
    lines = rows(count)
    for k in range(strays):
        lines.insert(count - 50 + 3 * k, line)
    log = table(tmp_path / "log.csv", lines)
    if not fits and line == "restarted":
        with pytest.raises(ExperimentError, match="found 1 cells, expected 2 as in the header"):
            log.read({"x": "channels.position"})
        return
    x = log.read({"x": "channels.position"})["x"]
    assert np.asarray(x).tolist() == [k % 7 for k in range(count)]
    number = "a line that is no row" if strays == 1 else f"{strays} lines that are no rows"
    note = (f"{number}, the first one before row {count - 49}: left out",)
    assert log.left_out() == (note if line == "restarted" else ())


def test_a_last_row_that_was_cut_off_is_left_out_and_reported(tmp_path):
    log = table(tmp_path / "log.csv", [*rows(100), "1.0"])
    assert "a last row that was cut off" in log.notes
    assert len(log.read({"x": ""})["x"]) == 100 and log.left_out() == ()
    assert "a last row that was cut off" not in table(tmp_path / "b.csv", rows(100)).notes


def test_a_row_may_end_with_a_separator_and_with_no_more(tmp_path):
    log = table(tmp_path / "log.csv", [f"{r}," for r in rows(100)])
    assert len(log.read({"x": ""})["x"]) == 100
    wide = rows(100)
    wide[70] += ",9"
    with pytest.raises(ExperimentError, match="row 71: found 3 cells, expected 2 as in the header"):
        table(tmp_path / "wide.csv", wide).read({"x": ""})


@pytest.mark.parametrize(
    ("separator", "comma", "note"),
    [
        (",", False, None),
        (";", False, "semicolons between columns"),
        (";", True, "semicolons between columns, decimal comma"),
        ("\t", True, "tabs between columns, decimal comma"),
        ("|", False, "bars between columns"),
        (" ", False, "spaces between columns"),
    ],
)
def test_how_a_table_is_written_is_reported_where_it_is_not_the_usual_way(
    tmp_path, separator, comma, note
):
    lines = [r.replace(",", separator) for r in rows(100)]
    lines = [r.replace(".", ",") if comma else r for r in lines]
    log = table(tmp_path / "log.csv", lines, f"t{separator}x")
    assert log.notes == (() if note is None else (note,))
    read = log.read({"t": "", "x": ""})
    assert np.asarray(read["t"]) == pytest.approx(0.01 * np.arange(100))
    assert np.asarray(read["x"]).tolist() == [k % 7 for k in range(100)]


def test_names_and_values_in_each_line_are_columns():
    assert pairs_of("t=0.5s, x: -3 mm") == []  # a space before the unit is none of a pair
    assert pairs_of("t=0.5s, x: -3mm") == [("t", "0.5", "s"), ("x", "-3", "mm")]
    assert pairs_of("t=0.5") == [] and pairs_of("t=0.5 and x=3") == []
    lines = ["x=1", *[f"t={k}ms x={k * k}N" for k in range(20)], "restarted"]
    assert names_in_lines(lines) == {"t": "ms", "x": "N"}
    assert names_in_lines(lines[:3]) == {}  # two lines are too few
    assert names_in_lines([*lines, *["restarted"] * 3]) == {"t": "ms", "x": "N"}
    assert names_in_lines([*lines, *["restarted"] * 4]) == {}
    assert names_in_lines([f"t={k} t={k}" for k in range(20)]) == {}


def test_two_more_cells_are_too_many_though_the_last_is_empty(tmp_path):
    wide = rows(100)
    wide[70] += ",9,"
    with pytest.raises(ExperimentError, match="row 71: found 4 cells, expected 2 as in the header"):
        table(tmp_path / "wide.csv", wide).read({"x": ""})
