"""Tables of the same joints, one for each quantity, which the name of its file says."""

import numpy as np
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.cli import main
from teleopdesign.measurement.tables import open_log

T = np.arange(3000) / 250.0
RATES = 2 * np.pi * np.array([0.3, 0.4, 0.5])
Q = np.sin(T[:, None] * RATES) * [0.2, 0.8, 0.4]
V = np.gradient(Q, T, axis=0)
TAU = [0.5, 0.3, 0.1] * np.gradient(V, T, axis=0) + [2.0, 1.0, 0.3] * np.sign(V)


def write(folder, name, names, *columns):
    folder.mkdir(exist_ok=True)
    rows = np.column_stack(columns)
    np.savetxt(folder / name, rows, fmt="%.9g", delimiter=",", header=",".join(names), comments="")


@pytest.fixture
def arm(tmp_path):
    """Positions, velocities and efforts of three joints, as exports of joint states have them."""
    names = ["time", "arm_joint_1", "arm_joint_2", "arm_joint_0"]
    folder = tmp_path / "arm"
    for name, values in (("positions", Q), ("velocities", V), ("efforts", TAU)):
        write(folder, f"states_{name}.csv", names, T, values)
    return folder


def test_the_position_chooses_the_joint_of_the_force(arm, tmp_path, capsys):
    options = ["--position", "arm_joint_0.positions", "--output", str(tmp_path / "experiment")]
    assert main(["new", str(arm), "--yes", *options]) == 0
    assert 'actuator_force     "arm_joint_0.efforts" in N*m' in capsys.readouterr().out


def test_values_and_clocks_are_those_of_the_files(arm):
    log = open_log(arm, "arm")
    wanted = {"arm_joint_2.efforts": "channels.actuator_force", "efforts.time": "channels.time"}
    read = log.read(wanted)
    assert np.asarray(read["arm_joint_2.efforts"]) == pytest.approx(TAU[:, 1], abs=1e-6)
    assert np.asarray(read["efforts.time"]) == pytest.approx(T, abs=1e-6)
    assert log.clocks["arm_joint_2.efforts"] == "efforts.time"


@pytest.mark.parametrize("names", [("position_loop", "torque_loop"), ("run_1", "run_2")])
def test_runs_with_a_position_and_a_torque_stay_runs(tmp_path, names):
    for name in names:
        write(tmp_path / "run", f"{name}.csv", ["t", "q1", "tau1"], T, Q[:, 0], TAU[:, 0])
    with pytest.raises(ExperimentError, match="tables of the same columns"):
        open_log(tmp_path / "run", "run")
