"""Public recordings become the experiments that we know; no network is used here."""

import gzip

import numpy as np
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement import load_experiment
from teleopdesign.measurement.recordings import RECORDINGS, fetch


@pytest.fixture(scope="module")
def copies(shared):
    """Copies of the published files, laid out as OWNER/REPOSITORY/PATH."""
    if not (shared / "data" / "raw").is_dir():
        pytest.skip("no copies of the published files: data/raw in TELEOPDESIGN_SHARED")
    return shared / "data" / "raw"


@pytest.mark.slow
@pytest.mark.parametrize("name", RECORDINGS)
def test_a_recording_is_converted_to_the_known_numbers(name, copies, shared, tmp_path):
    folder = fetch(name, tmp_path, source=copies)
    assert folder == tmp_path / name
    tables = sorted(folder.glob("*.csv.gz"))
    assert tables
    for path in tables:
        with gzip.open(path, "rt") as ours, gzip.open(shared / "data" / name / path.name) as known:
            np.testing.assert_array_equal(
                np.loadtxt(ours, delimiter=",", skiprows=1),
                np.loadtxt(known, delimiter=",", skiprows=1),
            )


@pytest.mark.slow
@pytest.mark.parametrize("name", RECORDINGS)
def test_a_recording_is_the_experiment_known_beside_it(name, copies, shared, tmp_path):
    ours = load_experiment(fetch(name, tmp_path, source=copies))
    known = load_experiment(shared / "data" / name)
    assert ours.channels == known.channels
    assert ours.bandwidth == known.bandwidth
    assert ours.bodies == {key: body for key, body in known.bodies.items()}, (
        "the same starting model"
    )
    assert [(r.file, r.use, r.offset_names) for r in ours.records] == [
        (r.file, r.use, r.offset_names) for r in known.records
    ]


def test_a_recording_is_converted_once(copies, tmp_path):
    folder = fetch("mtm_wrist", tmp_path, source=copies)
    written = (folder / "experiment.toml").stat().st_mtime_ns
    assert fetch("mtm_wrist", tmp_path, source=tmp_path / "nothing") == folder
    assert (folder / "experiment.toml").stat().st_mtime_ns == written


def test_a_file_with_other_content_is_refused(tmp_path):
    file = RECORDINGS["mtm_wrist"].files[0]
    copy = tmp_path / "source" / file.repository / file.path
    copy.parent.mkdir(parents=True)
    copy.write_text("1,2,3\n")
    with pytest.raises(ExperimentError, match="expected the known sha256"):
        fetch("mtm_wrist", tmp_path, source=tmp_path / "source")
    assert not (tmp_path / "mtm_wrist").exists()


def test_a_recording_that_is_not_there_is_named(tmp_path):
    with pytest.raises(ExperimentError, match='did you mean "emps"?'):
        fetch("emsp", tmp_path)
    with pytest.raises(ExperimentError, match="no file forgi86/"):
        fetch("emps", tmp_path, source=tmp_path)


def test_every_published_file_has_a_commit_and_a_hash():
    for recording in RECORDINGS.values():
        for file in recording.files:
            assert len(file.commit) == 40
            assert len(file.sha256) == 64
            int(file.commit + file.sha256, 16)


@pytest.mark.slow
@pytest.mark.parametrize("folder", ["data", "hidden/cases"])
def test_every_shared_experiment_loads(shared, folder):
    experiments = sorted((shared / folder).glob("*/experiment.toml"))
    if not experiments:
        pytest.skip(f"no experiments in {folder} of the shared measurements")
    for path in experiments:
        assert load_experiment(path).fit_records
