"""Raw logs, each with what must be read from it; see README.md in this folder.

One test for all of them, through the command that a user types.
"""

import pytest
from corpus.reading import CHANNELS, OTHERS, differences, entries, read, unpacked

ENTRIES = entries()
#: kind of file -> what must be installed to read it
NEEDS = {
    ".parquet": "pyarrow",
    ".h5": "h5py",
    ".bag": "rosbags",
    ".mcap": "rosbags",
    "_bag": "rosbags",
    ".xlsx": "openpyxl",
}


def case(name):
    """An entry by its name; where its log is read wrongly today, the test expects so."""
    if today := ENTRIES[name].get("fails_today"):
        fails = pytest.mark.xfail(strict=True, raises=AssertionError, reason=today)
        return pytest.param(name, marks=fails)
    return name


@pytest.mark.parametrize("name", list(map(case, ENTRIES)))
def test_a_log_is_read_as_its_entry_states(name, tmp_path):
    entry = ENTRIES[name]
    logs = unpacked(entry, tmp_path)
    for ending, package in NEEDS.items():
        if str(logs[0]).endswith(ending):
            pytest.importorskip(package)
    reading = read(logs, entry.get("options", []), tmp_path / "made")
    assert not differences(entry, reading)


def test_every_file_has_an_entry_and_every_entry_says_something():
    folders = {e["folder"] for e in ENTRIES.values()}
    for folder in folders:
        assert folder.is_dir(), folder
        assert {p for p in folder.parent.iterdir() if p.is_dir()} <= folders
    for name, entry in ENTRIES.items():
        assert not set(entry) - {*OTHERS, *CHANNELS, "folder"}, name
        says = {*CHANNELS, "refused", "sample_time", "says", "stated", "at"}
        assert entry["why"] and says & set(entry), name
