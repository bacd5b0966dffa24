"""An effect, control law, command, check, theorem or shape of logs is one added file."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import teleopdesign as td

ROOT = Path(td.__file__).parent

EFFECT = '''"""Throw-away: a force in proportion to the cube of velocity.

    F = c v^3

Holds nowhere; a test adds it.
"""

from ._effect import Effect, Parameter


def law(now, p):
    return p.cubic_damping * now.velocity**3


EFFECT = Effect(
    role="force",
    energy="dissipates",
    law=law,
    parameters={"cubic_damping": Parameter("damping", "c: force per velocity cubed")},
    absent={"cubic_damping": 0.0},
    source="a test",
)
'''

CONTROLLER = '''"""Throw-away: a force in proportion to velocity."""

from ..effects import Parameter
from ._controller import ControlLaw


def law(now, p):
    return p.gain * now.velocity


CONTROLLER = ControlLaw(
    law=law,
    linear=True,
    parameters={"gain": Parameter("damping", "force per velocity")},
    source="a test",
)
'''

WITH_CONTROLLER = """[diagram]
kind = "haptic interface"

[blocks.Z_M]

[blocks.C]
law = "throw_away"
parameters = { gain = 1.5 }
"""

COMMAND = '''"""greet whoever runs a test"""


def add(parser):
    """Arguments of the command."""
    parser.add_argument("--loudly", action="store_true", help="greet in capitals")


def run(options):
    """Greet."""
    print("HELLO" if options.loudly else "hello")
    return 0
'''


THEOREM = '''"""Throw-away: nothing is settled about any device."""

from ..claims.claim import Claim, Unknown
from ._theorem import TopicClaim

ORDER = 1000


def claims(question):
    """Nothing."""
    return [TopicClaim("throw-away", Claim("nothing", Unknown("a test")))]
'''

CHECK = '''"""Throw-away: every recording is remarkable."""

from ..base.finding import Finding
from ._recording import RecordingCheck


def find_remarkable_recordings(recording):
    yield Finding("throw-away", "note", "a remarkable recording.")


CHECK = RecordingCheck(order=5, find=find_remarkable_recordings)
'''

SHAPE = '''"""Throw-away: columns whose names all begin with "zz "."""

from __future__ import annotations

from ._table import CellTable, LongSignal, LongTable, time_of


def throw_away(table: CellTable) -> LongTable | None:
    """Signals named without their first letters."""
    if not all(name.startswith("zz ") for name in table.names):
        return None
    clock, numeric = time_of(table), table.numeric
    signals = [
        LongSignal(name[3:], values, clock[3:], numeric[clock], "", "s")
        for name, values in numeric.items()
        if name != clock
    ]
    return LongTable(tuple(signals), 0, "a throw-away")
'''

ASK = """
from teleopdesign import Body, EFFECTS
from teleopdesign.passivity.identified import identify_device
from teleopdesign.passivity.theorems import Question, settle

