"""Commands that write, started in a process of its own, stopped, and held against its rules.

A command hears its signal after its first import: what comes before belongs to Python.
"""

import csv
import gzip
import json
import os
import re
import signal
import subprocess
import sys
import time
import tomllib
from dataclasses import dataclass
from xml.etree import ElementTree

from security.diagram_file import diagram_file
from trust.test_environments import environment
from trust.test_invariance import as_recorded, written

from teleopdesign.cli import main

OLD = b"the one before"
#: s that a stopped process may take to end, and a whole one to run, on a machine that is busy
PATIENCE = 300
FEW = ["--only", "stribeck", "presliding"]

#: raises the signal itself at its n-th look at a file or module, counted from where Ctrl-C is heard
#: (0: never; -n: the n-th after its command is done); writes a byte, at the first of them, and how
#: many the command took, into a pipe
CHILD = """
import os, signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)  # the tests may run where it is ignored
at, pipe = int(sys.argv[1]), int(sys.argv[2])
del sys.argv[1:3]
count = 0
def look(event, arguments):
    global count
    if count or event == "import" and arguments[0] == "teleopdesign.commands._command_line":
        count += 1
        if count == 1:
            os.write(pipe, b"x")
        if count == at:
            os.kill(os.getpid(), 2)
sys.addaudithook(look)
from teleopdesign.cli import main
status = main()
os.write(pipe, str(count).encode())
if at < 0:
    at = count - at
sys.exit(status)
"""

#: 120 points of some ms each
STUDIED = """\
[study]
model = "d.toml"
[axes]
"C.spring_damper.stiffness" = { from = 10, to = 20, points = 60 }
"M.inertia" = [0.1, 0.2]
[simulation]
duration = 0.2
motion.x = { amplitude = 0.01, frequency = 2.0 }
[measures]
hand = { measure = "peak", signal = "x" }
"""


@dataclass(frozen=True)
class WritingCommand:
    """A command, what it writes, and what of it may be there before.

    goes_on: the same command goes on from what it kept;  progress: lines that it may print
    """

    arguments: tuple[str, ...]
    files: tuple[str, ...]
    old: bool = True
    goes_on: bool = False
    progress: str = ""


COMMANDS = {
    "check": WritingCommand(("check", "rod", "--json=OUT/a.json"), ("a.json",)),
    "derive": WritingCommand(
        ("derive", "haptic-interface", "--json=OUT/a.json", "--figure=OUT/a.svg"),
        ("a.json", "a.svg"),
    ),
    "export": WritingCommand(
        ("export", "answer.json", "--to=urdf", "--output=OUT/a.urdf"), ("a.urdf",)
    ),
    "new": WritingCommand(
        ("new", "log.csv", "--yes", "--output=OUT/made"),
        ("made/log.csv", "made/experiment.toml", "made/understood.png"),
        old=False,
    ),
    "passivity": WritingCommand(("passivity", "answer.json", "--json=OUT/a.json"), ("a.json",)),
    "report": WritingCommand(("report", "answer.json", "--output=OUT/a.html"), ("a.html",)),
    "study": WritingCommand(
        ("study", "s.toml", "--workers=2", "--out=OUT/a.nc", "--figure=OUT/a.png"),
        ("a.nc", "a.png"),
        old=False,
        goes_on=True,
        progress="of 120 points|goes on after",
    ),
}


def make_sources(folder):
    """What the commands read."""
    written(as_recorded(), folder / "rod")
    packed = (folder / "rod" / "fit.csv.gz").read_bytes()
    (folder / "log.csv").write_bytes(gzip.decompress(packed))
    (folder / "d.toml").write_text(diagram_file())
    (folder / "s.toml").write_text(STUDIED)
    assert main(["diagnose", str(folder / "rod"), *FEW, f"--json={folder / 'answer.json'}"]) == 0
    return folder


@dataclass(frozen=True)
class Ended:
    """How a process ended; count: looks at files and modules, 0 where it was stopped before."""

    status: int
    output: str
    count: int
    seconds: float


def prepare(command, out):
    """The folder that it writes into, with old files where it may find some."""
    out.mkdir()
    for name in command.files if command.old else ():
        (out / name).write_bytes(OLD)


