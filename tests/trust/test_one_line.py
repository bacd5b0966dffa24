"""Whatever a command meets ends in one line that names the file, and in no traceback."""

import errno
import io
from pathlib import Path

import pytest

import teleopdesign
from teleopdesign.base.files import harmless_cell
from teleopdesign.cli import main
from teleopdesign.commands import effects
from teleopdesign.commands._command_line import TRACEBACK
from teleopdesign.commands._terminal import PrintableStream

ROD = Path(teleopdesign.__file__).parent / "examples" / "rod"
DEEP = 100_000

EFFECT = '''"""Own drag.

    F = D v
"""

import sys

from teleopdesign.effects import Effect, Parameter

{before}


def law(now, p):
    {law}
    return p.drag * now.velocity


EFFECT = Effect(
    role="force",
    law=law,
    parameters={{"drag": Parameter("damping", "D: force per velocity")}},
    absent={{"drag": 0.0}},
    source="made for a test",
)
'''

RAISING = {
    "exit": "sys.exit()",
    "exit with a text": "sys.exit('\\x1b[2J bye')",
    "ValueError": "raise ValueError('two\\nlines')",
    "RecursionError": "exec('f = lambda: f()\\nf()', {})",
    "MemoryError": "raise MemoryError",
    "GeneratorExit": "raise GeneratorExit",
}


def one_line(capsys, arguments, status=2):
    """The one line on stderr of a command that ends with this status."""
    assert main([str(a) for a in arguments]) == status
    output = capsys.readouterr().err
    assert output.count("\n") == 1 and output.startswith("teleopdesign: "), output
    assert output[:-1].isprintable() and len(output) < 1200, output
    return output


@pytest.mark.parametrize("what", RAISING)
@pytest.mark.parametrize("place", ["before", "law"])
def test_an_effect_file_that_raises_anything_is_one_line_with_its_name(
    place, what, tmp_path, capsys
):
    file = tmp_path / "own_drag.py"
    file.write_text(EFFECT.format(**{"before": "", "law": "", place: RAISING[what]}))
    line = one_line(capsys, ["effects", "--effect", file])
    assert "own_drag.py" in line


NO_PYTHON = {
    "UTF-16": EFFECT.encode("utf-16"),
    "null characters": b"\0" * 100,
    "open brackets": b"x = " + b"(" * DEEP,
    "nothing": b"",
    "bytes": bytes(range(256)),
}


@pytest.mark.parametrize("what", NO_PYTHON)
def test_an_effect_file_that_is_no_python_is_one_line_with_its_name(what, tmp_path, capsys):
    file = tmp_path / "own_drag.py"
    file.write_bytes(NO_PYTHON[what])
    assert "own_drag.py" in one_line(capsys, ["effects", "--effect", file])


NO_TOML = {
    "open brackets": b"[" * DEEP,
    "nested lists": b"x = " + b"[" * DEEP,
    "nested tables": b"x = " + b"{a=" * DEEP,
    "a long key": b"a" + b".a" * 20_000 + b" = 1",
    "digits": b"x = " + b"9" * DEEP,
    "UTF-16": "title = 'x'".encode("utf-16"),
    "null characters": b"\0" * 100,
    "bytes": bytes(range(256)),
    "nothing": b"",
    "a code": b"title = '\x1b[2J'",
}


@pytest.mark.parametrize("what", NO_TOML)
@pytest.mark.parametrize("command", ["check", "derive"])
def test_a_toml_file_that_is_none_is_one_line_with_its_name(command, what, tmp_path, capsys):
    name = "experiment.toml" if command == "check" else "own.toml"
    (tmp_path / name).write_bytes(NO_TOML[what])
    line = one_line(capsys, [command, tmp_path if command == "check" else tmp_path / name])
    assert name in line


NO_JSON = {
    "open brackets": b"[" * DEEP,
    "nested tables": b'{"claims":' * DEEP,
    "digits": b"9" * DEEP,
    "UTF-16": '{"claims": []}'.encode("utf-16"),
    "half a pair": b'{"claims": [{"statement": "\\ud800", "certificates": [{}]}]}',
    "certificates of another kind": b'{"claims": [{"statement": 1, "certificates": "x"}]}',
    "certificates in lists": b'{"claims": [{"statement": "", "certificates": [[[]]]}]}',
    "nothing": b"",
    "a code": b'"\\u001b[2J"',
}


