"""Letters of axes in space at the end of names: "PosX", "ForceX" of a haptic device, "fx", "fy"."""

import numpy as np
import pytest

from teleopdesign.cli import main
from teleopdesign.measurement.column_names import likeness
from teleopdesign.measurement.survey.axes import of_another_axis, same_but_axis, stand_together

#: a pen that a hand leads along a path, with pulses of a commanded force along y and, weaker, x
T = np.arange(3000) / 250.0
PLACE = np.column_stack([60 * np.sin(1.3 * T), 30 * np.sin(1.9 * T), 5 * np.sin(0.8 * T)])
PULSE = np.where((T % 3.0 < 0.4)[:, None], np.sign(np.sin(1.3 * T))[:, None], 0.0)
FORCE = PULSE * [0.8, -1.2, 0.3]


@pytest.mark.parametrize(
    ("place", "force"),
    [("DevicePos{}", "CommandedForce{}"), ("pos_{}", "force_{}"), ("p{}", "f{}"), ("{}", "F{}")],
)
@pytest.mark.parametrize("letter", [0, 1, 2])
def test_the_force_is_along_the_axis_of_the_position(tmp_path, capsys, place, force, letter):
    letters = "XYZ" if "Pos" in place else "xyz"
    names = ["t_s", *(place.format(c) for c in letters), *(force.format(c) for c in letters)]
    rows = np.column_stack([T, PLACE, FORCE])
    log = tmp_path / "pen.csv"
    np.savetxt(log, rows, fmt="%.9g", delimiter=",", header=",".join(names), comments="")
    options = ["--position", names[1 + letter], "--output", str(tmp_path / "pen")]
    assert main(["new", str(log), "--yes", *options]) == 0
    assert f'actuator_force     "{names[4 + letter]}" in N' in capsys.readouterr().out


@pytest.mark.parametrize("name", ["CommandedForceX", "force_x", "VelX", "acc_x", "gyro.x"])
def test_a_direction_is_no_position(name):
    assert likeness(name, "position") == 0.0


@pytest.mark.parametrize("name", ["x", "pos_x", "x_ref", "tcp_x", "x_motor", "current_x"])
def test_x_stays_a_position_where_no_other_quantity_is_named(name):
    assert likeness(name, "position") > 0.0


def test_letters_tell_axes_apart_as_numbers_do():
    assert same_but_axis("PosX", "PosY") and not same_but_axis("PosX", "VelX")
    assert stand_together("PosX", "ForceX") and not stand_together("PosX", "ForceY")
    assert of_another_axis("pos_x", "force_y") and not of_another_axis("pos_x", "force_x")
    assert not of_another_axis("pos_x", "force")


def test_x_and_y_alone_may_be_the_two_signals_of_a_curve():
    assert not of_another_axis("x", "y", ["x", "y"])
    assert of_another_axis("fx", "fz", ["fx", "fy", "fz"])
    assert not of_another_axis("data_x", "data_y")