def run(command, sources, out, *, at=0, after=None, number=signal.SIGINT, room=None):
    """Run it, and stop it at its `at`-th look, or `after` s; then no process of it is left.

    room: bytes that a file may have, as if the disk were full then
    """
    arguments = [a.replace("OUT", str(out)) for a in command.arguments]
    reading, writing = os.pipe()
    began = time.monotonic()
    with subprocess.Popen(
        [sys.executable, "-c", CHILD, str(at), str(writing), *arguments],
        cwd=sources,
        env=environment(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        pass_fds=[writing],
        start_new_session=True,
        preexec_fn=None if room is None else lambda: _limit_files(room),
    ) as process:
        os.close(writing)
        with os.fdopen(reading, "rb", buffering=0) as pipe:
            assert pipe.read(1) == b"x", process.stderr.read()
            began = time.monotonic()
            if after is not None:
                try:
                    process.wait(after)
                except subprocess.TimeoutExpired:
                    _signal(process, number)
            _, output = process.communicate(timeout=PATIENCE)
            seconds = time.monotonic() - began
            count = int(pipe.read() or 0)
    _wait_for_the_group(process.pid)
    return Ended(process.returncode, output, count, seconds)


def _limit_files(room):
    import resource  # not on Windows

    resource.setrlimit(resource.RLIMIT_FSIZE, (room, room))


def _signal(process, number):
    """Ctrl-C goes to all processes of a terminal; what ends a process, to that one."""
    if number == signal.SIGINT:
        os.killpg(process.pid, number)
    else:
        process.send_signal(number)


def _wait_for_the_group(group):
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        try:
            os.killpg(group, 0)
        except (ProcessLookupError, PermissionError):
            return
        time.sleep(0.05)
    raise AssertionError("a process is left")


def violations(command, ended, out, number, before=()):
    """What of the rules does not hold after it was stopped, or ran to its end.

    before: files that an earlier kill left under hidden names
    """
    wrong = []
    if ended.status not in {signal.SIGINT: (0, 130)}.get(number, (0, -number)):
        wrong.append(f"status {ended.status}")
    lines = ended.output.splitlines()
    if ended.status == 130:
        if not lines or not re.match("teleopdesign: stopped", lines.pop()):
            wrong.append("does not say that it was stopped")
    other = [x for x in lines if not command.progress or not re.search(command.progress, x)]
    if other:
        wrong.append(f"says {other}")
    for path in (p for p in out.rglob("*") if p.is_file()):
        if path.name.startswith("."):
            if number == signal.SIGINT and path not in before:
                wrong.append(f"{path.name} is left")
        elif path.suffix != ".part" and not is_whole(path):
            wrong.append(f"{path.name} is half")
    if ended.status == 0:
        missing = [n for n in command.files if not _is_new(out / n)]
        wrong += [f"{n} is missing" for n in missing]
    return wrong


def goes_on(command, sources, out):
    """Run it to its end after it was stopped; what does not hold then.

    What stands whole in its journal is not computed again.
    """
    is_done = (out / command.files[0]).exists()
    before = [p for p in out.rglob(".*")]
    kept = sum(map(_whole_points, out.glob("*.part")))
    ended = run(command, sources, out)
    wrong = violations(command, ended, out, signal.SIGINT, before)
    if ended.status != 0:
        wrong.append(f"does not go on: {ended.status}")
    match = re.search(r"goes on after (\d+)", ended.output)
    if not is_done and (int(match[1]) if match else 0) < kept:
        wrong.append(f"{kept} were kept, says {ended.output!r}")
    return wrong


def _whole_points(part):
    """Points of a journal whose lines are whole."""
    lines = part.read_bytes().splitlines(keepends=True)
    return sum(b'"point":' in x for x in lines if x.endswith(b"}\n"))


def _is_new(path):
    return path.exists() and path.read_bytes() != OLD


def is_whole(path):
    """Whether a file is the one before or a whole new one."""
    content = path.read_bytes()
    if content == OLD:
        return True
    ends = {
        ".png": b"IEND\xaeB`\x82",
        ".html": b"</html>",
        ".svg": b"</svg>",
    }
    if path.suffix == ".json":
        return isinstance(json.loads(content), dict)
    if path.suffix == ".nc":
        return _opens(path)
    if path.suffix == ".toml":
        return bool(tomllib.loads(content.decode())) and content.endswith(b"\n")
    if path.suffix in (".urdf", ".xml"):
        return ElementTree.fromstring(content) is not None
    if path.suffix == ".csv":
        rows = [*csv.reader(content.decode().splitlines())]
        return content.endswith(b"\n") and len({len(r) for r in rows}) == 1
    return content.rstrip(b"\n").endswith(ends[path.suffix])


def _opens(path):
    import xarray

    with xarray.open_dataset(path, engine="h5netcdf") as data:
        return data["hand"].size == 120 and bool(data["hand"].notnull().all())