body = Body("prismatic", {"inertia": 0.15}).with_effect(EFFECTS["coulomb"], {"level": 0.5})
print(*[one.topic for one in settle(Question(identify_device(body)), simulated=False)])
"""


pytestmark = pytest.mark.slow  # each starts a process with a package of its own


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """A folder that holds a copy of the package."""
    folder = tmp_path_factory.mktemp("one_file_each")
    # with its bytecode, which is that of files of the same time: no process compiles it again
    shutil.copytree(ROOT, folder / ROOT.name, ignore=shutil.ignore_patterns("*.nb?"))
    return folder


@pytest.fixture
def add_file(copy):
    """Adds one file to the copy; the file goes again after the test."""
    added = []

    def add(path, text):
        added.append(copy / ROOT.name / path)
        assert not added[-1].exists()
        added[-1].write_text(text, encoding="utf-8")

    yield add
    for path in added:
        path.unlink()


def run(copy, *arguments):
    """What `teleopdesign` of the copy prints for these arguments; it must succeed."""
    done = finished(copy, *arguments)
    assert done.returncode == 0, done.stderr
    return done.stdout


def finished(copy, *arguments):
    """The finished process of `teleopdesign` of the copy with these arguments."""
    return subprocess.run(
        [sys.executable, "-m", "teleopdesign.cli", *arguments],
        cwd=copy,
        env=os.environ | {"PYTHONPATH": str(copy), "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
    )


def test_an_effect_is_one_file(copy, add_file):
    add_file("effects/throw_away.py", EFFECT)
    page = run(copy, "effects", "throw_away")
    assert page.startswith("throw_away  (force)")
    assert "cubic_damping" in page
    assert "throw_away" in run(copy, "effects")


def test_a_control_law_is_one_file(copy, add_file, tmp_path):
    path = tmp_path / "diagram.toml"
    path.write_text(WITH_CONTROLLER, encoding="utf-8")
    assert "throw_away" in finished(copy, "derive", str(path)).stderr  # no such law yet
    add_file("controllers/throw_away.py", CONTROLLER)
    assert "R_MBC = C L" in run(copy, "derive", str(path))


def test_a_command_is_one_file(copy, add_file):
    add_file("commands/throw_away.py", COMMAND)
    assert "--loudly" in run(copy, "throw-away", "--help")
    assert run(copy, "throw-away", "--loudly") == "HELLO\n"


def test_a_check_of_recordings_is_one_file(copy, add_file):
    add_file("check/throw_away.py", CHECK)
    assert "a remarkable recording" in run(copy, "check", str(td.example("rod")))


def test_a_theorem_is_one_file(copy, add_file):
    def topics():
        environment = os.environ | {"PYTHONPATH": str(copy), "PYTHONDONTWRITEBYTECODE": "1"}
        command = [sys.executable, "-c", ASK]
        done = subprocess.run(command, cwd=copy, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout

    assert "throw-away" not in topics()
    add_file("passivity/theorems/throw_away.py", THEOREM)
    assert "throw-away" in topics()


def test_a_shape_of_logs_is_one_file_and_its_line_in_the_list(copy, add_file, tmp_path):
    rows = [f"{0.01 * k:.2f},{0.1 * (k % 7)},{k % 5}" for k in range(300)]
    log = tmp_path / "log.csv"
    log.write_text("\n".join(["zz time,zz pos_rad,zz torque_Nm", *rows]), encoding="utf-8")
    command = ("new", str(log), "--yes", "--output", str(tmp_path / "made"), "--overwrite")
    assert '"zz pos_rad"' in run(copy, *command)
    add_file("measurement/doors/shapes/throw_away.py", SHAPE)
    listing = copy / ROOT.name / "measurement/doors/shapes/__init__.py"
    before = listing.read_text(encoding="utf-8")
    line = "from .throw_away import throw_away\n"
    added = before.replace("from .several_clocks", f"{line}from .several_clocks")
    try:
        added = added.replace(
            "    reading_in_each_row,\n)", "    reading_in_each_row, throw_away,\n)"
        )
        listing.write_text(added, encoding="utf-8")
        assert '"pos_rad"' in run(copy, *command)
    finally:
        listing.write_text(before, encoding="utf-8")


def test_a_column_of_the_table_of_candidates_is_one_line(copy, tmp_path):
    answer = tmp_path / "answer.json"
    few = ("--only", "coulomb", "viscous", "stribeck")
    run(copy, "diagnose", str(td.example("rod")), *few, "--json", str(answer))
    table = copy / ROOT.name / "show/report/candidate_table.py"
    before = table.read_text(encoding="utf-8")
    line = '= {"throw-away": (lambda one: 100.0 * one.check_error, 0.0), "probability": ('
    try:
        table.write_text(before.replace('= {\n    "probability": (', line), encoding="utf-8")
        run(copy, "report", str(answer))
    finally:
        table.write_text(before, encoding="utf-8")
    page = answer.with_suffix(".html").read_text(encoding="utf-8")
    assert ">throw-away</th>" in page and ">probability</th>" in page
