"""Published files become tables: which column, with which factor and digits; no network is used."""

import gzip
import hashlib
from dataclasses import replace

import numpy as np
import pytest

from teleopdesign.measurement import load_experiment, recordings
from teleopdesign.measurement.recordings import RECORDINGS, fetch

ROWS = 5


def written(folder):
    """Each table in a folder: header, rows, digits after the points of its cells."""
    tables = {}
    for path in sorted(folder.glob("*.csv.gz")):
        with gzip.open(path, "rt") as file:
            cells = [line.strip().split(",") for line in file]
        digits = [len(c.partition(".")[2]) for c in cells[1]]
        tables[path.name] = (cells[0], np.array(cells[1:], dtype=float).T, digits)
    return tables


def test_emps_has_the_force_of_voltage_and_gain_at_a_kilohertz(tmp_path):
    from scipy.io import savemat

    volt, place = np.linspace(-1, 2, ROWS), np.linspace(0.1, 0.2, ROWS)
    content = {"qm": place[:, None], "qg": place[:, None] + 0.01, "vir": volt[:, None]}
    raw = [tmp_path / "a.mat", tmp_path / "b.mat"]
    savemat(raw[0], content | {"gtau": 35.15})
    savemat(raw[1], content | {"gtau": 35.15, "pulses_N": 9.0 * np.arange(ROWS)[:, None]})
    RECORDINGS["emps"].convert(raw, tmp_path)
    tables = written(tmp_path)
    assert list(tables) == ["emps_estimation.csv.gz", "emps_pulses.csv.gz"]
    header, columns, digits = tables["emps_estimation.csv.gz"]
    assert header == ["time_s", "position_m", "force_N", "reference_m"]
    assert digits == [3, 8, 6, 8]
    expected = [0.001 * np.arange(ROWS), place, 35.15 * volt, place + 0.01]
    assert columns == pytest.approx(np.array(expected), abs=1e-6)
    header, columns, digits = tables["emps_pulses.csv.gz"]
    assert header[-1] == "pulse_flag" and digits == [3, 8, 6, 8, 0]
    assert columns[-1].tolist() == (9.0 * np.arange(ROWS)).tolist()
    assert columns[:-1] == pytest.approx(np.array(expected), abs=1e-6)


def test_hsm150_has_the_columns_that_its_authors_list(tmp_path):
    from scipy.io import savemat

    data = np.arange(ROWS)[:, None] + 0.1 * np.arange(6)
    savemat(tmp_path / "idf_pos_0.065_1.mat", {"data": data})
    RECORDINGS["hsm150"].convert([tmp_path / "idf_pos_0.065_1.mat"], tmp_path)
    ((name, (header, columns, digits)),) = written(tmp_path).items()
    assert name == "hsm150_pos_0p065_1.csv.gz"
    assert header == [
        *("time_s", "position_rad", "velocity_rad_per_s", "torque_Nm", "torque_measured_Nm")
    ]
    assert columns == pytest.approx(data[:, [0, 2, 3, 4, 5]].T)
    assert digits == [3, 6, 6, 6, 5]


def test_mtm_wrist_has_rows_at_200_hz(tmp_path):
    data = np.arange(ROWS)[:, None] + 0.1 * np.arange(4)
    np.savetxt(tmp_path / "raw.csv", data, delimiter=",")
    RECORDINGS["mtm_wrist"].convert([tmp_path / "raw.csv"], tmp_path)
    ((name, (header, columns, digits)),) = written(tmp_path).items()
    assert name == "mtm_joint4_sweep.csv.gz"
    assert header == ["time_s", "position_rad", "velocity_rad_per_s", "torque_Nm"]
    assert columns == pytest.approx(np.vstack([np.arange(ROWS) / 200.0, data[:, :3].T]))
    assert digits == [3, 7, 6, 6]


