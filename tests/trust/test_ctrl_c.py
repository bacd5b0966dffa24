"""Ctrl-C at any moment of a command is one line and status 130, and nothing is lost."""

import os
import signal
import subprocess
import sys

import pytest
from trust import stopping
from trust.stopping import COMMANDS, environment, make_sources, prepare, run, violations

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="processes and signals of POSIX")


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    return make_sources(tmp_path_factory.mktemp("sources"))


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
