"""Public recordings of real devices, downloaded from their authors and converted to experiments.

    from teleopdesign.measurement.recordings import fetch

    experiment = load_experiment(fetch("emps"))

The package does not contain the files, because no licence is stated for the data. Each file is
downloaded once at a fixed commit, checked against its hash, and converted into an experiment's
folder.
"""

import hashlib
import shutil
import tempfile
from pathlib import Path

from ...base.arguments import check_types
from ...base.errors import ExperimentError, did_you_mean, quote
from ._recording import RECORDINGS, RawFile, Recording

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
