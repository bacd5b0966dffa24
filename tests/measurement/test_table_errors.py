"""Every mistake in a record file is one line: file, column, row, what was found and expected."""

import sys

import numpy as np
import pytest
from measurement.rod_example import assert_says, error_of
from scipy.io import savemat

from teleopdesign.measurement import load_experiment


def cell(row, column, text):
    """Put `text` into a cell of fit.csv; row from 1, without the header."""

    def change(lines):
        cells = lines[row].split(",")
        cells[column] = text
        return [*lines[:row], ",".join(cells), *lines[row + 1 :]]

    return change


def shifted(row, seconds):
    """From `row` on, time stamps are `seconds` later."""

    def change(lines):
        def later(line):
            t, rest = line.split(",", 1)
            return f"{float(t) + seconds:.6g},{rest}"

        return [*lines[:row], *(later(line) for line in lines[row:])]

    return change


IN_A_TABLE = {
    "last row": (cell(150, 1, "1.2.3"), 'column "u", row 150: found "1.2.3"'),
    "underscore": (cell(3, 1, "1_000"), 'row 3: found "1_000"'),
    "only a header": (lambda lines: lines[:1], "a header and no rows"),
    "no header": (lambda lines: lines[1:], 'no column "t", found column 1, column 2'),
    "short": (lambda lines: lines[:91], "found 0.9 s of samples, expected at least 1 s"),
    "constant time": (
        lambda lines: [lines[0], *("1," + line.split(",", 1)[1] for line in lines[1:])],
        "does not increase",
    ),
}  # fmt: skip


AS_LOGGERS_WRITE = {
    "nan": (cell(7, 2, "nan"), "1 row with a cell that holds no number"),
    "infinite": (cell(7, 2, "-inf"), "1 row with a cell"),
    "empty cell": (cell(149, 3, ""), "1 row with a cell"),
    "row cut short": (lambda lines: [*lines[:-1], "1.49,0.1"], "a line that is no row"),
    "semicolons": (lambda lines: [line.replace(",", ";") for line in lines], "semicolons between"),
    "tabs": (lambda lines: [line.replace(",", "\t") for line in lines], "tabs between columns"),
    "pause": (shifted(50, 0.5), "1 pause, the longest 0.51 s"),
    "one sample lost": (shifted(50, 0.01), "1 row lost, 0.66 %"),
    "one sample lost at the end": (shifted(149, 0.01), "1 row lost"),
    "time set back": (shifted(50, -0.5), "time set back 1 time"),
    "jitter": (cell(50, 0, "0.494"), "stamps 3.3 % of a row off an even clock"),
    "stamp twice": (cell(50, 0, "0.48"), "1 row with the stamp of another"),
}


@pytest.mark.parametrize("flaw", AS_LOGGERS_WRITE)
def test_what_loggers_do_is_read_and_reported(rod, flaw):
    change, expected = AS_LOGGERS_WRITE[flaw]
    file = rod / "fit.csv"
    file.write_text("".join(line + "\n" for line in change(file.read_text().splitlines())))
    experiment = load_experiment(rod)
    assert any(expected in step.observed for step in experiment.reading)
    assert expected.split()[0] in repr(experiment)
    assert 149 <= len(experiment.records[0].time) <= 151


@pytest.mark.parametrize("mistake", IN_A_TABLE)
def test_a_mistake_in_a_table_is_named(rod, mistake):
    change, expected = IN_A_TABLE[mistake]
    file = rod / "fit.csv"
    file.write_text("".join(line + "\n" for line in change(file.read_text().splitlines())))
    assert_says(error_of(rod), expected)


def test_a_matrix_is_not_a_column(rod, edit):
    columns = {name: np.arange(150.0) / 100 for name in ("t", "u", "f_h")}
    savemat(rod / "fit.mat", columns | {"x": np.zeros((150, 2))})
    edit(rod / "experiment.toml", "fit.csv", "fit.mat")
    assert_says(error_of(rod), r"found an array of shape \(150, 2\), expected one column")


def test_text_in_a_parquet_file_is_named(rod, edit):
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")

    columns = {name: np.arange(150.0) / 100 for name in ("t", "u", "f_h")}
    table = pyarrow.table(columns | {"x": ["here"] * 150})
    parquet.write_table(table, rod / "fit.parquet")
    edit(rod / "experiment.toml", "fit.csv", "fit.parquet")
    assert_says(error_of(rod), 'column "x", row 1: found "here", expected a number')


@pytest.mark.parametrize(("ending", "package"), [(".parquet", "pyarrow"), (".h5", "h5py")])
def test_a_missing_reader_says_what_to_install(rod, edit, monkeypatch, ending, package):
    monkeypatch.setitem(sys.modules, package, None)
    monkeypatch.setitem(sys.modules, f"{package}.parquet", None)
    (rod / f"fit{ending}").write_bytes(b"")
    edit(rod / "experiment.toml", "fit.csv", f"fit{ending}")
    assert_says(error_of(rod), rf'needs {package}: pip install "teleopdesign\[io\]"')
