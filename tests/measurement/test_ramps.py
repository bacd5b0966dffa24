"""A torque that only rises until a body breaks loose: a force by its name, and never a clock."""

import numpy as np
import pytest

from teleopdesign.cli import main

RATE = 500.0
T = np.arange(2000) / RATE
TORQUE = 0.02 * T
STEP = 2 * np.pi / 10_000


def run_motor(seed):
    """Angle in steps of an encoder and speed of a motor that a ramp of its torque breaks loose."""
    inertia, static, dry, damping = 2e-4, 0.03, 0.022, 2e-4
    angle, speed, rows = 0.0, 0.0, []
    for torque in TORQUE:
        if speed > 0.0 or torque > static:
            friction = dry + (static - dry) * np.exp(-((speed / 2.0) ** 2)) + damping * speed
            speed = max(speed + (torque - friction) / inertia / RATE, 0.0)
        angle += speed / RATE
        rows.append((angle, speed))
    angles, speeds = np.array(rows).T
    noise = np.random.default_rng(seed).normal(scale=0.05, size=len(T))
    return np.round(angles / STEP) * STEP, speeds + noise


ANGLE, SPEED = run_motor(1)


def new(tmp_path, capsys, header, columns, *options):
    log = tmp_path / "ramp.csv"
    rows = np.column_stack(columns)
    np.savetxt(log, rows, fmt="%.7f", delimiter=",")
    log.write_text((header + "\n" if header else "") + log.read_text())
    status = main(["new", str(log), "--yes", "--output", str(tmp_path / "out"), *options])
    printed = capsys.readouterr()
    return status, printed.err + printed.out


@pytest.mark.parametrize(
    ("header", "columns", "force"),
    [
        ("t_s,pos_rad,vel,torque_Nm", (T, ANGLE, SPEED, TORQUE), "torque_Nm"),
        ("time,angle,current_cmd", (T, ANGLE, TORQUE), "current_cmd"),
    ],
)
def test_a_ramp_that_is_called_a_force_is_one(tmp_path, capsys, header, columns, force):
    status, printed = new(tmp_path, capsys, header, columns)
    assert status == 0
    assert f'actuator_force     "{force}"' in printed


def test_a_ramp_of_a_torque_is_no_clock(tmp_path, capsys):
    status, printed = new(tmp_path, capsys, "pos_rad,vel,torque_Nm", (ANGLE, SPEED, TORQUE))
    assert status == 0
    assert 'actuator_force     "torque_Nm"' in printed
    assert "is read as the time" not in printed and "may be a coarse time" not in printed


@pytest.mark.parametrize("chosen", [(), ("--position", "column 1")])
def test_without_names_a_speed_is_no_force_and_the_ramp_is_offered(tmp_path, capsys, chosen):
    options = ("--sample-rate", str(RATE), *chosen)
    columns = (ANGLE, SPEED, TORQUE, 5.0 * TORQUE**2)
    status, printed = new(tmp_path, capsys, "", columns, *options)
    assert status == 2
    assert "column 2 is taken for a velocity" in printed
    assert "column 3, column 4 only rise: --force 'column 4' chooses a ramp" in printed
    status, printed = new(tmp_path, capsys, "", columns, *options, "--force", "column 3")
    assert status == 0
    assert "'column 2' is the derivative of 'column 1'" in printed


def test_a_count_of_the_rows_is_no_ramp_of_a_current(tmp_path, capsys):
    there = np.sin(3.0 * T)
    force = 0.1 * np.sign(np.cos(3.0 * T)) - 0.01 * there
    columns = (T, np.arange(len(T)), there, force)
    status, printed = new(tmp_path, capsys, "t_s,i,q_rad,u", columns)
    assert status == 0
    assert 'actuator_force     "u"' in printed