def test_psm_insertion_is_joint_three_from_its_second_second_on(tmp_path):
    raw, expected = [], {}
    for kind in ("result", "command"):
        for k in range(3):
            rows = np.arange(100 + ROWS)[:, None] + 0.1 * np.arange(9) + 1000.0 * k
            # a command has a row for each joint, and goes on longer than the measurement
            table = rows if kind == "result" else -np.vstack([rows, rows]).T[:4]
            path = tmp_path / f"{kind}{k}.csv"
            np.savetxt(path, table, delimiter=",")
            raw.append(path)
            expected[k] = expected.get(k, []) + [table]
    RECORDINGS["psm_insertion"].convert(raw, tmp_path)
    tables = written(tmp_path)
    assert list(tables) == [f"psm1_fourier{k}.csv.gz" for k in (1, 2, 3)]
    for k, (header, columns, digits) in enumerate(tables.values()):
        measured, command = expected[k]
        assert header == [
            *("time_s", "position_m", "velocity_m_per_s", "force_N", "position_command_m")
        ]
        assert columns[0] == pytest.approx(0.01 * np.arange(ROWS))
        assert columns[1:4] == pytest.approx(measured[100:, [2, 5, 8]].T)
        assert columns[4] == pytest.approx(command[2, 100 : 100 + ROWS])
        assert digits == [3, 7, 6, 6, 6]


@pytest.fixture
def source(tmp_path, monkeypatch):
    """A folder of copies with one recording, whose content is made here."""
    t = np.arange(2000) / 200.0
    table = np.column_stack([np.sin(3 * t), 3 * np.cos(3 * t), 0.1 * np.sign(np.cos(3 * t))])
    known = RECORDINGS["mtm_wrist"]
    file = known.files[0]
    path = tmp_path / "source" / file.repository / file.path
    path.parent.mkdir(parents=True)
    np.savetxt(path, table, delimiter=",")
    made = replace(file, sha256=hashlib.sha256(path.read_bytes()).hexdigest())
    monkeypatch.setitem(recordings.RECORDINGS, "mtm_wrist", replace(known, files=(made,)))
    return tmp_path / "source"


def test_what_is_fetched_loads_and_is_fetched_once(source, tmp_path):
    into = tmp_path / "not" / "there" / "yet"
    folder = fetch("mtm_wrist", into, source=source)
    assert folder == into / "mtm_wrist"
    assert [p.name for p in into.iterdir()] == ["mtm_wrist"]  # and nothing unfinished beside it
    (record,) = load_experiment(folder).records
    assert len(record.time) == 2000 and record.sample_time == pytest.approx(0.005)
    (folder / "mark").touch()
    assert fetch("mtm_wrist", into, source=tmp_path / "gone") == folder
    assert (folder / "mark").exists()


def test_a_folder_without_its_experiment_is_written_anew(source, tmp_path):
    (tmp_path / "mtm_wrist").mkdir()
    (tmp_path / "mtm_wrist" / "torn.csv.gz").touch()
    folder = fetch("mtm_wrist", tmp_path, source=source)
    assert sorted(p.name for p in folder.iterdir()) == [
        "experiment.toml",
        "mtm_joint4_sweep.csv.gz",
    ]


def test_a_download_names_its_commit_and_kept_by_repository(source, tmp_path, monkeypatch):
    pooch = pytest.importorskip("pooch")
    monkeypatch.setattr(pooch, "os_cache", lambda name: tmp_path / "cache" / name)
    request = {}

    def retrieve(address, *, known_hash, fname, path):
        request.update(address=address, known_hash=known_hash, fname=fname, path=path)
        return source / file.repository / file.path

    monkeypatch.setattr(pooch, "retrieve", retrieve)
    file = recordings.RECORDINGS["mtm_wrist"].files[0]
    folder = fetch("mtm_wrist", source="https://host.example")
    assert folder == tmp_path / "cache" / "teleopdesign" / "mtm_wrist" and folder.is_dir()
    assert request["address"] == f"https://host.example/{file.repository}/{file.commit}/{file.path}"
    assert request["known_hash"] == f"sha256:{file.sha256}"
    assert request["fname"] == "one_results.csv"
    assert request["path"] == tmp_path / "cache" / "teleopdesign" / "raw" / file.repository
