"""Published files become tables: which column, with which factor and digits; no network is used."""

import hashlib
from dataclasses import replace

import numpy as np
import pytest

from teleopdesign.measurement import load_experiment, recordings
from teleopdesign.measurement.recordings import RECORDINGS, fetch


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
