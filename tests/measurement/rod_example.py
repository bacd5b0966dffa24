"""Two good experiments in text form, and what an error of a spoilt one must look like."""

import re

import numpy as np
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.measurement import load_experiment

ROD = """\
title = "Vertical rod of a one-axis haptic interface"

[model.device]
axis = "prismatic"
inertia = { value = 0.15, unit = "kg", fixed = false }
[model.device.effects]
coulomb = { level = { value = 0.50, unit = "N" } }
viscous = {}

[channels]
time = { column = "t", unit = "s" }
actuator_force = { column = "u", unit = "N" }
position = { column = "x", unit = "mm", resolution = 5e-3 }
interaction_force = { column = "f_h", unit = "N", noise = 0.01 }

[comparison]
bandwidth = { value = 20, unit = "Hz" }

[[records]]
file = "fit.csv"
use = "fit"
[[records]]
file = "check.csv"
use = "check"
position_zero = "own"
"""

PAIR = """\
title = "Master and slave"
sample_rate = { value = 100, unit = "Hz" }

[model.master]
axis = "prismatic"
[model.slave]
axis = "revolute"
[model.environment]
stiffness = { value = 2, unit = "N*m/rad" }
contact_position = { value = 3, unit = "deg" }
[model.environment.effects]
contact_damping = {}

[channels]
"master.position" = { column = "x_m", unit = "m" }
"master.actuator_force" = { column = "u_m", unit = "N" }
"slave.position" = { column = "x_s", unit = "deg" }
"slave.actuator_force" = { column = "u_s", unit = "mNm", noise = 2 }

[[records]]
file = "fit.csv"
use = "fit"
"""

COUNT = 150  # samples at 100 Hz: 1.5 s, a little more than the least that is accepted


def rows(columns):
    """Text of a table: header -> values."""
    lines = [",".join(columns)]
    lines += [",".join(f"{v:.6g}" for v in row) for row in zip(*columns.values(), strict=True)]
    return "\n".join(lines) + "\n"


def rod_columns():
    t = np.arange(COUNT) / 100
    return {"t": t, "u": np.sin(t), "x": 10 * np.cos(t), "f_h": 0.1 * t}


def write_rod(folder):
    folder.mkdir()
    (folder / "experiment.toml").write_text(ROD)
    for name in ("fit.csv", "check.csv"):
        (folder / name).write_text(rows(rod_columns()))
    return folder


def error_of(folder):
    with pytest.raises(ExperimentError) as caught:
        load_experiment(folder)
    message = str(caught.value)
    assert len(message.splitlines()) == 1
    assert message.isprintable()
    assert str(folder.parent) not in message, "paths are relative to the folder's name"
    return message


def assert_says(message, expected):
    assert re.search(expected, message), message
