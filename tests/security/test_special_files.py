"""Pipes, devices and links in the place of files: each command ends, in one line, in little memory.

A pipe that nobody writes into held a reader for ever; /dev/zero filled the memory.
"""

import os
import resource
import stat
import sys

import pytest
from clock import in_time
from measurement.rod_example import ROD, write_rod

from teleopdesign.base.files import read_whole
from teleopdesign.cli import main
from teleopdesign.passivity.checker import check as checker

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="pipes and devices of Unix")


def pipe(path):
    os.mkfifo(path)


def device(path):
    path.symlink_to("/dev/zero")


def ring(path):
    path.symlink_to(path.name)


def folder(path):
    path.mkdir()


ODD = [pipe, device, ring, folder]
COMMANDS = {
    "d.toml": ("derive", "d.toml"),
    "s.toml": ("study", "s.toml"),
    "c.json": ("passivity", "--check", "c.json"),
    "a.json": ("passivity", "a.json", "--dahl", "0.4", "1e4"),
}


@pytest.mark.parametrize("name", COMMANDS)
@pytest.mark.parametrize("make", ODD, ids=lambda f: f.__name__)
def test_a_command_ends_in_one_line_where_its_file_is_none(
    guard, tmp_path, monkeypatch, capsys, name, make
):
    monkeypatch.chdir(tmp_path)
    make(tmp_path / name)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with in_time():
        assert main(list(COMMANDS[name])) == 2
    output = capsys.readouterr().err
    assert output.count("\n") == 1 and name in output
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss < before + 1e6  # kB


@pytest.mark.parametrize("name", ["fit.csv", "experiment.toml"])
@pytest.mark.parametrize("make", ODD, ids=lambda f: f.__name__)
def test_an_experiment_of_such_files_is_one_line(guard, tmp_path, capsys, name, make):
    rod = write_rod(tmp_path / "rod")
    (rod / name).unlink()
    make(rod / name)
    with in_time():
        assert main(["check", str(rod)]) == 2
    output = capsys.readouterr().err
    assert output.count("\n") == 1 and name in output


@pytest.mark.parametrize("make", ODD, ids=lambda f: f.__name__)
def test_the_checker_alone_ends_as_well(tmp_path, capsys, make):
    make(tmp_path / "c.json")
    with in_time():
        assert checker_main([str(tmp_path / "c.json")]) == 1
    assert "refused" in capsys.readouterr().out


def checker_main(paths):
    from teleopdesign.passivity.checker.check import main as run

    assert callable(checker)
    return run(paths)


@pytest.mark.parametrize(
    "text", ["/etc/passwd", "../../../../../../../../etc/passwd", "http://127.0.0.1:9/x.csv"]
)
def test_no_line_of_a_file_that_an_experiment_points_to_is_shown(guard, tmp_path, capsys, text):
    rod = write_rod(tmp_path / "rod")
    (rod / "experiment.toml").write_text(ROD.replace("fit.csv", text))
    with in_time():
        assert main(["check", str(rod)]) == 2
    output = capsys.readouterr()
    assert output.err.count("\n") == 1 and "root:" not in output.err + output.out


def test_what_a_shell_hands_over_as_a_pipe_is_read_as_a_file(tmp_path):
    read, write = os.pipe()
    os.write(write, b"abc")
    os.close(write)
    assert stat.S_ISFIFO(os.fstat(read).st_mode)
    assert read_whole(f"/dev/fd/{read}") == b"abc"
    os.close(read)


def test_a_pipe_from_which_nothing_comes_is_given_up(tmp_path, monkeypatch):
    from teleopdesign.base import files

    monkeypatch.setattr(files, "_PATIENCE", 0.05)
    read, write = os.pipe()
    with pytest.raises(OSError, match="nothing came"):
        read_whole(f"/dev/fd/{read}")
    os.close(read)
    os.close(write)


def test_a_file_is_read_up_to_its_limit(tmp_path):
    path = tmp_path / "x"
    path.write_bytes(b"x" * 3_000_000)
    assert len(read_whole(path)) == 3_000_000 == len(read_whole(path, largest=3_000_000))
    with pytest.raises(OSError, match="more than"):
        read_whole(path, largest=2_999_999)
