"""Ctrl-C at any moment of a command is one line and status 130; nothing is lost or printed beside.

TELEOPDESIGN_MOMENTS=0.1 interrupts three commands every 0.1 s of processor time. No test does it
unasked: where those moments fall is chance, and libraries drop one in some hundred interrupts.
"""

import os
import signal
import subprocess
import sys

import pytest
from trust import stopping
from trust.stopping import COMMANDS, environment, make_sources, prepare, run, violations

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="processes and signals of POSIX")

#: s of processor time between two interrupts
BETWEEN = float(os.environ.get("TELEOPDESIGN_MOMENTS", "0"))

#: every so often a copy of the process is interrupted there; what becomes of it goes into a folder
SWEEP = """
import os, signal, sys, threading
signal.signal(signal.SIGINT, signal.default_int_handler)  # the tests may run where it is ignored
folder, between = sys.argv[1], float(sys.argv[2])
del sys.argv[1:3]
all_copies = open(os.path.join(folder, "all"), "w")
moment, is_copy, is_begun = 0, False, False
def interrupt_a_copy(*_):
    global moment, is_copy
    if threading.active_count() > 1:  # they would be missing in the copy
        return
    moment += 1
    copy = os.fork()
    if copy == 0:
        is_copy = True
        signal.setitimer(signal.ITIMER_PROF, 0)
        os.dup2(os.open(os.path.join(folder, str(moment)), os.O_WRONLY | os.O_CREAT), 2)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        signal.alarm(120)  # it waits, or goes on as if nothing had been
        os.kill(os.getpid(), signal.SIGINT)
        return
    _, status = os.waitpid(copy, 0)
    print(moment, os.waitstatus_to_exitcode(status), file=all_copies, flush=True)
def begin(event, arguments):
    global is_begun
    if is_begun or event != "import" or arguments[0] != "teleopdesign.commands._command_line":
        return
    is_begun = True
    signal.setitimer(signal.ITIMER_PROF, between / 20, between)
signal.signal(signal.SIGPROF, interrupt_a_copy)
sys.addaudithook(begin)
from teleopdesign.cli import main
status = main()
signal.setitimer(signal.ITIMER_PROF, 0)
if is_copy:
    os._exit(status)
sys.exit(status)
"""


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    return make_sources(tmp_path_factory.mktemp("sources"))


@pytest.mark.slow
@pytest.mark.skipif(not BETWEEN, reason="TELEOPDESIGN_MOMENTS says how often")
@pytest.mark.parametrize("name", ["check", "derive", "passivity"])
def test_an_interrupt_at_any_moment_is_one_line_and_status_130(name, sources, tmp_path):
    command, log = COMMANDS[name], tmp_path / "log"
    prepare(command, tmp_path / "out")
    log.mkdir()
    arguments = [a.replace("OUT", str(tmp_path / "out")) for a in command.arguments]
    subprocess.run(
        [sys.executable, "-c", SWEEP, str(log), str(BETWEEN), *arguments],
        cwd=sources,
        env=environment(),
        capture_output=True,
        timeout=stopping.PATIENCE,
    )
    moments = [line.split() for line in (log / "all").read_text().splitlines()]
    assert len(moments) >= 3
    wrong = {
        (moment, status): text
        for moment, status in moments
        if (text := (log / moment).read_text()) != "teleopdesign: stopped\n" or status != "130"
    }
    assert wrong == {}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "at"),
    [("export", 1), ("new", 40), ("study", 20), ("derive", -3), ("check", -9)],
)
def test_an_interrupt_between_import_and_exit_leaves_whole_files(name, at, sources, tmp_path):
    command = COMMANDS[name]
    prepare(command, tmp_path / "out")
    ended = run(command, sources, tmp_path / "out", at=at)
    assert violations(command, ended, tmp_path / "out", signal.SIGINT) == []
    assert ended.status == (0 if at < 0 else 130)


def ctrl_c_heard(code):
    """stderr and status of a process that runs this within its command."""
    head = (
        "import sys, types\nfrom teleopdesign import cli\n"
        "made = types.ModuleType('teleopdesign.commands._command_line')\n"
        "sys.modules['teleopdesign.commands._command_line'] = made\n"
        "import os, signal, time\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "def ctrl_c(): os.kill(os.getpid(), signal.SIGINT)\n"
        "def run(arguments, is_stopped):\n    "
    )
    tail = "\n    return 0\nmade.run = run\nstatus = cli.main()\n"
    done = subprocess.run(
        [sys.executable, "-c", head + code.replace("\n", "\n    ") + tail + "sys.exit(status)"],
        capture_output=True,
        text=True,
        env=environment(),
        timeout=stopping.PATIENCE,
    )
    return done.stderr, done.returncode


STOPPED = ("teleopdesign: stopped\n", 130)


def test_an_interrupt_where_nothing_can_catch_it_is_not_lost():
    code = """
class Thing:
    def __del__(self):
        ctrl_c()
thing = Thing()
del thing
time.sleep(2 * 300)"""  # longer than the patience of the test
    assert ctrl_c_heard(code) == STOPPED


def test_an_interrupt_while_a_module_in_c_is_imported_waits_for_its_end():
    """What such a module calls of Python is on its way into C, which may drop the interrupt."""
    code = """
import traceback
from importlib import util
spec = util.find_spec('_lsprof')  # imported by nothing else here
sys.addaudithook(lambda event, _: event == 'import' and ctrl_c())
try:
    util.module_from_spec(spec)
    time.sleep(2 * 300)
except KeyboardInterrupt as stop:
    assert 'create_module' not in [f.name for f in traceback.extract_tb(stop.__traceback__)]
    raise"""
    assert ctrl_c_heard(code) == STOPPED


def test_a_second_interrupt_while_the_first_is_reported_changes_nothing():
    code = """
import builtins
def say(*_, **__):
    sys.stderr.write('teleopdesign: stopped\\n')
    ctrl_c()
builtins.print = say
ctrl_c()"""
    assert ctrl_c_heard(code) == STOPPED


def test_an_error_that_a_library_made_of_an_interrupt_is_no_mistake(monkeypatch, capsys):
    from teleopdesign.commands import _command_line, effects

    def broken(options):
        raise ImportError("initialisation failed")

    monkeypatch.setattr(effects, "run", broken)
    with pytest.raises(KeyboardInterrupt):
        _command_line.run(["effects"], lambda: True)
    assert _command_line.run(["effects"]) == 70
    assert "please report it" in capsys.readouterr().err
