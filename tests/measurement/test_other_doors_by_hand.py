"""Workbooks, JSON, MAT, numpy and HDF5 files of content that is written here."""

import datetime as dt
import json

import numpy as np
import pytest
from scipy.io import savemat

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.doors import arrays, json_records, matlab, workbook
from teleopdesign.measurement.numbers_in_cells import numbers_of

h5py = pytest.importorskip("h5py", reason="needs the extra io")
openpyxl = pytest.importorskip("openpyxl", reason="needs the extra io")


# workbooks


def book(path, *sheets):
    made = openpyxl.Workbook()
    made.remove(made.active)
    for k, rows in enumerate(sheets):
        sheet = made.create_sheet(f"page {k + 1}")
        for row in rows:
            sheet.append(row)
    made.save(path)
    return path


def test_times_of_day_and_durations_of_a_workbook_are_seconds(tmp_path):
    clock = [dt.time(2, 3, 4, 500_000), dt.time(0, 0, 1), dt.time(23, 59, 59)]
    last = [dt.timedelta(days=1, seconds=2), dt.timedelta(0), None]
    rows = [
        ["t", "lasts", "x"],
        *([c, d, k] for k, (c, d) in enumerate(zip(clock, last, strict=True))),
    ]
    log = workbook.open_workbook(book(tmp_path / "a.xlsx", rows), "a.xlsx")
    assert log.names == ("t", "lasts", "x") and log.units == {"t": "s", "lasts": "s"}
    read = log.read({n: n for n in log.names})
    assert read["t"].tolist() == [2 * 3600 + 3 * 60 + 4.5, 1.0, 86_399.0]
    assert np.array_equal(read["lasts"], [86_402.0, 0.0, np.nan], equal_nan=True)
    assert read["x"].tolist() == [0.0, 1.0, 2.0] and log.notes == ()


@pytest.mark.parametrize(
    ("cells", "seconds"),
    [
        ([dt.time(1, 0, 0), dt.time(1, 0, 1)], [3600.0, 3601.0]),
        ([dt.timedelta(seconds=2), dt.timedelta(seconds=5)], [2.0, 5.0]),
        ([dt.datetime(2026, 1, 1), dt.datetime(2026, 1, 2)], [0.0, 86_400.0]),
    ],
)
def test_an_empty_cell_of_a_workbook_before_dates_or_times_is_an_empty_cell(
    tmp_path, cells, seconds
):
    rows = [["t", "x", "F"], *([c, k, -k] for k, c in enumerate([None, *cells, None, None]))]
    log = workbook.open_workbook(book(tmp_path / "a.xlsx", rows), "a.xlsx")
    assert log.units == {"t": "s"}
    read = numbers_of(log.read({"t": ""})["t"], "t", "a.xlsx")
    assert np.array_equal(read, [np.nan, *seconds, np.nan, np.nan], equal_nan=True)


def test_a_cell_of_another_kind_is_named_by_its_row():
    for cells in ([1.0, dt.datetime(2026, 1, 1)], [dt.datetime(2026, 1, 1), "stop"]):
        with pytest.raises(ExperimentError, match=r"row \d: found"):
            numbers_of(workbook._column(cells), "t", "a.xlsx")
    log = workbook._log([["t", "x"], [0, 1], [1]], 1, ())
    assert np.array_equal(log.read({"x": ""})["x"], [1.0, np.nan], equal_nan=True)


def test_a_workbook_is_its_first_sheet_with_rows_of_numbers(tmp_path):
    """Half of the cells are too few for a row of numbers, and so is one cell."""
    text = [["one", 1], ["two", 2]]
    single = [[1], [2], [3]]
    rows = [["a title"], ["t", "x", None], ["s", "mm", None], [0, 1, 5], [1, None, 6]]
    path = book(tmp_path / "a.xlsx", text, single, rows, [[1, 2], [3, 4]])
    log = workbook.open_workbook(path, "a.xlsx")
    assert log.names == ("t", "x", "column 3") and log.units == {"t": "s", "x": "mm"}
    assert log.notes == ("sheet 'page 3'",) and log.remarks == ("a title", "t x", "s mm")
    assert np.array_equal(log.read({"x": ""})["x"], [1.0, np.nan], equal_nan=True)
    with pytest.raises(ExperimentError, match="found no sheet with a table of numbers"):
        workbook.open_workbook(book(tmp_path / "b.xlsx", text, single), "b.xlsx")


