"""A diagram from a file goes the whole way: derived, drawn, Bode, python-control, simulated."""

import json

import pytest

from teleopdesign.cli import main

SPRING = """\
[diagram]
name = "mass, spring and damper"
measured = ["x_m"]

[outside]
f_h = "force"
u_m = "force"

[blocks.M]
kind = "moving"
motion = "x_m"
command = "u_m"
loads = { f_h = 1, f_k = 1 }
driver = "f_h"
axis = "prismatic"
inertia = 0.5
[blocks.M.effects.viscous]
damping = 6.0

[blocks.Z]
kind = "attached"
motion = "x_m"
force = "f_k"
axis = "prismatic"
inertia = 0.1
[blocks.Z.effects.spring]
stiffness = 200.0
"""


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "spring.toml"
    path.write_text(SPRING, encoding="utf-8")
    return path


def test_the_command_prints_draws_and_writes(file, tmp_path, capsys):
    figure, answer = tmp_path / "spring.svg", tmp_path / "spring.json"
    assert main(["derive", str(file), "--figure", str(figure), "--json", str(answer)]) == 0
    out = capsys.readouterr().out
    assert "x_m/f_h = (M + Z)^-1    (f_h to x_m)" in out
    assert "x_m/f_h = (1.667) / (s^2 + 10 s + 333.3)" in out
    assert "<svg" in figure.read_text(encoding="utf-8")
    first = json.loads(answer.read_text(encoding="utf-8"))["transfers"][0]
    assert first["name"] == "x_m/f_h" and first["latex"]
