"""Tables as loggers and office programs leave them: empty cells, names, units, printed digits."""

import numpy as np
import openpyxl
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.column_names import likeness, unit_in_name
from teleopdesign.measurement.doors._cells import NO_READING
from teleopdesign.measurement.survey import Choices, survey_log
from teleopdesign.measurement.tables import open_log, read_columns

T = np.arange(400) / 200.0


def written(folder, ending, header, rows):
    """A table of cells as a text or a workbook."""
    path = folder / f"log{ending}"
    if ending == ".xlsx":
        book = openpyxl.Workbook()
        for row in [header, *rows]:
            book.active.append(row)
        book.save(path)
    else:
        path.write_text("\n".join(",".join(map(str, row)) for row in [header, *rows]) + "\n")
    return path


@pytest.mark.parametrize("ending", [".csv", ".xlsx"])
@pytest.mark.parametrize("word", sorted(NO_READING))
def test_a_word_for_no_reading_is_an_empty_cell(tmp_path, ending, word):
    rows = [[k / 100, float(k)] for k in range(80)]
    rows[40][1] = word.upper()
    path = written(tmp_path, ending, ["t", "x"], rows)
    values = read_columns(path, path.name, {"t": "", "x": ""}).values
    assert np.flatnonzero(np.isnan(values["x"])).tolist() == [40]
    assert np.array_equal(values["t"], [row[0] for row in rows])


@pytest.mark.parametrize("ending", [".csv", ".xlsx"])
def test_columns_of_one_name_are_counted(tmp_path, ending):
    rows = [[k / 100, float(k), -float(k)] for k in range(80)]
    path = written(tmp_path, ending, ["t", "Torque [Nm]", "Torque [Nm]"], rows)
    log = open_log(path, path.name)
    assert log.names == ("t", "Torque [Nm] #1", "Torque [Nm] #2")
    second = log.read({"Torque [Nm] #2": ""})["Torque [Nm] #2"]
    assert np.array_equal(second, [row[2] for row in rows])
    assert unit_in_name(log.names[2]) == "Nm"
    with pytest.raises(ExperimentError, match=r"found 2 columns .*, expected one of .*#1.*#2"):
        read_columns(path, path.name, {"Torque [Nm]": "channels.force"})


def test_where_nothing_can_be_used_the_reason_of_each_column_is_reported(tmp_path):
    rows = [[k / 100, "left", "up"] for k in range(80)]
    path = written(tmp_path, ".xlsx", ["t", "x", "u"], rows)
    with pytest.raises(ExperimentError, match="found no sheet"):
        open_log(path, path.name)
    rows = [[k / 100, k % 7, k % 5, "up"] for k in range(80)]
    rows[50][1] = "left"
    path = written(tmp_path, ".csv", ["t", "x", "u", "way"], rows)
    with pytest.raises(ExperimentError, match="'x': row 51: found \"left\", expected a number"):
        survey_log(open_log(path, path.name), path.name, Choices(position="x"))


@pytest.mark.parametrize(
    ("encoding", "names"),
    [
        ("euc_jp", ("時間 (s)", "関節角度 (deg)", "トルク指令 (Nm)", "操作力 (Nm)")),
        ("big5", ("時間 (s)", "位置 (deg)", "扭矩 (Nm)", "手力 (Nm)")),
        ("euc_kr", ("시간 (s)", "위치 (deg)", "토크 (Nm)", "손힘 (Nm)")),
        ("utf-16", ("時間 (s)", "угол (град)", "토크 (Nm)", "Kraft der Hand (Nm)")),
    ],
)
def test_names_are_read_in_the_encoding_that_they_were_written_in(tmp_path, encoding, names):
    rows = np.column_stack([T, np.sin(T), np.cos(T), np.sin(2 * T)])
    text = ",".join(names) + "\n" + "".join(",".join(f"{x:.6f}" for x in r) + "\n" for r in rows)
    path = tmp_path / "log.csv"
    path.write_bytes(text.encode(encoding))
    log = open_log(path, path.name)
    assert tuple(log.names) == names
    assert any(note.startswith("text in ") for note in log.notes)
    quantities = ("time", "position", "actuator_force", "interaction_force")
    matches = [max(quantities, key=lambda q: likeness(name, q)) for name in names]
    assert matches == list(quantities)


@pytest.mark.parametrize("more", [0, 1, 2])
def test_a_letter_cut_where_the_first_look_ends_leaves_the_text_in_utf_8(tmp_path, more):
    path = tmp_path / "log.csv"
    header = "時間 (s),位置 (deg),状態" + "x" * more + "\n"
    path.write_text(header + "".join(f"{k / 1000:.4f},{k},力\n" for k in range(9000)), "utf-8")
    assert open_log(path, path.name).names[0] == "時間 (s)"


@pytest.mark.parametrize("mark", [b"\xff\xfe", b"\xfe\xff"])
@pytest.mark.parametrize("seed", [1, 2])
def test_bytes_that_begin_as_utf_16_and_go_on_at_random_are_no_text(tmp_path, mark, seed):
    path = tmp_path / "log.csv"
    path.write_bytes(mark + np.random.default_rng(seed).bytes(3000))
    with pytest.raises(ExperimentError, match=r"log.csv: not a text \(it begins as UTF-16 does"):
        open_log(path, path.name)


@pytest.mark.parametrize("late", ["name", "reading"])
def test_a_column_with_a_name_or_a_reading_stays_a_column(tmp_path, late):
    rows = [f"{k / 100},{k % 9}," for k in range(9000)]
    rows[-1] += "5" if late == "reading" else ""
    path = tmp_path / "log.csv"
    path.write_text("\n".join([f"time,q,{'note' if late == 'name' else ''}", *rows]) + "\n")
    assert len(open_log(path, "log.csv").names) == 3
