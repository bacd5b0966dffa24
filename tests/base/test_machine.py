"""Cores and workers of this process, and machine code that is kept on disk."""

import subprocess
import sys

import pytest

INNER = """from teleopdesign.base.machine import compile_and_keep


@compile_and_keep
def inner(x):
    return {factor} * x
"""
OUTER = """from inner import inner
from teleopdesign.base.machine import compile_and_keep


@compile_and_keep
def outer(x):
    return inner(x) + 1.0


print(outer(1.0))
"""


@pytest.mark.slow
def test_a_caller_does_not_go_on_with_what_an_old_callee_did(tmp_path):
    (tmp_path / "outer.py").write_text(OUTER)
    outputs = []
    for factor in ("2.0", "30.0"):
        (tmp_path / "inner.py").write_text(INNER.format(factor=factor))
        command = [sys.executable, "outer.py"]
        run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
        outputs.append(run.stdout.strip())
    assert outputs == ["3.0", "31.0"]