@pytest.mark.parametrize(("above", "result"), [(49, True), (50, False)])
def test_numbers_begin_among_the_first_fifty_rows_of_a_sheet(tmp_path, above, result):
    path = book(tmp_path / "a.xlsx", [*[["a title"]] * above, [0, 1], [1, 2]])
    if result:
        log = workbook.open_workbook(path, "a.xlsx")
        assert log.read({"column 2": ""})["column 2"].tolist() == [1.0, 2.0]
    else:
        with pytest.raises(ExperimentError, match="found no sheet"):
            workbook.open_workbook(path, "a.xlsx")


def test_a_workbook_may_unpack_to_a_quarter_of_the_most_bytes(tmp_path, monkeypatch):
    import zipfile

    path = book(tmp_path / "a.xlsx", [[0, 1], [1, 2]])
    with zipfile.ZipFile(path) as packed:
        size = sum(entry.file_size for entry in packed.infolist())
    monkeypatch.setattr(workbook, "MOST_BYTES", 4 * size)
    assert len(workbook.open_workbook(path, "a.xlsx").names) == 2
    monkeypatch.setattr(workbook, "MOST_BYTES", 4 * size - 1)
    with pytest.raises(ExperimentError, match="bytes unpacked, expected a smaller table"):
        workbook.open_workbook(path, "a.xlsx")


# JSON


def opened_json(path, content):
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    log = json_records.open_json(path, "a.json")
    return log, {n: v.tolist() for n, v in log.read({n: n for n in log.names}).items()}


def test_records_are_read_six_containers_deep(tmp_path):
    def record(value):
        return [{"t": k, "q": value} for k in range(2)]

    lists = [[[[[7]]]]]
    assert opened_json(tmp_path / "a", record(lists))[1]["q(1)(1)(1)(1)(1)"] == [7, 7]
    assert list(opened_json(tmp_path / "a", record([lists]))[1]) == ["t"]
    tables = {"a": {"b": {"c": {"d": {"e": 7}}}}}
    assert opened_json(tmp_path / "a", record(tables))[1]["q.a.b.c.d.e"] == [7, 7]
    assert list(opened_json(tmp_path / "a", record({"x": tables}))[1]) == ["t"]
    deep = {"t": [0, 1], "q": {"a": {"b": {"c": {"d": {"e": [7, 8]}}}}}}
    assert opened_json(tmp_path / "a", deep)[1]["q.a.b.c.d.e"] == [7, 8]
    assert list(opened_json(tmp_path / "a", {"t": [0, 1], "x": deep})[1]) == ["t", "x.t"]


def test_keys_that_come_and_go_are_empty_between(tmp_path):
    records = [{"t": 0}, {"t": 1, "q": 5}, {"t": 2}, {"t": 3, "q": 6}, {"t": 4}]
    assert opened_json(tmp_path / "a", records)[1]["q"] == [None, 5, None, 6, None]
    named = [{"name": ["a", "b"], "q": [k, -k], "n": [1]} for k in range(2)]
    assert opened_json(tmp_path / "a", named)[1] == {"a.q": [0, 1], "b.q": [0, -1], "n(1)": [1, 1]}
    inner = {"s": {"rows": [{"t": 0}, {"t": 1}]}, "rows": [{"t": 5}], "more": [{"t": 7}, {"t": 8}]}
    assert opened_json(tmp_path / "a", inner)[1] == {"t": [7, 8]}, "the longest list is the log"
    assert opened_json(tmp_path / "a", {"t": [1, 2], "one": [3]})[1] == {"t": [1, 2]}


@pytest.mark.parametrize(("rows", "most"), [(20, 10), (2000, 20)])
def test_lines_that_are_no_records_are_left_out_while_they_are_few(tmp_path, rows, most):
    whole = '{"t": 1},\n' * rows
    log, read = opened_json(tmp_path / "a", whole + "stop\n" * most)
    assert len(read["t"]) == rows
    assert log.notes == (f"{most} lines that are no records: left out",)
    one = opened_json(tmp_path / "a", whole + "stop\n")[0]
    assert one.notes == ("a line that is no record: left out",)
    with pytest.raises(ExperimentError, match=f"line {rows + most + 1}: no JSON"):
        opened_json(tmp_path / "a", whole + "stop\n" * (most + 1))
    with pytest.raises(ExperimentError, match="line 2: no JSON"):
        opened_json(tmp_path / "a", "stop\nstop\n")


def test_json_of_more_than_the_most_bytes_is_refused(tmp_path, monkeypatch):
    content = '[{"t": 1}, {"t": 2}]'
    monkeypatch.setattr(json_records, "MOST_BYTES", len(content))
    assert opened_json(tmp_path / "a", content)[1] == {"t": [1, 2]}
    monkeypatch.setattr(json_records, "MOST_BYTES", len(content) - 1)
    with pytest.raises(ExperimentError, match="bytes of text"):
        opened_json(tmp_path / "a", content)


