"""Public recordings of real devices, downloaded from their authors and converted to experiments.

    from teleopdesign.measurement.recordings import fetch

    experiment = load_experiment(fetch("emps"))

The package does not contain the files, because no licence is stated for the data. Each file is
downloaded once at a fixed commit, checked against its hash, and converted into an experiment's
folder. Units, signs and rates are those that the authors state, checked against the recordings.
Values are rounded to the resolution of the sensors. `NAME.toml` is what a recording becomes.
"""

from __future__ import annotations

import hashlib
import shutil
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...base.arguments import check_types
from ...base.errors import ExperimentError, did_you_mean, quote

#: values (n,) of a column, and their digits after the point
_Column = tuple[NDArray[np.float64], int]

_PUBLIC = "https://raw.githubusercontent.com"


@check_types
def fetch(name: str, folder: str | Path | None = None, *, source: str | Path = _PUBLIC) -> Path:
    """The folder of a public recording as an experiment; downloaded and converted if not there yet.

    name: one of RECORDINGS ("emps", "hsm150", "mtm_wrist", "psm_insertion")
    folder: where the experiment's folder is put; None: the user's cache
    source: address of a server laid out as OWNER/REPOSITORY/COMMIT/PATH, or a folder of copies laid
        out as OWNER/REPOSITORY/PATH
    raises ExperimentError: no such recording, no connection, or a file that is not the one expected
    """
    if name not in RECORDINGS:
        raise ExperimentError(
            f"fetch: no recording {quote(name)}, found {', '.join(RECORDINGS)}"
            f"{did_you_mean(name, RECORDINGS)}"
        )
    target = (_cache() if folder is None else Path(folder)) / name
    if (target / "experiment.toml").is_file():
        return target
    recording = RECORDINGS[name]
    raw = [_obtain(file, str(source)) for file in recording.files]
    _convert(recording, raw, target)
    return target


def _cache() -> Path:
    import pooch

    return Path(pooch.os_cache("teleopdesign"))


def _obtain(file: RawFile, source: str) -> Path:
    if source.startswith(("http://", "https://")):
        return _download(file, f"{source}/{file.repository}/{file.commit}/{file.path}")
    path = Path(source) / file.repository / file.path
    if not path.is_file():
        raise ExperimentError(f"fetch: no file {file.repository}/{file.path} in the source")
    if hashlib.sha256(path.read_bytes()).hexdigest() != file.sha256:
        raise _changed_content_error(f"{file.repository}/{file.path}")
    return path


def _download(file: RawFile, address: str) -> Path:
    import pooch

    try:
        return Path(
            pooch.retrieve(
                address,
                known_hash=f"sha256:{file.sha256}",
                fname=file.path.rsplit("/", 1)[-1],
                path=_cache() / "raw" / file.repository,
            )
        )
    except OSError as problem:
        raise ExperimentError(
            f"fetch: {address} cannot be downloaded: {type(problem).__name__}"
        ) from None
    except ValueError:
        raise _changed_content_error(address) from None


def _changed_content_error(file: str) -> ExperimentError:
    return ExperimentError(f"fetch: {file}: found other content, expected the known sha256")


def _convert(recording: Recording, raw: list[Path], target: Path) -> None:
    """Convert in a temporary folder first, so that an interruption leaves no incomplete folder."""
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=target.parent) as temporary:
        unfinished = Path(temporary) / target.name
        unfinished.mkdir()
        recording.convert(raw, unfinished)
        (unfinished / "experiment.toml").write_text(recording.experiment, encoding="utf-8")
        if target.exists():
            shutil.rmtree(target)  # without experiment.toml: nothing that we finished
        unfinished.rename(target)


@dataclass(frozen=True)
class RawFile:
    """One published file: repository "OWNER/NAME", commit, path in the repository, sha256."""

    repository: str
    commit: str
    path: str
    sha256: str


@dataclass(frozen=True)
class Recording:
    """A public recording.

    files: the published files
    convert: function that writes the record files into a folder
    """

    name: str
    files: tuple[RawFile, ...]
    convert: Callable[[list[Path], Path], None]

    @property
    def experiment(self) -> str:
        """The text of experiment.toml."""
        return (files(__package__) / f"{self.name}.toml").read_text(encoding="utf-8")


def _emps(raw: list[Path], folder: Path) -> None:
    """Force = drive gain `gtau` (N/V) times the voltage of the controller; the rate is 1 kHz."""
    from scipy.io import loadmat

    for path, name in zip(raw, ("emps_estimation", "emps_pulses"), strict=True):
        content = {k: v.ravel() for k, v in loadmat(path).items() if not k.startswith("__")}
        columns = {
            "time_s": _count_rows(content["qm"], 1000.0),
            "position_m": (content["qm"], 8),
            "force_N": (content["gtau"] * content["vir"], 6),
            "reference_m": (content["qg"], 8),
        }
        if "pulses_N" in content:  # force_N contains the pulses already; this only marks them
            columns["pulse_flag"] = (content["pulses_N"], 0)
        _write(folder / f"{name}.csv.gz", columns)


def _hsm150(raw: list[Path], folder: Path) -> None:
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
        _write(folder / f"hsm150_{name}.csv.gz", columns)


