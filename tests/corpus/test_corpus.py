"""Raw logs, each with what must be read from it; see README.md in this folder.

One test for all of them, through the command that a user types.
"""

import pytest
from corpus.reading import CHANNELS, OTHERS, Reading, differences, entries, read, unpacked

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
#: logs of which the picture is drawn too: of the oddest names and units
DRAWN = ("dialects/", "programs/")


def case(name):
    """An entry by its name; where its log is read wrongly today, the test expects so."""
    if today := ENTRIES[name].get("fails_today"):
        fails = pytest.mark.xfail(strict=True, raises=AssertionError, reason=today)
        return pytest.param(name, marks=fails)
    return name


@pytest.mark.parametrize("name", list(map(case, ENTRIES)))
def test_a_log_is_read_as_its_entry_states(name, request, tmp_path):
    entry = ENTRIES[name]
    if name.startswith(DRAWN):
        request.getfixturevalue("picture")
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


@pytest.fixture(scope="module")
def reading(tmp_path_factory):
    """What is read of a log with a position that counts against its force."""
    folder = tmp_path_factory.mktemp("corpus")
    entry = ENTRIES["roles/position_and_velocity_against_the_force"]
    return entry, read(unpacked(entry, folder), [], folder / "made")


@pytest.mark.parametrize(
    "other",
    [
        {"time": {"column": "torque_Nm", "unit": "s"}},
        {"position": {"column": "angle_rad", "unit": "rad"}},  # its sign is turned
        {"position": {"column": "angle_rad", "unit": "deg", "sign": -1}},
        {"interaction_force": {"column": "torque_Nm", "unit": "N*m"}},
        {"axis": "prismatic"},
        {"records": ["fit", "check"]},
        {"sample_time": 0.01},
        {"duration": 3.0},
        {"at": {"position": [-0.8242, -0.3006, 0.8666]}},
        {"at": {"interaction_force": [0.0, 0.0, 0.0]}},
        {"says": ["a word that is not printed"]},
        {"refused": ["force"]},
    ],
)
def test_another_reading_is_reported(reading, other):
    entry, today = reading
    assert not differences(entry, today)
    assert differences({**entry, **other}, today)


def test_a_refusal_is_reported_where_a_reading_is_expected():
    entry = ENTRIES["roles/position_and_velocity_against_the_force"]
    assert differences(entry, Reading(refused="log.csv: found no force"))
    assert differences({"refused": ["position"]}, Reading(refused="log.csv: found no force"))
    assert not differences({"refused": ["force"]}, Reading(refused="log.csv: found no force"))
