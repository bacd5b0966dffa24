"""The page opens and writes inside its folder alone."""

import os

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.app import files
from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.tables import DOORS


def test_experiments_and_logs_below_the_folder_are_listed(tmp_path):
    for name in ("rod", "day/one", "a/b/deep"):
        (tmp_path / name).mkdir(parents=True)
        (tmp_path / name / "experiment.toml").write_text("")
    (tmp_path / "log.csv").write_text("t\n")
    (tmp_path / "notes.md").write_text("")
    assert set(files.experiments_in(tmp_path)) == {"rod", "day/one"}
    assert files.logs_in(tmp_path) == ("log.csv",)


def test_links_that_lead_out_of_the_folder_are_not_followed(tmp_path):
    outside, folder = tmp_path / "outside", tmp_path / "folder"
    outside.mkdir()
    folder.mkdir()
    (outside / "experiment.toml").write_text("")
    (outside / "log.csv").write_text("")
    (folder / "link").symlink_to(outside)
    (folder / "log.csv").symlink_to(outside / "log.csv")
    assert files.experiments_in(folder) == () and files.logs_in(folder) == ()
    for name in ("../outside", "link", "/etc"):
        with pytest.raises(ExperimentError, match="outside of folder"):
            files.resolve_inside(folder, name)


def test_what_was_written_last_is_shown_first_whatever_its_name(tmp_path):
    """A log that is dropped, an experiment that is made of it."""
    assert files.newest(tmp_path, ()) is None
    for age, name in enumerate(("zeta", "alpha", "mu")):
        kept = files.keep_dropped(tmp_path, f"{name}.csv", b"t,x\n")
        place = tmp_path / f"{name}_experiment"
        place.mkdir()
        (place / "experiment.toml").write_text("")
        for path in (tmp_path / kept, place / "experiment.toml"):
            os.utime(path, (1e9 + age, 1e9 + age))
    assert files.newest(tmp_path, files.logs_in(tmp_path)) == "dropped/mu.csv"
    assert files.newest(tmp_path, files.experiments_in(tmp_path)) == "mu_experiment"


@pytest.mark.parametrize("ending", DOORS)
def test_every_log_that_can_be_read_may_be_dropped(tmp_path, ending):
    names = {files.keep_dropped(tmp_path, f"log{ending}", b"") for _ in range(2)}
    assert len(names) == 2 and set(files.logs_in(tmp_path)) == names


@settings(max_examples=10)
@given(name=st.text(max_size=40))
def test_a_dropped_file_stays_in_its_folder_whatever_its_name(tmp_path_factory, name):
    folder = tmp_path_factory.mktemp("page")
    written = files.keep_dropped(folder, name + ".csv", b"t,x\n")
    path = folder / written
    assert path.read_bytes() == b"t,x\n"
    assert path.resolve().parent == (folder / files.DROPPED).resolve()


def test_no_file_is_written_over(tmp_path):
    names = [files.keep_dropped(tmp_path, "log.csv", bytes([k])) for k in range(3)]
    assert [(tmp_path / n).read_bytes() for n in names] == [b"\0", b"\1", b"\2"]


def test_a_file_that_is_no_log_is_refused(tmp_path):
    with pytest.raises(ExperimentError, match="'.py'"):
        files.keep_dropped(tmp_path, "run.py", b"")
