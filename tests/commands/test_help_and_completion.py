"""What help shows is what commands take, and shells complete it."""

import argparse
import re
import shlex
import subprocess

import pytest

from teleopdesign import EFFECTS
from teleopdesign.cli import _parser, main

PARSER = _parser()
COMMANDS = next(a for a in PARSER._actions if isinstance(a, argparse._SubParsersAction)).choices


def examples(name):
    """Every command line of the examples in a command's help."""
    text = COMMANDS[name].format_help().partition("examples:\n")[2]
    results = []
    for line in text.splitlines():
        command = re.search(r"teleopdesign [^|)#]*", line)
        assert command, f"{name}: {line!r} is no command"
        # what explains a command stands two spaces or more behind it
        results.append(re.split(r"\s{2,}", command[0].strip())[0])
    return results


@pytest.mark.parametrize("name", sorted(COMMANDS))
def test_the_help_of_every_command_has_examples_that_its_parser_takes(name):
    lines = examples(name)
    assert lines
    for line in lines:
        words = shlex.split(line)
        assert PARSER.parse_args(words[1:]).run is not None
        assert words[1] == name


def script_of(shell):
    """What the command prints."""
    import io
    from contextlib import redirect_stdout

    with redirect_stdout(io.StringIO()) as printed:
        assert main(["completion", shell]) == 0
    return printed.getvalue()


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_script_of_a_shell_knows_every_command_option_and_effect(shell):
    script = script_of(shell)
    for name, command in COMMANDS.items():
        assert name in script
        for option in (o for a in command._actions for o in a.option_strings):
            wanted = option if shell != "fish" else option.lstrip("-")
            assert wanted in script, (name, option)
    assert all(effect in script for effect in EFFECTS)


@pytest.fixture(scope="module")
def bash_script():
    return script_of("bash")


def complete_in_bash(script, folder, *words):
    """What bash offers for the last of these words."""
    listed = " ".join(map(shlex.quote, words))
    code = (
        f"{script}\nCOMP_WORDS=({listed}); COMP_CWORD={len(words) - 1}\n"
        "$(complete -p teleopdesign | sed -E 's/.*-F ([^ ]+).*/\\1/')\n"
        'printf "%s\\n" "${COMPREPLY[@]}"'
    )
    done = subprocess.run(
        ["bash", "-c", code], capture_output=True, text=True, cwd=folder, timeout=300
    )
    assert done.stderr == ""
    return done.stdout.split()


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["diag"], ["diagnose"]),
        (["diagnose", "--qu"], ["--quick"]),
        (["diagnose", "rod", "--only", "stri"], ["stribeck"]),
        (["diagnose", "rod", "--only", "stribeck", "pres"], ["presliding"]),
        (["effects", "back"], ["backlash"]),
        (["new", "log.csv", "--axis", "re"], ["revolute"]),
        (["diagnose", "ro"], ["rod"]),
        (["diagnose", "rod", "--report", "re"], ["report.html"]),
    ],
)
def test_bash_completes_commands_options_effects_and_files(words, expected, bash_script, tmp_path):
    (tmp_path / "rod").mkdir()
    (tmp_path / "report.html").touch()
    assert complete_in_bash(bash_script, tmp_path, "teleopdesign", *words) == expected


def test_an_unknown_shell_is_one_line(refused):
    assert 'no shell "bsh"' in refused("completion", "bsh")
    assert 'did you mean "bash"' in refused("completion", "bsh")
