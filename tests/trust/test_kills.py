"""A command that is stopped at any moment leaves every file whole, and what it kept counts.

TELEOPDESIGN_KILLS=200 stops that many, drawn over all commands, signals and moments of their run;
the test takes a few.
"""

import os
import random
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

SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
KILLS = int(os.environ.get("TELEOPDESIGN_KILLS", "0"))


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    return make_sources(tmp_path_factory.mktemp("sources"))


def stopped(name, sources, folder, *, after, number):
    """What does not hold after it was stopped, and once it has gone on; and its status."""
    command, out = COMMANDS[name], folder / "out"
    prepare(command, out)
    ended = run(command, sources, out, after=after, number=number)
    wrong = violations(command, ended, out, number)
    if command.goes_on and not wrong:
        wrong = goes_on(command, sources, out)
    return wrong, ended.status


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "number"),
    [("passivity", signal.SIGTERM), ("study", signal.SIGKILL)],
)
def test_a_stopped_command_leaves_whole_files_and_goes_on(name, number, sources, tmp_path):
    wrong, _ = stopped(name, sources, tmp_path, after=2.0, number=number)
    assert wrong == []


@pytest.mark.slow
@pytest.mark.parametrize("name", [*COMMANDS] if KILLS else ["derive", "report"])
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


@pytest.mark.slow
@pytest.mark.skipif(not KILLS, reason="TELEOPDESIGN_KILLS says how many")
def test_many_stopped_commands_leave_whole_files_and_go_on(sources, tmp_path):
    seed = int(os.environ.get("TELEOPDESIGN_SEED", KILLS))
    chance, problems, counted, usual = random.Random(seed), [], {}, {}
    for turn in range(KILLS):
        name, number = chance.choice([*COMMANDS]), chance.choice(SIGNALS)
        if name not in usual:  # s that the whole command takes on this machine as it is now
            folder = tmp_path / name
            folder.mkdir()
            prepare(COMMANDS[name], folder / "out")
            usual[name] = run(COMMANDS[name], sources, folder / "out").seconds
        after = usual[name] * chance.uniform(0.02, 1.05)
        folder = tmp_path / str(turn)
        folder.mkdir()
        wrong, status = stopped(name, sources, folder, after=after, number=number)
        counted[status] = counted.get(status, 0) + 1
        if wrong:
            problems.append((name, number.name, round(after, 3), wrong))
        print(turn, name, number.name, round(after, 2), status, wrong, flush=True)
    print(f"{KILLS} stopped; statuses {counted}")
    assert problems == []
