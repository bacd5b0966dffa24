"""A command that is stopped at any moment leaves every file whole, and what it kept counts."""

import re
import signal
import sys

import pytest
from trust.stopping import (
    COMMANDS,
    goes_on,
    is_whole,
    make_sources,
    prepare,
    run,
    violations,
)

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    return make_sources(tmp_path_factory.mktemp("sources"))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "number"),
    [("passivity", signal.SIGTERM), ("study", signal.SIGKILL)],
)
def test_a_stopped_command_leaves_whole_files_and_goes_on(name, number, sources, tmp_path):
    command, out = COMMANDS[name], tmp_path / "out"
    prepare(command, out)
    ended = run(command, sources, out, after=2.0, number=number)
    assert violations(command, ended, out, number) == []
    if command.goes_on:
        assert goes_on(command, sources, out) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", ["derive", "report"])
def test_a_disk_that_is_full_leaves_whole_files_and_says_so(name, sources, tmp_path):
    """No file can have more than 300 bytes: what was there stays, and nothing half stands."""
    command, out = COMMANDS[name], tmp_path / "out"
    prepare(command, out)
    ended = run(command, sources, out, room=300)
    lines = [x for x in ended.output.splitlines() if not re.search(command.progress or "^$", x)]
    assert ended.status == 2 and len(lines) == 1, ended
    assert "File too large" in lines[0]
    for path in (p for p in out.rglob("*") if p.is_file() and p.suffix != ".part"):
        assert not path.name.startswith(".") and is_whole(path), path
