"""From a raw log to a compensation by what each command prints as the next one."""

import json
import re
import shlex
import shutil
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from joint_simulator import DAMPING, EXTRA, INERTIA, LEVEL, SPEED, simulate_joint

from teleopdesign.cli import main

CONSTANT = 0.052  # N*m/A
TRUTH = {
    "inertia": INERTIA,
    "coulomb.level": LEVEL,
    "viscous.damping": DAMPING,
    "stribeck.extra_static_level": EXTRA,
    "stribeck.stribeck_velocity": SPEED,
}


def write_log(path, seconds):
    """A csv in milliseconds, degrees and amperes, with stamps 6 % of a row off and lost rows."""
    joint, rng = simulate_joint(seconds), np.random.default_rng(1)
    t = joint["t"]
    stamps = t + 6e-5 * np.clip(rng.standard_normal(len(t)), -3, 3)
    columns = {
        "time_ms": 1e3 * stamps,
        "pos_deg": np.rad2deg(2 * np.pi / 20000)
        * np.round(np.interp(stamps, t, joint["q"]) / (2 * np.pi / 20000)),
        "i_motor_A": joint["u"] / CONSTANT,
        "ft_Mz_Nm": np.interp(stamps, t, joint["hand"]),
    }
    kept = np.sort(rng.permutation(np.arange(1, len(t) - 1))[len(t) // 500 :])
    rows = np.column_stack(list(columns.values()))[kept]
    np.savetxt(path, rows, fmt="%.8g", delimiter=",", header=",".join(columns), comments="")


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """(folder with a short log and the experiment "joint" made of it, what was printed)"""
    folder, text = tmp_path_factory.mktemp("short"), StringIO()
    write_log(folder / "bench.csv", 6)
    with redirect_stdout(text):
        new = ["new", str(folder / "bench.csv"), "--yes", "--output", str(folder / "joint")]
        assert main(new) == 0
    return folder, text.getvalue()


@pytest.fixture
def printed(made, tmp_path, monkeypatch):
    """What was printed; the working folder is a copy of that folder."""
    monkeypatch.chdir(shutil.copytree(made[0], tmp_path / "copy"))
    return made[1]


def test_a_guess_is_corrected_by_the_option_that_is_printed(printed, capsys):
    (option,) = re.findall(r"otherwise: --torque-constant .*", printed)
    more = shlex.split(option.removeprefix("otherwise: ").replace("VALUE", "0.05"))
    log = ["new", "bench.csv", "--yes", "--output", "joint", *more]
    assert main(log) == 2
    refused = capsys.readouterr()
    assert "--overwrite" in refused.err and not refused.out
    assert main([*log, "--overwrite"]) == 0
    assert "torque_constant = { value = 0.05," in Path("joint/experiment.toml").read_text()


def test_check_says_once_how_the_log_was_read_and_names_no_steps_that_were_interpolated(
    printed, capsys
):
    assert main(["check", "joint"]) == 0
    output = " ".join(capsys.readouterr().out.split())
    # two records, the fit and the check one
    assert output.count("of a row off an even clock") == output.count("rows lost") == 2
    assert "not read in steps" not in output


def next_commands(output, name):
    """What is printed to be typed next."""
    lines = re.findall(rf"teleopdesign ({name} .*)", output)
    assert lines, output
    return shlex.split(lines[-1])


@pytest.mark.slow
def test_each_command_prints_the_next_one_up_to_claims_and_a_figure(tmp_path, monkeypatch, capsys):
    """What is identified, without any constant given, is what was simulated."""
    monkeypatch.chdir(tmp_path)
    write_log(Path("bench.csv"), 16)
    assert main(["new", "bench.csv", "--yes"]) == 0
    command = next_commands(capsys.readouterr().out, "diagnose")
    few = ["--only", "stribeck", "presliding", "quadratic_drag", "bias"]
    assert main([*command, "--json", "answer.json", "--figure", "figure.pdf", *few]) == 0
    output = capsys.readouterr().out
    assert "written: answer.json, report.html, figure.pdf" in output
    answer = json.loads(Path("answer.json").read_text(encoding="utf-8"))
    assert answer["missing"] == [{"effect": "stribeck", "at": "device"}]
    device = answer["models"]["ladder"][-1]["device"]
    for name, true in TRUTH.items():
        effect, _, parameter = name.partition(".")
        value = device["effects"][effect][parameter] if parameter else device["inertia"]
        # 3 standard errors, and what the guessed motor constant is off
        assert value["value"] == pytest.approx(true, abs=3 * value["stderr"] + 0.01 * true), name
    assert main(next_commands(output, "design")) == 0
    output = capsys.readouterr().out
    assert "device_design.json" in output
    assert main(next_commands(output, "derive")) == 0
    transfers = capsys.readouterr().out
    assert "Zhat_M = Gamma^-1 (Z_M - C)" in transfers
    assert main(next_commands(output, "passivity")) == 0
    assert capsys.readouterr().out.count("proved ") >= 1
    assert main(["derive", "answer.json", "--figure", "device.svg"]) == 0
    assert "Zhat_M = (0.012" in capsys.readouterr().out
    assert {p.suffix for p in Path("design").iterdir()} == {
        ".json",
        ".pdf",
        ".png",
        ".svg",
        ".toml",
    }
    assert min(p.stat().st_size for p in Path("design").iterdir()) > 500
