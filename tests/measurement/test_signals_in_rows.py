"""Text tables with a signal in each row, and folders of one signal in each file."""

import gzip

import numpy as np
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.doors import _signals_in_rows
from teleopdesign.measurement.survey import Choices, survey_log
from teleopdesign.measurement.tables import open_log

ROWS = 900
T = 0.002 * np.arange(ROWS)
Q = np.round(np.sin(6.0 * T) + 0.3 * np.sin(17.0 * T), 5)
U = np.round(0.02 * np.gradient(np.gradient(Q, T), T) + 0.3 * np.sign(np.gradient(Q, T)), 5)


def lines_of(separator, comma=False, names=(), form="{:.18e}"):
    for k, signal in enumerate((T, Q, U)):
        line = separator.join([*names[k : k + 1], *(form.format(x) for x in signal)])
        yield line.replace(".", ",") if comma else line


@pytest.mark.parametrize(
    ("separator", "comma", "names"),
    [(",", False, ()), (" ", False, ()), ("\t", False, ("time", "angle", "torque")),
     (";", True, ("time", "angle", "torque")), (";", False, ())],
)  # fmt: skip
@pytest.mark.parametrize("packed", [False, True])
def test_a_table_with_a_signal_in_each_row_is_turned(tmp_path, separator, comma, names, packed):
    """Three rows of 900 numbers were "3 rows, expected at least 64"; longer ones had no header."""
    path = tmp_path / ("log.csv.gz" if packed else "log.csv")
    text = "# Kommentar: größer\n" + "\n".join(lines_of(separator, comma, names)) + "\n"
    path.write_bytes(gzip.compress(text.encode()) if packed else text.encode("cp1252"))
    log = open_log(path, path.name)
    assert log.names == (names or ("column 1", "column 2", "column 3"))
    assert log.notes == ("a signal in each row: read as columns",)
    read = log.read(dict.fromkeys(log.names, ""))
    for name, signal in zip(log.names, (T, Q, U), strict=True):
        np.testing.assert_array_equal(read[name], signal)
    result = survey_log(log, "log", Choices())
    assert result.channels["actuator_force"]["column"] == log.names[2]


def test_other_tables_with_few_rows_stay_as_they_are(tmp_path, monkeypatch):
    path = tmp_path / "log.csv"
    few = "time,angle\n" + "\n".join(f"{k},{k % 7}" for k in range(50))
    for text in (few, ",".join(map(str, range(90))), "a," * 80 + "\n" + "b," * 80):
        path.write_text(text)
        assert _signals_in_rows.open_signals_in_rows(path, "log.csv") is None
    path.write_text("\n".join(lines_of(",")) + ",1.0\n")
    assert _signals_in_rows.open_signals_in_rows(path, "log.csv") is None, "unequal rows"
    path.write_text("\n".join(lines_of(",", form="{:.4f}")))
    monkeypatch.setattr(_signals_in_rows, "LOOKED_AT", 100)
    monkeypatch.setattr(_signals_in_rows, "MOST_BYTES", 9000)
    assert _signals_in_rows.open_signals_in_rows(path, "log.csv") is None, "too long a table"


def write_folder(folder, **tables):
    folder.mkdir()
    for name, columns in tables.items():
        np.savetxt(folder / f"{name}.csv", np.column_stack(columns), fmt="%.6g")
    return open_log(folder, folder.name)


def test_a_folder_of_signals_without_header_is_one_log(tmp_path):
    """The advice was to read position and torque of one run as runs of the same machine."""
    log = write_folder(tmp_path / "run", position=(Q, 0 * Q - 70.0), torque=(U, 0 * U), energy=(T,))
    names = ("position 1", "position 2", "torque 1", "torque 2", "energy")
    assert sorted(log.names) == sorted(names)
    np.testing.assert_allclose(log.read({"torque 1": ""})["torque 1"], U, atol=1e-5)
    result = survey_log(log, "run", Choices(sample_rate=500.0))
    assert result.channels["position"]["column"] == "position 1"
    assert result.channels["actuator_force"]["column"] == "torque 1"


def test_a_folder_of_runs_without_header_is_refused_as_before(tmp_path):
    with pytest.raises(ExperimentError, match="found tables of the same columns"):
        write_folder(tmp_path / "runs", run1=(T, Q, U), run2=(T, Q, U))
    with pytest.raises(ExperimentError, match="found tables of the same columns"):
        write_folder(tmp_path / "angles", angle1=(T, Q, U), angle2=(T, Q, U))


@pytest.mark.parametrize("shared", ["{}_wall3", "wall3_{}", "a_{}_wall_3"])
def test_words_that_all_files_share_name_no_signal(tmp_path, shared):
    """The unit of the force stands before the name of the specimen."""
    tables = {shared.format("displ"): (Q,), shared.format("load_kN"): (U,)}
    log = write_folder(tmp_path / "wall", **tables)
    assert log.names == ("displ", "load_kN")
    np.testing.assert_allclose(log.read({"load_kN": ""})["load_kN"], U, rtol=1e-5, atol=1e-9)
