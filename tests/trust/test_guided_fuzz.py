"""Fuzzing that follows the branches of a reader: it ends well, and tells of a file that fails."""

import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).with_name("guided_fuzz.py")

pytestmark = pytest.mark.slow


def run(*arguments):
    pytest.importorskip("atheris", reason="needs the extra fuzz")
    command = [sys.executable, str(SCRIPT), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_no_file_of_a_short_run_fails(tmp_path):
    done = run("experiment", "--runs", "200", "--folder", str(tmp_path))
    assert (done.returncode, done.stdout) == (0, "experiment: no failure\n"), done.stderr[-2000:]
    assert not list(tmp_path.iterdir())


def test_a_file_that_fails_is_kept(tmp_path):
    """A reader that fails at a bracket, which fuzzing soon finds."""
    code = f"""
import sys
from pathlib import Path
from types import SimpleNamespace
import atheris

sys.path.insert(0, {str(SCRIPT.parent)!r})
import guided_fuzz

@atheris.instrument_func
def read_spoilt(reader, content):
    if content[:1] == b"[":
        raise AssertionError("a bracket")

here = Path({str(tmp_path)!r})
sys.modules["trust"] = SimpleNamespace()
sys.modules["trust.fuzzing"] = SimpleNamespace(
    CORPUS=here, READERS={{"study": (b"study",)}}, TOKENS=(b"[",), read_spoilt=read_spoilt
)
seeds = here / "seeds"
seeds.mkdir()
guided_fuzz.fuzz("study", 20000, seeds, here)
"""
    pytest.importorskip("atheris", reason="needs the extra fuzz")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=False)
    kept = list(tmp_path.glob("study-crash-*"))
    assert done.returncode != 0
    assert [path.read_bytes()[:1] for path in kept] == [b"["]


def test_an_unknown_reader_is_refused_in_one_line():
    done = run("diagramm")
    assert done.returncode == 2
    assert done.stderr.startswith("unknown reader diagramm, expected one of experiment, csv")
    assert len(done.stderr.splitlines()) == 1