# MAT files


def structs(**fields):
    made = np.zeros(len(next(iter(fields.values()))), dtype=[(n, object) for n in fields])
    for name, values in fields.items():
        made[name] = [np.asarray(v) for v in values]
    return made


def opened_mat(path, **content):
    savemat(path, content)
    log = matlab.open_matlab(path, "a.mat")
    return log, log.read({n: n for n in log.names})


def test_signals_of_structs_need_a_name_and_two_numbers(tmp_path):
    y = structs(
        Name=["model/x", "", "model/F", "model/one", "model/text", "model/two"],
        Data=[[1.0, 2.0, 3.0], [4.0, 5.0], [6.0, 7.0], [8.0], "words", [9.0, 10.0]],
        Unit=["mm", "N", "", "N", "N", "N"],
    )
    log, read = opened_mat(tmp_path / "a.mat", rec={"Y": y})
    assert {n: v.tolist() for n, v in read.items()} == {
        "rec.Y.x": [1.0, 2.0, 3.0], "rec.Y.F": [6.0, 7.0], "rec.Y.two": [9.0, 10.0],
    }  # fmt: skip
    assert log.units == {"rec.Y.x": "mm", "rec.Y.two": "N"}
    same = structs(Name=["a/x", "b/x"], Data=[[1.0, 2.0], [3.0, 4.0]])
    assert list(opened_mat(tmp_path / "a.mat", rec=same)[1]) == ["rec.a/x", "rec.b/x"]


def test_one_label_is_a_field_and_several_are_names(tmp_path):
    one = structs(label=["x"], values=[[1.0, 2.0]])
    assert list(opened_mat(tmp_path / "a.mat", rec=one)[1]) == ["rec.values"]
    two = structs(label=["x", "y"], values=[[1.0, 2.0], [3.0, 4.0]])
    assert list(opened_mat(tmp_path / "a.mat", rec=two)[1]) == ["rec.x", "rec.y"]
    name = structs(name=["x"], data=[[1.0, 2.0]])
    assert list(opened_mat(tmp_path / "a.mat", rec=name)[1]) == ["rec.x"]


def test_fields_and_arrays_of_structs_are_numbered_where_there_are_several(tmp_path):
    axes = structs(q=[[1.0, 2.0], [3.0, 4.0]], one=[[5.0], [6.0]])
    read = opened_mat(tmp_path / "a.mat", axis=axes, m=np.arange(6.0).reshape(3, 2), k=[7.0])[1]
    assert read["axis(1).q"].tolist() == [1.0, 2.0] and read["axis(2).q"].tolist() == [3.0, 4.0]
    assert read["m(:,2)"].tolist() == [1.0, 3.0, 5.0] and read["m"].shape == (3, 2)
    assert read["k"].tolist() == [7.0]
    assert set(read) == {"axis(1).q", "axis(2).q", "m(:,1)", "m(:,2)", "m", "k"}


# numpy and HDF5 files


def test_arrays_of_both_versions_of_the_header_are_read_and_other_entries_left_out(tmp_path):
    import zipfile

    path = tmp_path / "a.npz"
    with zipfile.ZipFile(path, "w") as packed:
        packed.writestr("README.txt", "words")
        for name, version in (("one", (1, 0)), ("two", (2, 0))):
            with packed.open(f"{name}.npy", "w") as stream:
                np.lib.format.write_array(stream, np.arange(3.0), version=version)
    log = arrays.open_arrays(path, "a.npz")
    assert log.names == ("one", "two")
    assert all(v.tolist() == [0.0, 1.0, 2.0] for v in log.read({"one": "", "two": ""}).values())


def test_fields_of_a_compound_dataset_are_columns(tmp_path):
    from teleopdesign.measurement.doors.hdf5 import open_hdf5

    rows = np.zeros(3, dtype=[("t", float), ("x", float)])
    rows["t"], rows["x"] = [0.0, 1.0, 2.0], [5.0, 6.0, 7.0]
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["log"] = rows
        file["#refs#/hidden"] = np.arange(3.0)
        file["f"] = np.arange(3.0)
        file["f"].attrs["Unit"] = "N"
    log = open_hdf5(tmp_path / "a.h5", "a.h5")
    assert set(log.names) == {"log.t", "log.x", "f"} and log.units == {"f": "N"}
    read = log.read({"log.x": "", "f": ""})
    assert read["log.x"].tolist() == [5.0, 6.0, 7.0] and read["f"].tolist() == [0.0, 1.0, 2.0]
