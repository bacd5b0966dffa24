"""Files of nested parts: JSON, groups of HDF5, arrays of structs; endings that say nothing."""

import json
import shutil

import h5py
import numpy as np
import pytest
from scipy.io import savemat

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement.doors._cells import numbers_of
from teleopdesign.measurement.tables import open_log, read_columns

T = 0.01 * np.arange(90)
Q = np.sin(T)


def column(path, name):
    return numbers_of(open_log(path, path.name).read({name: ""})[name], name, path.name)


def record(t, q):
    return {"t": t, "joint": {"name": ["elbow"], "q": [q]}, "F": [q, 1.0, 2.0], "ok": True}


@pytest.mark.parametrize("form", ["lines", "list", "list in a record"])
def test_records_of_json(tmp_path, form):
    records = [record(t, q) for t, q in zip(T.tolist(), Q.tolist(), strict=True)]
    text = "\n".join(map(json.dumps, records)) + '\n{"t": 0.9, "jo'
    if form != "lines":
        text = json.dumps(records if form == "list" else {"run": 3, "rows": records})
    path = tmp_path / "log.jsonl"
    path.write_text(text)
    log = open_log(path, "log.jsonl")
    assert log.names == ("t", "joint.elbow.q", "F(1)", "F(2)", "F(3)", "ok")
    assert log.notes == (("a line that is no record: left out",) if form == "lines" else ())
    assert np.array_equal(column(path, "joint.elbow.q"), Q)


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


def test_groups_of_hdf5_say_units_and_matlab_turns_matrices(tmp_path):
    path = tmp_path / "log.mat"
    with h5py.File(path, "w", userblock_size=512) as content:
        angle = content.create_dataset("joint/angle", data=Q)
        angle.attrs["Units"] = "degrees"
        content["data"] = np.stack([T, Q])
    as_matlab(path)
    log = open_log(path, "log.mat")
    assert log.units == {"joint/angle": "deg"}
    assert {"data(:,1)", "data(:,2)"} <= set(log.names)
    assert np.array_equal(column(path, "data(:,2)"), Q)


def test_an_array_of_structs_of_matlab_is_numbered(tmp_path):
    axes = np.zeros((1, 2), dtype=[("name", object), ("meas", object)])
    for k in range(2):
        axes[0, k] = (f"axis{k}", {"q": (k + 1) * Q[:, None]})
    savemat(tmp_path / "log.mat", {"exp": {"t": T, "axis": axes}})
    path = tmp_path / "log.mat"
    assert open_log(path, "log.mat").names == ("exp.t", "exp.axis(1).meas.q", "exp.axis(2).meas.q")
    assert np.array_equal(column(path, "exp.axis(2).meas.q"), 2 * Q)


@pytest.mark.parametrize("ending", ["", ".data", ".out"])
def test_a_file_whose_ending_says_nothing_is_known_by_its_beginning(tmp_path, ending):
    text = tmp_path / "log.csv"
    text.write_text("t,q\n" + "".join(f"{t},{q}\n" for t, q in zip(T, Q, strict=True)))
    with h5py.File(tmp_path / "log.h5", "w") as content:
        content["q"] = Q
    lines = tmp_path / "log.json"
    lines.write_text("".join(json.dumps({"q": q}) + "\n" for q in Q.tolist()))
    for source in (text, tmp_path / "log.h5", lines):
        named = shutil.copy(source, tmp_path / f"run{ending}")
        assert np.array_equal(read_columns(named, "run", {"q": ""}).values["q"], Q)
    (tmp_path / f"raw{ending}").write_bytes(bytes(range(256)))
    with pytest.raises(ExperimentError, match="found a file of kind"):
        open_log(tmp_path / f"raw{ending}", "raw")


@pytest.mark.parametrize(("count", "fits"), [(200, True), (201, False)])
def test_a_list_in_a_record_has_two_hundred_numbers_at_most(tmp_path, count, fits):
    records = [{"t": 0.01 * k, "q": [float(k + n) for n in range(count)]} for k in range(80)]
    (tmp_path / "log.json").write_text(json.dumps(records))
    names = open_log(tmp_path / "log.json", "log.json").names
    assert len(names) == (1 + count if fits else 1)
    if fits:
        assert column(tmp_path / "log.json", "q(200)").tolist() == [199.0 + k for k in range(80)]


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
