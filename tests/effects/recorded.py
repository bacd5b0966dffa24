"""Folders of an experiment that the truth simulator recorded, for machines that no case draws."""

import gzip
import math

import numpy as np
import truth_simulator
from excitation import RECORDS

STEP = 2e-6  # m, of the encoder
RATE = 1000.0
SECONDS = {"fit": 8.0, "check": 6.0}
SIZE = 0.01  # m, of the motion

HEAD = """title = "A machine of a test"
[model.device]
axis = "prismatic"
inertia = {{ value = {inertia}, unit = "kg" }}
[model.device.effects]
{effects}
[channels]
time = {{ column = "t", unit = "s" }}
actuator_force = {{ column = "u", unit = "N" }}
position = {{ column = "x", unit = "m", resolution = {step} }}
{channels}
[comparison]
bandwidth = {{ value = 60, unit = "Hz" }}
"""


def write_recorded(folder, believed, *, inertia=0.15, channels="", more=None, seed=3, **values):
    """experiment.toml and two records of a device under a position controller.

    believed: lines of [model.device.effects];  channels: further lines of [channels]
    more: more(time, position) -> columns besides, by their header
    values: parameters of the truth simulator
    """
    folder.mkdir(parents=True)
    text = HEAD.format(inertia=inertia, effects=believed, step=STEP, channels=channels)
    rng = np.random.default_rng(seed)
    hard = values.get("level", 0.0) / (0.3 * STEP)
    parameters = {
        "inertia": inertia - values.get("tip_inertia", 0.0),
        "bristle_stiffness": hard or 1.0,
        "bristle_damping": 0.3 * math.sqrt(hard * inertia),
        "tip_bristle": values.get("tip_level", 0.0) / (0.3 * STEP),
        "kp": inertia * 40.0**2,
        "kd": 1.5 * inertia * 40.0,
        "resolution": STEP,
    }
    body = truth_simulator.body(**{**parameters, **values})
    for name, seconds in SECONDS.items():
        x, v = RECORDS[name](rng, RATE, seconds, "normal", 16.0)
        drive = truth_simulator.Drive.zero(len(x))
        drive.reference[:, 0], drive.reference_velocity[:, 0] = SIZE * x, SIZE * v
        t = np.arange(len(x)) / RATE
        columns = {"t": t} | (more(t, drive) if more else {})
        run = truth_simulator.simulate([body], drive, RATE, 50)
        columns |= {"u": run.command[:, 0], "x": run.encoder[:, 0]}
        table = np.column_stack(list(columns.values())).tolist()
        rows = [",".join(columns), *(",".join(f"{c:.9g}" for c in row) for row in table)]
        (folder / f"{name}.csv.gz").write_bytes(gzip.compress("\n".join(rows).encode(), 5))
        text += f'[[records]]\nfile = "{name}.csv.gz"\nuse = "{name}"\n'
    (folder / "experiment.toml").write_text(text)
    return folder
