"""What a file claims is not believed: sizes, objects, other files, damaged bytes, odd names."""

import gzip
import pickle

import h5py
import numpy as np
import pytest
from clock import takes_less_than
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.io import savemat

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.doors import text
from teleopdesign.measurement.doors._cells import is_number
from teleopdesign.measurement.doors.text import open_text
from teleopdesign.measurement.tables import open_log, read_columns


def refused(path, *wanted):
    with pytest.raises(ExperimentError) as caught:
        read_columns(path, path.name, dict.fromkeys(wanted, "channels.position"))
    message = str(caught.value)
    assert message.isprintable() and message.startswith(path.name)
    return message


def test_a_dataset_of_three_thousand_million_rows_is_refused_unread(tmp_path):
    path = tmp_path / "log.h5"
    with h5py.File(path, "w") as file:
        file.create_dataset("x", shape=(3_000_000_000,), dtype="f8", chunks=(1024,))
    assert "3e+09 rows, expected at most 5e+07" in refused(path, "x")


def test_data_in_another_file_are_refused(tmp_path):
    (tmp_path / "secret").write_bytes(bytes(800))
    path = tmp_path / "log.h5"
    with h5py.File(path, "w") as file:
        outside = [(str(tmp_path / "secret"), 0, 800)]
        file.create_dataset("x", shape=(100,), dtype="f8", external=outside)
    assert "lies in another file" in refused(path, "x")


def test_nothing_is_unpickled(tmp_path):
    path = tmp_path / "log.npz"
    np.savez(path, x=np.array([{"a": 1}] * 100, dtype=object), allow_pickle=True)
    assert "Python objects" in refused(path, "x")
    path.write_bytes(pickle.dumps([1, 2]))
    assert "not a readable .npz file" in refused(path, "x")


def test_fields_of_structs_and_columns_of_matrices_are_columns(tmp_path):
    path = tmp_path / "log.mat"
    matrix = np.arange(300.0).reshape(100, 3)
    inner = {"q": np.arange(100.0), "limits": {"upper": np.ones(100)}}
    savemat(path, {"log": inner, "data": matrix})
    log = open_log(path, "log.mat")
    assert {"log.q", "log.limits.upper", "data(:,2)"} <= set(log.names)
    values = read_columns(path, "log.mat", {"log.q": "", "data(:,2)": ""}).values
    assert np.array_equal(values["log.q"], np.arange(100.0))
    assert np.array_equal(values["data(:,2)"], matrix[:, 1])


@pytest.mark.parametrize("ending", [".npz", ".xlsx", ".bag", ".mcap", ".db3", ".h5", ".parquet"])
@pytest.mark.parametrize("content", [b"", b"\x00\x01PK\x03\x04 and no more" * 20])
def test_a_damaged_file_is_one_line(tmp_path, ending, content):
    path = tmp_path / f"log{ending}"
    path.write_bytes(content)
    refused(path, "x")


@pytest.mark.parametrize("separator", [",", ";", "\t", "|"])
@pytest.mark.parametrize("comma", [False, True])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "cp1252"])
def test_every_dialect_gives_the_same_numbers(tmp_path, separator, comma, encoding):
    if comma and separator == ",":
        return
    table = np.random.default_rng(0).normal(size=(200, 3)).round(6)
    lines = ["# Prüfstand", separator.join(("t", "Weg", "Kraft"))]
    lines += [separator.join(map(str, row)) for row in table.tolist()]
    text = "\n".join(lines)
    path = tmp_path / "log.csv"
    path.write_text(text.replace(".", ",") if comma else text, encoding=encoding)
    columns = read_columns(path, "log.csv", {"t": "", "Weg": "", "Kraft": ""}).values
    assert np.array_equal(np.column_stack(list(columns.values())), table)


@given(content=st.binary(max_size=300))
@settings(max_examples=150)
def test_any_bytes_named_csv_are_read_or_refused_in_one_line(tmp_path_factory, content):
    path = tmp_path_factory.getbasetemp() / "any.csv"
    path.write_bytes(content)
    try:
        assert open_log(path, "any.csv").names
    except ExperimentError as error:
        assert str(error).isprintable()


