"""Messages of bags, digests of files, and numbers and texts as users type them."""

import hashlib
from dataclasses import dataclass, field

import numpy as np
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.base.toml import inline_text, key_text, string_text
from teleopdesign.measurement.doors import bag
from teleopdesign.measurement.files import content_digest, experiment_files, is_experiment
from teleopdesign.measurement.numbers_in_cells import numbers_of
from teleopdesign.measurement.value_text import plain_number, split_value

# messages of a bag


@dataclass
class Header:
    frame: float = 1.0


@dataclass
class Point:
    x: float
    y: float = 2.0
    __msgtype__: str = "Point"


@dataclass
class Message:
    name: list
    q: list
    point: Point
    header: Header = field(default_factory=Header)
    layout: Header = field(default_factory=Header)
    flag: bool = True
    words: list = field(default_factory=lambda: ["a", "b", "c"])
    other: list = field(default_factory=lambda: [8.0, 9.0, 10.0])


def test_a_message_is_flattened_to_its_numbers():
    rows = {}
    message = Message(["a", "b"], [1.0, -1.0], Point(5.0))
    bag._append(rows, message, 2_500_000_000, 1_000_000_000)
    assert {n: v for n, v in rows.items() if n not in ("stamp", "written")} == {
        "a.q": [1.0], "b.q": [-1.0], "point.x": [5.0], "point.y": [2.0], "flag": [1.0],
        "other[0]": [8.0], "other[1]": [9.0], "other[2]": [10.0],
    }  # fmt: skip
    assert rows["stamp"] == rows["written"] == [1.5]


@pytest.mark.parametrize(
    ("late", "clock"), [(10.0, "stamp"), (10.5, "written"), (-10.5, "written")]
)
def test_stamps_ten_seconds_off_are_of_another_clock(late, clock):
    written = np.arange(5.0)
    rows = {"stamp": [*(written + late)], "written": [*written], "x": [1.0] * 3}
    columns = bag._columns({"/a": rows, "/none": {"stamp": [0.0], "written": [0.0]}})
    assert set(columns) == {"/a.stamp", "/a.x"}
    assert columns["/a.stamp"].tolist() == rows[clock]
    assert np.array_equal(columns["/a.x"], [1.0] * 3 + [np.nan] * 2, equal_nan=True)
    assert bag._topic("/a/b.x.y", ["/a", "/a/b", "/a/b.x"]) == "/a/b.x"


# files, texts and numbers


def test_the_digest_is_that_of_names_and_contents(tmp_path):
    (tmp_path / "experiment.toml").write_bytes(
        b'[[records]]\nfile = "a.csv"\n[[records]]\nfile = "b"\n'
    )
    (tmp_path / "a.csv").write_bytes(b"t,x\n")
    (tmp_path / "b").mkdir()
    (tmp_path / "b" / "c.csv").write_bytes(b"t,F\n")
    parts = [(p, (tmp_path / p).read_bytes()) for p in ("experiment.toml", "a.csv", "b/c.csv")]
    whole = b"".join(name.encode() + b"\0" + content + b"\0" for name, content in parts)
    assert content_digest(tmp_path) == hashlib.sha256(whole).hexdigest()
    (tmp_path / "a.csv").unlink()
    assert experiment_files(tmp_path)["a.csv"] is None
    parts[1] = "a.csv", b"no file"
    whole = b"".join(name.encode() + b"\0" + content + b"\0" for name, content in parts)
    assert content_digest(tmp_path) == hashlib.sha256(whole).hexdigest()


def test_a_folder_with_experiment_toml_is_an_experiment(tmp_path):
    assert not is_experiment(tmp_path) and not is_experiment(tmp_path / ("x" * 5000))
    (tmp_path / "experiment.toml").mkdir()
    assert not is_experiment(tmp_path)
    (tmp_path / "experiment.toml").rmdir()
    (tmp_path / "experiment.toml").write_text("")
    assert is_experiment(tmp_path)


def test_keys_and_texts_of_toml():
    assert [key_text(n) for n in ("a-b_1", "a b", "é", "", "a.b")] == [
        "a-b_1", '"a b"', '"é"', '""', '"a.b"',
    ]  # fmt: skip
    assert string_text('é "q"\x7f\n') == '"é \\"q\\"\\u007f\\n"'
    assert inline_text({}) == "{}" and inline_text({"a": "1", "b": '"x"'}) == '{ a = 1, b = "x" }'


def test_a_plain_number_may_have_a_decimal_comma():
    assert plain_number("3,5", where="x") == 3.5 == plain_number(" 3.5", where="x")
    for text in ("", "three", "inf", "nan", "1,000.5"):
        with pytest.raises(ExperimentError, match="x: found .*, expected a number"):
            plain_number(text, where="x")
    assert split_value(" -.5e1 N*m/A ") == (-5.0, "N*m/A") and split_value("1e999 m") is None
    assert split_value("7") == (7.0, "") and split_value("m 7") is None


@pytest.mark.parametrize("kind", [np.int64, np.uint64])
def test_stamps_of_whole_nanoseconds_count_from_the_first_in_either_direction(kind):
    """Above 2^53 float64 skips some of them; a row out of order is earlier than the first."""
    long = 2**53 + 3
    stamps = np.array([long, long + 1, long - 2], dtype=kind)
    assert numbers_of(stamps, "t", "log").tolist() == [0.0, 1.0, -2.0]
    short = np.array([2**53, 2**53 - 1], dtype=kind)
    assert numbers_of(short, "t", "log").tolist() == [2.0**53, 2.0**53 - 1]
