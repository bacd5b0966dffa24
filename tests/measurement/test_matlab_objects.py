"""Timetables are objects that MATLAB alone can unpack: one line says what to type there."""

import h5py
import numpy as np
import pytest
from scipy.io import savemat

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.tables import open_log


def version_73(path, **columns):
    """A MAT file of version 7.3 with a timetable as MATLAB marks it, and plain variables."""
    with h5py.File(path, "w", userblock_size=512) as file:
        marked = file.create_dataset("T", data=np.arange(6, dtype=np.uint32))
        marked.attrs["MATLAB_class"] = np.bytes_("timetable")
        marked.attrs["MATLAB_object_decode"] = np.int32(3)
        file.create_dataset("#subsystem#/MCOS", data=np.zeros(4))
        for name, values in columns.items():
            file.create_dataset(name, data=values)
    head = b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM"
    with path.open("r+b") as file:
        file.write(head)


def test_a_timetable_alone_is_refused_with_what_to_type(tmp_path):
    version_73(tmp_path / "log.mat")
    with pytest.raises(ExperimentError, match=r'^log.mat: "T" is a timetable.*writetimetable'):
        open_log(tmp_path / "log.mat", "log.mat")


def test_a_timetable_beside_columns_is_left_out_and_reported(tmp_path):
    version_73(tmp_path / "log.mat", q=np.linspace(0, 1, 50))
    log = open_log(tmp_path / "log.mat", "log.mat")
    assert log.names == ("q",)
    (note,) = log.notes
    assert note.startswith('"T" is a timetable') and note.endswith("it is left out")


@pytest.mark.parametrize("kind", ["opaque", "object"])
@pytest.mark.parametrize(("name", "written"), [("speed", "speed"), ("", "it")])
def test_an_object_of_an_older_file_is_named(tmp_path, monkeypatch, kind, name, written):
    savemat(tmp_path / "log.mat", {"q": np.linspace(0, 1, 50)})
    listed = [("q", (50, 1), "double"), (name, (1, 1), kind)]
    monkeypatch.setattr("scipy.io.whosmat", lambda path: listed)
    (note,) = open_log(tmp_path / "log.mat", "log.mat").notes
    assert note.startswith(f'"{written}" is a timetable') and note.endswith("it is left out")
    del listed[0]
    with pytest.raises(ExperimentError, match=f'^log.mat: "{written}" is a timetable'):
        open_log(tmp_path / "log.mat", "log.mat")