def test_a_packed_table_that_ends_early_is_one_line(tmp_path):
    path = tmp_path / "log.csv.gz"
    packed = gzip.compress(("t,x\n" + "0.1,2\n" * 50_000).encode())
    path.write_bytes(packed[: len(packed) // 2])
    assert "cannot be read" in refused(path, "t", "x")


TABLES = {
    "numbers": "t,u,x\n" + "".join(f"{k},{k % 7},{-k}\n" for k in range(40)),
    "empty cells": "t,u,x\n" + "".join(f"{k},{k % 7 or ''},{-k}\n" for k in range(40)),
    "dates": "t,u,x\n" + "".join(f"2020-01-01 00:00:{k:02d},{k},\n" for k in range(40)),
}


def columns_of(path):
    log = open_text(path, path.name)
    return log.read(dict.fromkeys(log.names, ""))


@pytest.mark.parametrize("table", TABLES)
def test_a_table_that_is_read_a_few_rows_at_a_time_is_the_same(table, tmp_path, monkeypatch):
    path = tmp_path / "r.csv"
    path.write_text(TABLES[table])
    whole = columns_of(path)
    monkeypatch.setattr(text, "_ROWS", 7)
    pieces = columns_of(path)
    assert list(whole) == list(pieces)
    for name, values in whole.items():
        np.testing.assert_array_equal(pieces[name], values)
        assert len(values) == 40


def test_a_cell_that_is_no_number_is_named_by_its_row_in_the_whole_table(tmp_path, monkeypatch):
    path = tmp_path / "r.csv"
    path.write_text(TABLES["empty cells"].replace("\n30,2,-30", "\n30,two,-30"))
    monkeypatch.setattr(text, "_ROWS", 7)
    with pytest.raises(ExperimentError, match='column "u", row 31: found "two"'):
        read_columns(path, "r.csv", {"u": "channels.position"})


@pytest.mark.parametrize(
    "head",
    ["x" * 20_000, "/a" * 10_000, "pos (" + " " * 20_000, "a(" * 10_000, "x" + " " * 20_000],
    ids=["word", "parts", "open bracket", "brackets", "spaces"],
)
def test_a_name_that_no_logger_writes_is_refused_at_once(tmp_path, head):
    path = tmp_path / "log.csv"
    path.write_text(f"t,{head}b!\n" + "".join(f"{k},{k * k}\n" for k in range(200)))
    with takes_less_than(1):
        message = refused(path, "t")
    assert "characters, expected at most 1000" in message and len(message) < 300


def test_twelve_thousand_columns_are_refused_at_once(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text(",".join(["a"] * 12_000) + "\n" + ",".join(["1"] * 12_000) + "\n")
    with takes_less_than(10):
        assert "12000 columns, expected at most 10000" in refused(path, "a")


@pytest.mark.parametrize("cell", ["9" * 1_000_000, "." + "9" * 1_000_000, "1e" + "9" * 1_000_000])
def test_a_cell_of_a_million_digits_is_decided_at_once(cell):
    with takes_less_than(1):
        assert is_number(cell, False)
        assert not is_number(cell + "x", False)


@given(st.from_regex(r"[-+]?[0-9]{0,3}\.?[0-9]{0,3}([eEdD][-+]?[0-9]{0,3})?x?", fullmatch=True))
def test_what_is_a_number_is_what_python_reads_as_one(cell):
    try:
        float(cell.replace("d", "e").replace("D", "e"))
        reads = True
    except ValueError:
        reads = False
    assert is_number(cell, False) is reads


def test_a_matrix_of_no_known_class_or_size_is_refused_before_it_is_read(tmp_path):
    """scipy ends the whole process on some of them."""
    path = tmp_path / "log.mat"
    names = {"t": np.arange(99.0), "x": np.arange(99.0)[:, None], "name": "rod", "more": [1, "a"]}
    for packed in (True, False):
        savemat(path, {"log": names, "x": np.eye(3)}, do_compression=packed)
        assert {"log.t", "log.x"} <= set(open_log(path, "log.mat").names)
    content = path.read_bytes()
    for at in range(128, 600, 4):
        path.write_bytes(content[:at] + b"\xfe\xff\xff\x7f" + content[at + 4 :])
        try:
            open_log(path, "log.mat").read({"log.t": ""})
        except (ExperimentError, KeyError) as problem:
            assert str(problem)
    path.write_bytes(content.replace(b"\x06\0\0\0\x08\0\0\0\x06", b"\x06\0\0\0\x08\0\0\0\xfe", 1))
    assert "a matrix of class 254" in refused(path, "x")
