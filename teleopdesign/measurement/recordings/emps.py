"""EMPS: motor, ballscrew and carriage, the public benchmark of friction in a prismatic axis."""

from pathlib import Path

from ._recording import RawFile, Recording, count_rows, write

_SOURCE = ("forgi86/sysid-neural-continuous", "956aa7ecd73061b0321c6f6098d74c9e4a7ce67a")


def _convert(raw: list[Path], folder: Path) -> None:
    """Force = drive gain `gtau` (N/V) times the voltage of the controller; the rate is 1 kHz."""
    from scipy.io import loadmat

    for path, name in zip(raw, ("emps_estimation", "emps_pulses"), strict=True):
        content = {k: v.ravel() for k, v in loadmat(path).items() if not k.startswith("__")}
        columns = {
            "time_s": count_rows(content["qm"], 1000.0),
            "position_m": (content["qm"], 8),
            "force_N": (content["gtau"] * content["vir"], 6),
            "reference_m": (content["qg"], 8),
        }
        if "pulses_N" in content:  # force_N contains the pulses already; this only marks them
            columns["pulse_flag"] = (content["pulses_N"], 0)
        write(folder / f"{name}.csv.gz", columns)


RECORDING = Recording(
    files=(
        RawFile(
            *_SOURCE,
            "examples/EMPS/data/DATA_EMPS.mat",
            "6cf6814ae14618795da0101aae2bb97ff0c6351b0501b5492751b02b07facf7e",
        ),
        RawFile(
            *_SOURCE,
            "examples/EMPS/data/DATA_EMPS_PULSES.mat",
            "0eab75bb1f6b16228ee78791343a88bf9bfd9a51036ac9807d7b5fc11c0e1704",
        ),
    ),
    convert=_convert,
    experiment="""\
# Motor, ballscrew and carriage under position control, four repeats of one path over 0.25 m; in the
# second record pulses disturb it. A. Janot, M. Gautier, M. Brunot, Data Set and Reference Models of
# EMPS, Workshop on Nonlinear System Identification Benchmarks, Eindhoven 2019.
title = "Electro-mechanical positioning system (EMPS)"

[model.device]
axis = "prismatic"
inertia = { value = 95, unit = "kg", fixed = false }
[model.device.effects]
coulomb = { level = { value = 20, unit = "N" } }

[channels]
time           = { column = "time_s",     unit = "s" }
position       = { column = "position_m", unit = "m", resolution = 5e-8 }
actuator_force = { column = "force_N",    unit = "N" }

[comparison]
bandwidth = { value = 60, unit = "Hz" }

[[records]]
file = "emps_estimation.csv.gz"
use = "fit"
[[records]]
file = "emps_pulses.csv.gz"
use = "check"
position_zero = "own"
""",
)
