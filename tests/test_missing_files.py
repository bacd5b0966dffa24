"""A file that is not there is reported as such by every reader, in one short line."""

import pytest

import teleopdesign as td
from teleopdesign.passivity import read_certificate, read_record

READERS = [
    td.load_experiment,
    td.read_diagram,
    td.read_study,
    td.load_effect,
    td.load_controller,
    read_certificate,
    read_record,
]


@pytest.mark.parametrize("read", READERS, ids=lambda r: r.__name__)
@pytest.mark.parametrize("name", ["lost.nc", "lost.py"])
def test_a_missing_file_is_named_in_one_line(read, name, tmp_path):
    """A study was "unable to synchronously open file (... errno = 2 ...)"."""
    path = tmp_path / name
    with pytest.raises(td.TeleopDesignError) as problem:
        read(path)
    message = str(problem.value).replace(str(path), "")
    assert "no such" in message.lower()
    assert len(message) < 80
    assert "errno" not in message.lower()
    assert "\n" not in message
