"""Insertion axis of a da Vinci patient-side manipulator along Fourier paths."""

from pathlib import Path

import numpy as np

from ._recording import RawFile, Recording, count_rows, write

_SOURCE = ("radiang/dvrk_parameter_identification", "b044f8f66e38006a6b8a9fe750d8d3344854da87")
_FOLDER = "dvrk_si/scripts/data/stribeck_test_3dof_svd"


def _convert(raw: list[Path], folder: Path) -> None:
    """Joint 3 of files with positions, velocities and efforts of three joints; its commands."""
    start = 100  # samples: 1 s of start transient
    for i, (result, command) in enumerate(zip(raw[:3], raw[3:], strict=True), start=1):
        measured = np.loadtxt(result, delimiter=",")[start:]
        commanded = np.loadtxt(command, delimiter=",")[2, start : start + len(measured)]
        columns = {
            "time_s": count_rows(measured, 100.0),
            "position_m": (measured[:, 2], 7),
            "velocity_m_per_s": (measured[:, 5], 6),
            "force_N": (measured[:, 8], 6),
            "position_command_m": (commanded, 6),
        }
        write(folder / f"psm1_fourier{i}.csv.gz", columns)


RECORDING = Recording(
    files=tuple(
        RawFile(*_SOURCE, f"{_FOLDER}/{file}", sha256)
        for file, sha256 in {
            "fourier_test_results2.csv": (
                "7267cdd22604a184c5e87b2200ccadf932a6c726680750b7a9286159f5ecf1d8"
            ),
            "fourier_test2_results2.csv": (
                "0b04567841ccab6edd12e4e696a10eb631ccf49bc94bfb674f9b8f5c9754052c"
            ),
            "fourier_test3_results2.csv": (
                "aaf7a80e195485a4c6cd78556703e411b2c17fda88d92ddefe86bb1a9bfb3ee2"
            ),
            "fourier_test.csv": (
                "946416ee74fab47481e54fdb595e692ec4a54095fd4b38ae4e20675664636f09"
            ),
            "fourier_test2.csv": (
                "56776dabcd89f1d8c7e62f7bc2962af074bf5bb816fef267fdb6200efc1d3780"
            ),
            "fourier_test3.csv": (
                "a80d1cb4c543c72ce48f17daa24df788354ae57f5f71cf6cb6c050223031f44a"
            ),
        }.items()
    ),
    convert=_convert,
    experiment="""\
# Joint 3 (instrument insertion, driven by cables) of a da Vinci Research Kit patient-side
# manipulator, the other joints held. The group's paper: Y. Wang, R. Gondokaryono, A. Munawar,
# G. S. Fischer, IEEE RA-L 4(4) (2019) 3657, doi 10.1109/LRA.2019.2927947. No time stamps were
# recorded: the real interval jitters by some 2.5 ms, so nothing above about 10 Hz can be trusted.
title = "Insertion axis of a patient-side manipulator, Fourier paths"

[model.device]
axis = "prismatic"
inertia = { value = 0.3, unit = "kg", fixed = false }
[model.device.effects]
coulomb = { level = { value = 0.6, unit = "N" } }
viscous = { damping = { value = 1.0, unit = "N*s/m" } }

[channels]
time           = { column = "time_s",     unit = "s" }
position       = { column = "position_m", unit = "m" }
actuator_force = { column = "force_N",    unit = "N" }

[comparison]
bandwidth = { value = 5, unit = "Hz" }

[[records]]
file = "psm1_fourier1.csv.gz"
use = "fit"
[[records]]
file = "psm1_fourier2.csv.gz"
use = "fit"
[[records]]
file = "psm1_fourier3.csv.gz"
use = "check"
""",
)
