"""Results as plain data, and files that are whole or not there."""

import json
import math
import os
import stat
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.base.errors import ExperimentError
from teleopdesign.base.files import json_text, make_plain, write_beside, write_json, write_text

NUMBERS = st.floats() | st.integers() | st.floats(width=32).map(np.float32) | st.booleans()
LEAVES = NUMBERS | st.text() | st.none() | st.lists(st.floats()).map(np.array)
DATA = st.recursive(
    LEAVES, lambda inner: st.lists(inner) | st.tuples(inner) | st.dictionaries(st.text(), inner)
)


def numbers_of(data):
    if isinstance(data, dict):
        data = list(data.values())
    return [n for d in data for n in numbers_of(d)] if isinstance(data, list) else [data]


@given(DATA)
def test_whatever_is_written_is_read_back_as_its_plain_data(data):
    text = json_text(data)
    read = json.loads(text, parse_constant=pytest.fail)
    assert read == make_plain(data) and text.endswith("\n")
    assert make_plain(read) == read
    assert all(math.isfinite(n) for n in numbers_of(read) if isinstance(n, float))


def test_what_has_no_form_is_refused_by_its_type():
    with pytest.raises(TypeError, match="found complex"):
        make_plain({"z": 1j})


def test_a_file_that_fails_half_way_leaves_the_old_one_and_nothing_beside_it(tmp_path):
    path = tmp_path / "answer.json"
    write_json(path, {"a": 1})
    with pytest.raises(ZeroDivisionError), write_beside(path) as part:
        part.write_text("half")
        raise ZeroDivisionError
    with pytest.raises(ExperimentError, match="No space left"), write_beside(path) as part:
        part.write_text("half")
        raise OSError(28, "No space left on device")
    assert json.loads(path.read_text()) == {"a": 1}
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.skipif(sys.platform == "win32", reason="links and modes of POSIX")
def test_a_link_stays_a_link_and_a_mode_stays_a_mode(tmp_path):
    real, link = tmp_path / "real.txt", tmp_path / "link.txt"
    real.write_text("old")
    real.chmod(0o640)
    link.symlink_to(real)
    write_text(link, "new\n")
    assert link.is_symlink() and real.read_text() == "new\n"
    assert stat.S_IMODE(real.stat().st_mode) == 0o640


@pytest.mark.parametrize("name", ["nowhere/a.json", "folder", "a.json/b.json", "nul\0l.json"])
def test_what_cannot_be_written_is_one_line_with_the_path(name, tmp_path):
    (tmp_path / "folder").mkdir()
    (tmp_path / "a.json").write_text("")
    with pytest.raises(ExperimentError, match="cannot be written") as caught:
        write_json(tmp_path / name, {})
    assert str(caught.value).count("\n") == 0 and name.split("/")[0][:3] in str(caught.value)
    assert sorted(os.listdir(tmp_path)) == ["a.json", "folder"]
