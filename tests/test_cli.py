"""The command: what it prints and writes, its exit status, and one line for every mistake."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from diagnose.contract import violations
from users_effect import SOURCE

import teleopdesign
from teleopdesign import EFFECTS
from teleopdesign.cli import main

ROD = Path(teleopdesign.__file__).parent / "examples" / "rod"


@pytest.fixture
def rod(tmp_path):
    """A copy of the experiment that ships with the package."""
    return Path(shutil.copytree(ROD, tmp_path / "rod"))


def run(*arguments):
    """The command in a process of its own."""
    return subprocess.run(
        [sys.executable, "-m", "teleopdesign", *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=300,
    )


def refused(capsys, *arguments):
    """The one line on stderr of a command that is refused with exit status 2."""
    assert main([str(a) for a in arguments]) == 2
    out = capsys.readouterr()
    lines = out.err.splitlines()
    assert len(lines) == 1
    assert lines[0].startswith("teleopdesign: ")
    return lines[0]


# help and lists


@pytest.mark.parametrize("arguments", [["diagnose", "--help"], ["--version"]])
def test_help_answers_without_loading_anything_heavy(arguments):
    code = (
        "import sys\n"
        "from teleopdesign.cli import main\n"
        f"try:\n    main({arguments})\nexcept SystemExit as end:\n    assert not end.code\n"
        "heavy = [m for m in ('numba', 'control', 'matplotlib', 'scipy') if m in sys.modules]\n"
        "sys.exit(f'loaded {heavy}' if heavy else 0)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert "teleopdesign" in done.stdout


def test_no_command_and_an_unknown_one_exit_with_2():
    done = run("diagnos")
    assert done.returncode == 2 and not done.stdout
    assert "Traceback" not in done.stderr
    assert main([]) == 2


def test_the_list_of_effects_has_a_line_for_each(capsys):
    assert main(["effects"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(EFFECTS)
    assert all(EFFECTS[n].title in line for n, line in zip(EFFECTS, lines, strict=True))


@pytest.mark.parametrize("name", sorted(EFFECTS))
def test_an_effects_page_has_its_text_parameters_and_source(name, capsys):
    assert main(["effects", name]) == 0
    out = capsys.readouterr().out
    effect = EFFECTS[name]
    assert effect.text.strip() in out and effect.source in out
    for parameter, declared in effect.parameters.items():
        assert parameter in out and declared.meaning in out


def test_a_users_effect_has_a_page(tmp_path, capsys):
    file = tmp_path / "own_drag.py"
    file.write_text(SOURCE)
    assert main(["effects", "own_drag", "--effect", str(file)]) == 0
    assert "F = D v abs(v)" in capsys.readouterr().out


# mistakes


@pytest.mark.parametrize("command", [["effects"], ["diagnose", str(ROD)]])
def test_a_bad_effect_file_is_one_line(command, tmp_path, capsys):
    file = tmp_path / "own_drag.py"
    file.write_text(SOURCE.replace("EFFECT =", "OTHER ="))
    assert "found no EFFECT" in refused(capsys, *command, "--effect", file)
    assert "no such effect file" in refused(capsys, *command, "--effect", tmp_path / "none.py")


def test_an_unknown_effect_page_and_recording_are_one_line(tmp_path, capsys):
    assert 'did you mean "stribeck"' in refused(capsys, "effects", "stribek")
    assert 'did you mean "emps"' in refused(capsys, "fetch", "emsp", "--folder", tmp_path)


# results


def test_a_diagnosis_prints_the_ladder_and_writes_what_was_asked_for(short_rod, tmp_path, capsys):
    names = ("answer.json", "predictions.csv", "figure.png", "report.html")
    files = [tmp_path / n for n in names]
    options = [
        *("--only", "stribeck"),
        *("--json", str(files[0])),
        *("--predictions", str(files[1])),
        *("--figure", str(files[2])),
        *("--report", str(files[3])),
    ]
    assert main(["diagnose", str(short_rod), *options]) == 0
    out = capsys.readouterr()
    assert "verdict: " in out.out and "noise floor" in out.out
    assert "\r" not in out.err, "progress that changes in place is for terminals"
    assert violations(json.loads(files[0].read_text())) == []
    assert files[1].read_text().startswith("record,t,device.measured,")
    assert files[2].read_bytes().startswith(b"\x89PNG")
    page = files[3].read_text(encoding="utf-8")
    assert page.startswith("<!DOCTYPE html>") and "Rod of a one-axis haptic interface" in page


@pytest.mark.slow
def test_a_users_effect_takes_part_in_a_diagnosis(short_rod, few, tmp_path):
    file = tmp_path / "own_drag.py"
    file.write_text(SOURCE)
    result = tmp_path / "answer.json"
    assert main(["diagnose", str(short_rod), "--effect", str(file), "--json", str(result)]) == 0
    names = {c["effect"] for c in json.loads(result.read_text())["candidates"]}
    assert "own_drag" in names


@pytest.mark.slow
def test_the_demo_names_the_effect_and_writes_its_files(tmp_path, capsys):
    assert main(["demo", "--output", str(tmp_path / "demo")]) == 0
    assert "written: " in capsys.readouterr().out
    files = {p.name for p in (tmp_path / "demo").iterdir()}
    assert files == {"answer.json", "predictions.csv.gz", "ladder.png", "report.html"}
    answer = json.loads((tmp_path / "demo" / "answer.json").read_text())
    assert violations(answer) == []
    assert answer["verdict"] == "effects_missing"
    assert answer["missing"] == [{"effect": "stribeck", "at": "device"}]