@pytest.mark.parametrize("what", NO_JSON)
@pytest.mark.parametrize("option", [["passivity", "--check"], ["design", ROD, "--answer"]])
def test_a_json_file_that_holds_no_result_is_one_line_with_its_name(option, what, tmp_path, capsys):
    file = tmp_path / "own.json"
    file.write_bytes(NO_JSON[what])
    assert "own.json" in one_line(capsys, [*option, file])


# what the system raises, wherever it is raised

OF_SYSTEM = {
    "no memory": (MemoryError(), "needs more memory"),
    "recursion": (RecursionError("too deep"), "nested too deeply"),
    "not UTF-8": (UnicodeDecodeError("utf-8", b"\xff", 0, 1, "invalid"), "expected UTF-8"),
    "a file": (PermissionError(errno.EACCES, "Permission denied", "a\x1bb"), "a\\x1bb: Permission"),
    "a text alone": (OSError("HDF5\nbroke"), "HDF5\\nbroke"),
}


@pytest.mark.parametrize("what", OF_SYSTEM)
def test_an_error_of_the_system_is_one_line_with_status_2(what, capsys, monkeypatch):
    error, expected = OF_SYSTEM[what]

    def fail(options):
        raise error

    monkeypatch.setattr(effects, "run", fail)
    assert expected in one_line(capsys, ["effects"])


def broken(options):
    raise RuntimeError("of our \x1b[2J own\n" + "x" * 9999)


def test_a_mistake_of_the_package_is_one_line_with_status_70(capsys, monkeypatch):
    monkeypatch.setattr(effects, "run", broken)
    monkeypatch.delenv(TRACEBACK, raising=False)
    line = one_line(capsys, ["effects"], status=70)
    assert (
        line.startswith("teleopdesign: internal error in commands/_command_line.py:")
        and "RuntimeError" in line
    )


@pytest.mark.parametrize("by", ["option", "environment"])
def test_a_traceback_is_printed_where_it_is_asked_for(by, capsys, monkeypatch):
    monkeypatch.setattr(effects, "run", broken)
    if by == "environment":
        monkeypatch.setenv(TRACEBACK, "1")
    assert main(["--traceback", "effects"] if by == "option" else ["effects"]) == 70
    output = capsys.readouterr().err
    assert "Traceback (most recent call last)" in output and "\x1b" not in output


# what a terminal is given


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("plain\n\tlines\n", "plain\n\tlines\n"),
        ("\x1b[2J", "\\x1b[2J"),
        ("over\rwritten", "over\\rwritten"),
        ("\u202etxt.exe", "\\u202etxt.exe"),
        ("\ud800", "\\ud800"),
        ("5 \xb1 1 \u03bcm", "5 \xb1 1 \u03bcm"),
    ],
)
def test_a_terminal_is_given_text_alone(text, expected):
    raw = io.BytesIO()
    stream = PrintableStream(io.TextIOWrapper(raw, encoding="utf-8", newline="\n"))
    print(text, end="", file=stream, flush=True)
    assert raw.getvalue().decode() == expected


@pytest.mark.parametrize("text", ["=1+1", "+1", "-1", "@x", "\t=1", "\r=1"])
def test_a_cell_that_a_spreadsheet_would_compute_is_made_a_text(text):
    assert harmless_cell(text) == f"'{text}"


# what is read is not written over


@pytest.fixture
def rod(tmp_path):
    import shutil

    return Path(shutil.copytree(ROD, tmp_path / "rod"))


@pytest.mark.parametrize(
    ("command", "option", "file"),
    [
        ("diagnose", "--predictions", "fit.csv.gz"),
        ("diagnose", "--predictions", "../rod/./check.csv.gz"),
        ("diagnose", "--json", "link.json"),
    ],
)
def test_a_result_in_place_of_what_is_read_is_refused(command, option, file, rod, capsys):
    (rod / "link.json").symlink_to(rod / "experiment.toml")
    before = {p.name: p.read_bytes() for p in rod.iterdir()}
    assert "is read by this command" in one_line(capsys, [command, rod, option, rod / file])
    assert {p.name: p.read_bytes() for p in rod.iterdir()} == before


def test_two_results_in_one_file_are_refused(rod, tmp_path, capsys):
    file = tmp_path / "a.png"
    file.write_bytes(b"")
    (tmp_path / "b.json").symlink_to(file)
    line = one_line(capsys, ["diagnose", rod, "--figure", file, "--json", tmp_path / "b.json"])
    assert "two results" in line
