"""A command leaves no home behind where there was none."""

import os
from pathlib import Path

import pytest

from teleopdesign.commands._command_line import PLACE, keep_home_absent


def place_within(monkeypatch, home, **places):
    """Where matplotlib would keep its files within a command, and whether that is there then."""
    monkeypatch.delenv(PLACE, raising=False)
    monkeypatch.setenv("HOME", str(home))
    for name, path in places.items():
        monkeypatch.setenv(name, str(path))
    with keep_home_absent():
        path = os.environ.get(PLACE)
        return path, path is not None and Path(path).is_dir()


@pytest.mark.skipif(os.name != "posix", reason="a home is named otherwise")
def test_a_home_that_is_not_there_is_not_made_by_what_a_command_imports(monkeypatch, tmp_path):
    path, was_there = place_within(monkeypatch, tmp_path / "nobody")
    assert was_there and not Path(path).exists()
    assert PLACE not in os.environ
    assert not (tmp_path / "nobody").exists()


@pytest.mark.skipif(os.name != "posix", reason="a home is named otherwise")
def test_a_home_or_a_stated_place_is_left_to_matplotlib(monkeypatch, tmp_path):
    assert place_within(monkeypatch, tmp_path) == (None, False)
    monkeypatch.setenv(PLACE, str(tmp_path))
    monkeypatch.setenv("HOME", str(tmp_path / "nobody"))
    with keep_home_absent():
        assert os.environ[PLACE] == str(tmp_path)
    assert os.environ[PLACE] == str(tmp_path)
