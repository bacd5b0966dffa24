"""Files of nested parts: JSON, groups of HDF5, arrays of structs; endings that say nothing."""

import json

import h5py
import numpy as np
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.doors._cells import numbers_of
from teleopdesign.measurement.tables import open_log

T = 0.01 * np.arange(90)
Q = np.sin(T)


def column(path, name):
    return numbers_of(open_log(path, path.name).read({name: ""})[name], name, path.name)


def test_lists_of_json_and_records_without_a_key(tmp_path):
    path = tmp_path / "log.json"
    path.write_text(json.dumps({"t": T.tolist(), "joint": {"q": Q.tolist()}, "by": "me"}))
    assert np.array_equal(column(path, "joint.q"), Q)
    path.write_text('[{"q": 1}, {"t": 1}, {"q": 3, "t": 2}]')
    assert np.array_equal(column(path, "q"), [1, np.nan, 3], equal_nan=True)


@pytest.mark.parametrize("text", ["[]", "3", '{"a": 1}', "[" * 100_000, "left\nright\n", "\0", ""])
def test_json_without_records_is_one_line(tmp_path, text):
    path = tmp_path / "log.json"
    path.write_text(text)
    with pytest.raises(ExperimentError, match=r"^log\.json: .*JSON"):
        open_log(path, "log.json")


def as_matlab(path):
    """A file of HDF5 with the head that MATLAB writes."""
    raw = path.read_bytes()
    path.write_bytes(b"MATLAB 7.3 MAT-file".ljust(128) + raw[128:])


@pytest.mark.parametrize("turned", [False, True])
def test_a_matrix_of_hdf5_is_its_columns_and_itself_whichever_way_it_lies(tmp_path, turned):
    """As MATLAB writes it, rows and columns are exchanged; a row or a column is one signal."""
    path = tmp_path / ("log.mat" if turned else "log.h5")
    both = np.stack([T, Q], axis=1)
    with h5py.File(path, "w", userblock_size=512) as content:
        content["both"] = both.T if turned else both
        content["row"], content["tall"] = Q[None, :], Q[:, None]
        content["cube"] = np.zeros((3, 4, 5))
        content["both"].attrs["unit"] = "rad"
    if turned:
        as_matlab(path)
    log = open_log(path, path.name)
    assert {"both", "both(:,1)", "both(:,2)", "row", "tall", "cube"} == set(log.names)
    assert log.units == dict.fromkeys(("both", "both(:,1)", "both(:,2)"), "rad")
    read = log.read({"both": "", "both(:,2)": "", "row": "", "tall": ""})
    assert np.array_equal(read["both"], both)
    for name in ("both(:,2)", "row", "tall"):
        assert np.array_equal(np.ravel(read[name]), Q)


def swings(count, rows):
    """Records of a servo's tests: set point and reading as lists, beside a word and a rate."""
    return [
        {
            "type": "sine",
            "rate": 50.0,
            "goal": [round((1 - k) * 0.3 * np.sin(0.1 * n) - 0.1 * k, 4) for n in range(rows)],
            "sensor": [
                round((1 - k) * 0.2 * np.sin(0.1 * n - 0.3) - 0.1 * k, 4) for n in range(rows)
            ],
        }
        for k in range(count)
    ]


@pytest.mark.parametrize("inside", [True, False])
def test_several_recordings_in_one_file_are_refused_and_other_lists_are_left_out(inside, tmp_path):
    tests, path = swings(3, 120), tmp_path / "log.json"
    path.write_text(json.dumps({"config": {"limits": [-0.6, 0.6]}, "data": tests}))
    if not inside:
        path.write_text(json.dumps(tests))
    with pytest.raises(ExperimentError, match=r'found the same columns in ".*\(1\)".*of its own'):
        open_log(path, "log.json")
    path.write_text(json.dumps({"b": [{"q": 1}] * 2, "a": [{"q": 2, "u": 1}] * 3}))
    assert open_log(path, "log.json").names == ("q", "u"), "the longest list is the log"
