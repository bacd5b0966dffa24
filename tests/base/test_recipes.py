"""A user's Python file: run as it was read, and nothing is written beside it."""

import os
import re
import sys

import pytest
from users_effect import SOURCE

from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import load_controller
from teleopdesign.effects import load_effect

LOADERS = {"effect": load_effect, "control law": load_controller}


def test_an_edit_that_keeps_size_and_time_of_the_file_is_read(tmp_path, monkeypatch):
    """Bytecode kept by Python is told by size and time of the file: it would run the old effect."""
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    path = tmp_path / "drag.py"
    path.write_text(SOURCE)
    assert load_effect(path).source == "made for a test"
    stamp = path.stat()
    path.write_text(SOURCE.replace("made for a test", "made for a TEST"))
    os.utime(path, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))
    assert path.stat().st_size == stamp.st_size
    assert load_effect(path).source == "made for a TEST"
    assert [p.name for p in tmp_path.iterdir()] == ["drag.py"]


@pytest.mark.parametrize("what", LOADERS)
def test_a_file_that_is_no_python_file_is_one_line(tmp_path, what):
    (tmp_path / "mine.txt").write_text("EFFECT = 3")
    with pytest.raises(ModelError, match=r"expected \.py"):
        LOADERS[what](tmp_path / "mine.txt")


@pytest.mark.parametrize(
    ("right", "wrong", "message"),
    [
        ("now.velocity *", "now.velocty *", 'now has no "velocty"; did you mean "velocity"?'),
        ("p.drag *", "p.darg *", 'p has no "darg"; did you mean "drag"?'),
        ("p.drag *", "p.velocity *", 'p has no "velocity"'),
        ("now.velocity *", "now.drag *", 'now has no "drag"'),
    ],
)
def test_a_misspelt_signal_or_parameter_of_a_law_is_named(tmp_path, right, wrong, message):
    """Not as Python does: "'types.SimpleNamespace' object has no attribute 'velocty'"."""
    assert right in SOURCE
    path = tmp_path / "drag.py"
    path.write_text(SOURCE.replace(right, wrong))
    with pytest.raises(ModelError, match=f"^{re.escape(str(path))}: law: {re.escape(message)}$"):
        load_effect(path)
