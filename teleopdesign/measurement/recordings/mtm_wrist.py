"""Wrist joint of a da Vinci master manipulator, one slow sweep there and back."""

from pathlib import Path

import numpy as np

from ._recording import RawFile, Recording, count_rows, write

_SOURCE = ("WPI-AIM/dvrk_dynamics_identification", "7697d3a6c90866c1846f0d3054d7f78384ab1ef9")


def _convert(raw: list[Path], folder: Path) -> None:
    measured = np.loadtxt(raw[0], delimiter=",")
    columns = {
        "time_s": count_rows(measured, 200.0),
        "position_rad": (measured[:, 0], 7),
        "velocity_rad_per_s": (measured[:, 1], 6),
        "torque_Nm": (measured[:, 2], 6),
    }
    write(folder / "mtm_joint4_sweep.csv.gz", columns)


RECORDING = Recording(
    files=(
        RawFile(
            *_SOURCE,
            "data/mtm/joint_test/one_results.csv",
            "03563ab5375a127b1eb798f8979caad5d02c205910bf4fb91ea64d9c150df2b1",
        ),
    ),
    convert=_convert,
    experiment="""\
# Joint 4 of a da Vinci Research Kit master: one slow sweep there and back; an electric cable that
# runs through the joint pulls. Y. Wang, R. Gondokaryono, A. Munawar, G. S. Fischer, IEEE RA-L 4(4)
# (2019) 3657, doi 10.1109/LRA.2019.2927947. No second record, no acceleration to tell the inertia.
title = "Wrist joint of a master manipulator, slow sweep"

[model.device]
axis = "revolute"
inertia = { value = 1e-4, unit = "kg*m^2", fixed = true }
[model.device.effects]
coulomb = { level = { value = 0.05, unit = "N*m" } }
bias = {}

[channels]
time           = { column = "time_s",       unit = "s" }
position       = { column = "position_rad", unit = "rad" }
actuator_force = { column = "torque_Nm",    unit = "N*m" }

[comparison]
bandwidth = { value = 8, unit = "Hz" }

[[records]]
file = "mtm_joint4_sweep.csv.gz"
use = "fit"
""",
)
