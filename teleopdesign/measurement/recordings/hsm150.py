"""Two coupled motors that spin up under torque steps."""

from pathlib import Path

from ._recording import RawFile, Recording, write

_SOURCE = ("malik-robert/HSM150-data", "35c3b1be8a4c2215ff981eb00bb3ed439e9f524b")


def _convert(raw: list[Path], folder: Path) -> None:
    """Column 1 is not used; column 4 is the commanded torque, column 5 a noisy measured one."""
    from scipy.io import loadmat

    for path in raw:
        data = loadmat(path)["data"]
        columns = {
            "time_s": (data[:, 0], 3),
            "position_rad": (data[:, 2], 6),
            "velocity_rad_per_s": (data[:, 3], 6),
            "torque_Nm": (data[:, 4], 6),
            "torque_measured_Nm": (data[:, 5], 5),
        }
        name = path.stem.removeprefix("idf_").replace(".", "p")
        write(folder / f"hsm150_{name}.csv.gz", columns)


RECORDING = Recording(
    files=tuple(
        RawFile(*_SOURCE, f"Data/Identification/idf_pos_{run}.mat", sha256)
        for run, sha256 in {
            "0.065_1": "98a9ccbd8da916b60de1f09aa4bd607acfaa7296b44cf759590cf272da675514",
            "0.065_2": "aebcf5b20504719660899917a71f4cde5e71a044c54cfcc429fa9f6d1fea2de3",
            "0.06_1": "c9474de666dd99c65dbda3e00be5ef0b517b4a72c675822efc3281f828da3dd6",
            "0.06_2": "bfc4fdb94526e1f66d2aecba1868b4375796aad9d58a9df0fe493665ca5a0e15",
        }.items()
    ),
    convert=_convert,
    experiment="""\
# One of two coupled motors spins up under torque steps, always the same way round: friction, bias
# and an asymmetry cannot be told apart, and equal runs differ by up to 14 % in final speed.
title = "Two-motor set spinning up"

[model.device]
axis = "revolute"
inertia = { value = 1.2e-4, unit = "kg*m^2", fixed = false }
[model.device.effects]
coulomb = { level = { value = 0.02, unit = "N*m" } }

[channels]
time           = { column = "time_s",             unit = "s" }
position       = { column = "position_rad",       unit = "rad" }
velocity       = { column = "velocity_rad_per_s", unit = "rad/s" }
actuator_force = { column = "torque_Nm",          unit = "N*m" }

[comparison]
bandwidth = { value = 2, unit = "Hz" }

[[records]]
file = "hsm150_pos_0p06_1.csv.gz"
use = "fit"
[[records]]
file = "hsm150_pos_0p065_1.csv.gz"
use = "fit"
[[records]]
file = "hsm150_pos_0p06_2.csv.gz"
use = "check"
[[records]]
file = "hsm150_pos_0p065_2.csv.gz"
use = "check"
""",
)
