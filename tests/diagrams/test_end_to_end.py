"""A diagram from a file goes the whole way: derived, drawn, Bode, python-control, simulated."""

import json

import numpy as np
import pytest

from teleopdesign.cli import main
from teleopdesign.derive import all_transfers
from teleopdesign.diagrams import read_diagram
from teleopdesign.frequency import bode
from teleopdesign.realise.iosystem import to_iosystem
from teleopdesign.simulate import simulate

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


def test_all_forms_of_a_diagram_from_a_file_agree(file):
    import control

    diagram = read_diagram(file)
    system, left_out = all_transfers(diagram)["x_m/f_h"].system()
    assert left_out == ()
    # x_m/f_h = 1/(0.6 s^2 + 6 s + 200)
    f = np.array([0.5, 3.0, 20.0])
    s = 2j * np.pi * f
    exact = 1 / (0.6 * s**2 + 6 * s + 200)
    np.testing.assert_allclose(system(s), exact, rtol=1e-12)
    response = bode(diagram, output="x_m", input="f_h", frequency=f)
    np.testing.assert_allclose(response.data["magnitude"][0], abs(exact), rtol=1e-9)
    t = np.linspace(0.0, 0.5, 501)
    linear = control.step_response(system, t).outputs
    nonlinear = control.input_output_response(
        to_iosystem(diagram),
        t,
        np.vstack([np.ones(t.size), np.zeros(t.size)]),
        solve_ivp_kwargs={"rtol": 1e-9, "atol": 1e-12},
    )
    x = nonlinear.outputs[nonlinear.output_labels.index("x_m")]
    np.testing.assert_allclose(x, linear, atol=1e-9)  # the solver's tolerance on 5 mm
    run = simulate(diagram, duration=0.5, inputs={"f_h": 1.0, "u_m": 0.0}, jit=False)
    positions = np.interp(t, run["x_m"]["time"].values, run["x_m"].values)
    np.testing.assert_allclose(positions, linear, atol=1e-7)  # interpolation between steps


def test_the_command_prints_draws_and_writes(file, tmp_path, capsys):
    figure, answer = tmp_path / "spring.svg", tmp_path / "spring.json"
    assert main(["derive", str(file), "--figure", str(figure), "--json", str(answer)]) == 0
    out = capsys.readouterr().out
    assert "x_m/f_h = (M + Z)^-1    (f_h to x_m)" in out
    assert "x_m/f_h = (1.667) / (s^2 + 10 s + 333.3)" in out
    assert "<svg" in figure.read_text(encoding="utf-8")
    first = json.loads(answer.read_text(encoding="utf-8"))["transfers"][0]
    assert first["name"] == "x_m/f_h" and first["latex"]