def _mtm_wrist(raw: list[Path], folder: Path) -> None:
    measured = np.loadtxt(raw[0], delimiter=",")
    columns = {
        "time_s": _count_rows(measured, 200.0),
        "position_rad": (measured[:, 0], 7),
        "velocity_rad_per_s": (measured[:, 1], 6),
        "torque_Nm": (measured[:, 2], 6),
    }
    _write(folder / "mtm_joint4_sweep.csv.gz", columns)


def _psm_insertion(raw: list[Path], folder: Path) -> None:
    """Joint 3 of files with positions, velocities and efforts of three joints; its commands."""
    start = 100  # samples: 1 s of start transient
    for i, (result, command) in enumerate(zip(raw[:3], raw[3:], strict=True), start=1):
        measured = np.loadtxt(result, delimiter=",")[start:]
        commanded = np.loadtxt(command, delimiter=",")[2, start : start + len(measured)]
        columns = {
            "time_s": _count_rows(measured, 100.0),
            "position_m": (measured[:, 2], 7),
            "velocity_m_per_s": (measured[:, 5], 6),
            "force_N": (measured[:, 8], 6),
            "position_command_m": (commanded, 6),
        }
        _write(folder / f"psm1_fourier{i}.csv.gz", columns)


def _write(path: Path, columns: Mapping[str, _Column]) -> None:
    """Write columns as comma-separated text with a header."""
    np.savetxt(
        path,
        np.column_stack([values for values, _ in columns.values()]),
        fmt=[f"%.{digits}f" for _, digits in columns.values()],
        delimiter=",",
        header=",".join(columns),
        comments="",
    )


def _count_rows(values: NDArray[np.float64], rate: float) -> _Column:
    """Time in s of successive rows of `values` at a rate in Hz."""
    return np.arange(len(values)) / rate, 3


def _files(source: str, commit: str, sums: Mapping[str, str]) -> tuple[RawFile, ...]:
    """source: repository and folder, with "//" between;  sums: file in the folder -> sha256."""
    repository, _, folder = source.partition("//")
    return tuple(RawFile(repository, commit, f"{folder}/{n}", sha) for n, sha in sums.items())


_PUBLISHED = {
    _emps: _files(
        "forgi86/sysid-neural-continuous//examples/EMPS/data",
        "956aa7ecd73061b0321c6f6098d74c9e4a7ce67a",
        {
            "DATA_EMPS.mat": "6cf6814ae14618795da0101aae2bb97ff0c6351b0501b5492751b02b07facf7e",
            "DATA_EMPS_PULSES.mat": (
                "0eab75bb1f6b16228ee78791343a88bf9bfd9a51036ac9807d7b5fc11c0e1704"
            ),
        },
    ),
    _hsm150: _files(
        "malik-robert/HSM150-data//Data/Identification",
        "35c3b1be8a4c2215ff981eb00bb3ed439e9f524b",
        {
            f"idf_pos_{run}.mat": sha256
            for run, sha256 in {
                "0.065_1": "98a9ccbd8da916b60de1f09aa4bd607acfaa7296b44cf759590cf272da675514",
                "0.065_2": "aebcf5b20504719660899917a71f4cde5e71a044c54cfcc429fa9f6d1fea2de3",
                "0.06_1": "c9474de666dd99c65dbda3e00be5ef0b517b4a72c675822efc3281f828da3dd6",
                "0.06_2": "bfc4fdb94526e1f66d2aecba1868b4375796aad9d58a9df0fe493665ca5a0e15",
            }.items()
        },
    ),
    _mtm_wrist: _files(
        "WPI-AIM/dvrk_dynamics_identification//data/mtm/joint_test",
        "7697d3a6c90866c1846f0d3054d7f78384ab1ef9",
        {"one_results.csv": "03563ab5375a127b1eb798f8979caad5d02c205910bf4fb91ea64d9c150df2b1"},
    ),
    _psm_insertion: _files(
        "radiang/dvrk_parameter_identification//dvrk_si/scripts/data/stribeck_test_3dof_svd",
        "b044f8f66e38006a6b8a9fe750d8d3344854da87",
        {
            f"fourier_test{run}.csv": sha256
            for run, sha256 in {
                "_results2": "7267cdd22604a184c5e87b2200ccadf932a6c726680750b7a9286159f5ecf1d8",
                "2_results2": "0b04567841ccab6edd12e4e696a10eb631ccf49bc94bfb674f9b8f5c9754052c",
                "3_results2": "aaf7a80e195485a4c6cd78556703e411b2c17fda88d92ddefe86bb1a9bfb3ee2",
                "": "946416ee74fab47481e54fdb595e692ec4a54095fd4b38ae4e20675664636f09",
                "2": "56776dabcd89f1d8c7e62f7bc2962af074bf5bb816fef267fdb6200efc1d3780",
                "3": "a80d1cb4c543c72ce48f17daa24df788354ae57f5f71cf6cb6c050223031f44a",
            }.items()
        },
    ),
}
#: name -> recording
RECORDINGS = {
    (name := convert.__name__.removeprefix("_")): Recording(name, published, convert)
    for convert, published in _PUBLISHED.items()
}
