"""What a raw log is read as, asked from outside: by `teleopdesign new`, and by loading its folder.

    python tests/corpus/reading.py LOG ... [-- OPTION ...]      prints an entry to check and to keep

The command line, saved files and `td.load_experiment` are all that is used of the package.
"""

from __future__ import annotations

import contextlib
import gzip
import io
import json
import math
import shutil
import sys
import tempfile
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

import teleopdesign as td
from teleopdesign.cli import main as teleopdesign

HERE = Path(__file__).parent
#: parts of the duration of the first record at which signals are compared
MOMENTS = (0.2, 0.45, 0.8)
#: rows about a moment of which any may be the reading: a row early or late is no other reading
NEAR = 2
#: part of the range of a signal by which a reading may differ: of another resampling
SLACK = 0.02
#: channels, and keys of theirs that say how numbers of a column become a quantity
CHANNELS = (
    "time", "sample_rate", "segment", "position", "velocity", "actuator_force", "interaction_force",
)  # fmt: skip
KEYS = (
    "column", "unit", "value", "sign", "scale", "offset", "unwrap", "counts_per_turn", "gear_ratio",
    "torque_constant", "lever_arm", "sign_bit", "twos_complement", "measured",
)  # fmt: skip
#: keys that are estimates, and by which part they may differ; in an entry, 0: nothing is estimated
ESTIMATES = {"resolution": 0.02, "noise": 0.2}
#: keys that an entry need not state: what nothing in a log tells may be read in any way
MAY_BE_LEFT_OUT = ("unit", "torque_constant", "lever_arm", "counts_per_turn", *ESTIMATES)
#: spellings of one unit
SPELT = {"Nm": "N*m", "N m": "N*m", "°": "deg", "mNm": "mN*m", "rev": "turns"}
#: keys of an entry that are no channels
OTHERS = ("log", "why", "options", "refused", "says", "stated", "axis", "records", "sample_time",
          "duration", "at", "fails_today")  # fmt: skip


@dataclass(frozen=True)
class Reading:
    """What was read of a log.

    refused: the line with which it was refused, "" where it was read;  printed: what `new` printed
    channels: quantity -> how its column is read;  guessed: keys that are guesses, with reasons
    at: signal -> its values in SI at MOMENTS;  slack: signal -> by how much they may differ
    records: use of each;  sample_time, duration: s, of the first record and of all
    """

    refused: str = ""
    printed: str = ""
    axis: str = ""
    channels: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    guessed: Mapping[str, str] = field(default_factory=dict)
    at: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    slack: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    records: tuple[str, ...] = ()
    sample_time: float = math.nan
    duration: float = math.nan


def entries() -> dict[str, dict[str, Any]]:
    """Every entry of the corpus: "group/name" -> its table, and the folder that its log is in."""
    every = {}
    for index in sorted(HERE.glob("*.toml")):
        for name, entry in tomllib.loads(index.read_text(encoding="utf-8")).items():
            every[f"{index.stem}/{name}"] = {**entry, "folder": HERE / index.stem / name}
    return every


def unpacked(entry: Mapping[str, Any], folder: Path) -> list[Path]:
    """The logs of an entry in a folder, under the names that their loggers gave them."""
    logs = [entry["log"]] if isinstance(entry["log"], str) else entry["log"]
    return [_unpack(entry["folder"] / log, folder / log) for log in logs]


def _unpack(source: Path, target: Path) -> Path:
    """Copy a file or a folder; a file that is kept as NAME.gz is unpacked."""
    packed = source.with_name(source.name + ".gz")
    target.parent.mkdir(parents=True, exist_ok=True)
    if source.is_dir():
        target.mkdir()
        for part in source.iterdir():
            name = part.name.removesuffix(".gz")
            _unpack(source / name, target / name)
    elif packed.exists():
        target.write_bytes(gzip.decompress(packed.read_bytes()))
    else:
        shutil.copyfile(source, target)
    return target


def read(logs: Sequence[Path], options: Sequence[str], folder: Path) -> Reading:
    """Read logs as a user does; `folder` is where the experiment is made.

    A folder that holds an experiment.toml is loaded as it is.
    """
    printed, errors = io.StringIO(), io.StringIO()
    made = logs[0]
    if not (made / "experiment.toml").exists():
        made = folder
        words = ["new", *map(str, logs), "--yes", "--output", str(folder), *options]
        with _no_picture(), contextlib.redirect_stdout(printed), contextlib.redirect_stderr(errors):
            try:
                status = teleopdesign(words)
            except SystemExit as end:
                status = int(end.code or 0)
        if status != 0:
            return Reading(refused=errors.getvalue().strip())
    try:
        return _loaded(made, printed.getvalue())
    except td.ExperimentError as problem:
        return Reading(refused=str(problem))


@contextlib.contextmanager
def _no_picture() -> Iterator[None]:
    """Pictures are drawn and left empty: to save them takes longer than to read a small log."""
    from matplotlib.figure import Figure

    kept, Figure.savefig = Figure.savefig, _touch  # type: ignore[method-assign]
    try:
        yield
    finally:
        Figure.savefig = kept  # type: ignore[method-assign]


def _touch(figure: Any, path: Any, **options: Any) -> None:
    Path(path).touch()


def _loaded(folder: Path, printed: str) -> Reading:
    written = tomllib.loads((folder / "experiment.toml").read_text(encoding="utf-8"))
    experiment = td.load_experiment(folder)
    first = experiment.records[0]
    at, slack = {}, {}
    for name, values in first.signals.items():
        short = name.removeprefix("device.")
        at[short], slack[short] = _at_moments(np.asarray(first.time), np.asarray(values))
    bodies = list(experiment.bodies)
    return Reading(
        printed=printed,
        axis=experiment.axis(bodies[0]) if len(bodies) == 1 else "",
        channels={
            quantity: {key: entry[key] for key in (*KEYS, *ESTIMATES) if key in entry}
            for quantity, entry in written["channels"].items()
            if quantity in CHANNELS
        },
        guessed=dict(written.get("guessed", {})),
        at=at,
        slack=slack,
        records=tuple(r.use for r in experiment.records),
        sample_time=float(first.sample_time),
        duration=float(sum(r.duration for r in experiment.records)),
    )


def _at_moments(time: Any, values: Any) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Values at MOMENTS, and how far another reading of the same log may be from each."""
    extent = float(np.ptp(values))
    at, slack = [], []
    for part in MOMENTS:
        moment = time[0] + part * (time[-1] - time[0])
        row = int(np.searchsorted(time, moment))
        near = values[max(row - NEAR, 0) : row + NEAR + 1]
        at.append(float(np.interp(moment, time, values)))
        slack.append(SLACK * extent + float(np.ptp(near)))
    return tuple(at), tuple(slack)


def differences(entry: Mapping[str, Any], reading: Reading) -> list[str]:
    """What of a reading differs from what its entry states, a line each."""
    words = entry.get("refused")
    if words is not None:
        if not reading.refused or "\n" in reading.refused:
            return [f"expected a refusal in one line, found {reading.refused or reading.channels}"]
        return [
            f"refused without {w!r}: {reading.refused}" for w in words if w not in reading.refused
        ]
    if reading.refused:
        return [f"refused: {reading.refused}"]
    lines = [f"not said: {w!r}" for w in entry.get("says", ()) if w not in reading.printed]
    lines += [f"guessed: {key}" for key in entry.get("stated", ()) if key in reading.guessed]
    for name, near in (("sample_time", 2e-3), ("duration", 2e-2)):
        value = getattr(reading, name)
        if name in entry and not math.isclose(value, entry[name], rel_tol=near):
            lines.append(f"{name}: {value:.6g}, expected {entry[name]:.6g}")
    for name, value in (("axis", reading.axis), ("records", list(reading.records))):
        if name in entry and value != entry[name]:
            lines.append(f"{name}: {value}, expected {entry[name]}")
    named = {name: entry[name] for name in entry if name in CHANNELS}
    if named:  # all of them: a quantity that the entry does not name must not be read
        for quantity in sorted({*named, *reading.channels}):
            lines += _channel(quantity, named.get(quantity), reading.channels.get(quantity))
    for name, values in entry.get("at", {}).items():
        lines += _signal(name, values, reading)
    return lines


def _channel(quantity: str, expected: Any, read: Any) -> list[str]:
    """Differences of one channel; numbers that a balance tells may differ by 3 %."""
    if expected is None or read is None:
        return [f"{quantity}: {read}, expected {expected}"]
    lines = []
    for key in sorted({*expected, *read}):
        one, other = expected.get(key), read.get(key)
        if one is None and key in MAY_BE_LEFT_OUT:
            continue
        if key in ESTIMATES:
            same = math.isclose(one, other or 0.0, rel_tol=ESTIMATES[key])
        elif key == "unit":
            same = SPELT.get(one, one) == SPELT.get(other, other)
        elif isinstance(one, dict) and isinstance(other, dict):
            same = one["unit"] == other["unit"]
            same &= math.isclose(one["value"], other["value"], rel_tol=0.03)
        elif isinstance(one, float) and isinstance(other, int | float):
            same = math.isclose(one, other, rel_tol=1e-3)
        else:
            same = one == other
        if not same:
            lines.append(f"{quantity}.{key}: {other}, expected {one}")
    return lines


def _signal(name: str, expected: Sequence[float], reading: Reading) -> list[str]:
    if name not in reading.at:
        return [f"{name}: not read"]
    rows = zip(MOMENTS, reading.at[name], expected, reading.slack[name], strict=True)
    return [
        f"{name} at {part:g} of the record: {value:.5g}, expected {wanted:.5g}"
        for part, value, wanted, slack in rows
        if abs(value - wanted) > slack
    ]


def entry_text(name: str, entry: Mapping[str, Any]) -> str:
    """An entry as it stands in its table of the corpus."""
    lines = [f"[{name}]"]
    for key in (*OTHERS[:6], *CHANNELS, *OTHERS[6:]):
        if key in entry:
            lines.append(f"{key} = {_inline(entry[key])}")
    return "\n".join(lines) + "\n"


def _inline(value: Any) -> str:
    if isinstance(value, Mapping):
        inner = ", ".join(f"{_key(k)} = {_inline(v)}" for k, v in value.items())
        return f"{{ {inner} }}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_inline, value))}]"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        text = f"{value:.6g}"
        return text if any(c in text for c in ".en") else f"{text}.0"
    return str(value) if isinstance(value, int) else json.dumps(value, ensure_ascii=False)


def _key(name: str) -> str:
    plain = name.replace("_", "").replace("-", "").isalnum() and name.isascii()
    return name if plain else json.dumps(name, ensure_ascii=False)


def entry_of(log: str | Sequence[str], options: Sequence[str], reading: Reading) -> dict[str, Any]:
    """What a reading would state, for a reader to check word by word and number by number."""
    entry: dict[str, Any] = {"log": log, "why": "..."}
    if options:
        entry["options"] = list(options)
    if reading.refused:
        return {**entry, "refused": [reading.refused]}
    at = {
        name: [
            _digits(value, slack) for value, slack in zip(values, reading.slack[name], strict=True)
        ]
        for name, values in reading.at.items()
    }
    return {
        **entry,
        **reading.channels,
        "axis": reading.axis,
        "records": list(reading.records),
        "sample_time": float(f"{reading.sample_time:.5g}"),
        "duration": float(f"{reading.duration:.4g}"),
        "at": at,
    }


def _digits(value: float, slack: float) -> float:
    """A value with the digits that are compared, and one more."""
    if not slack:
        return value
    return round(value, 2 - math.floor(math.log10(slack)))


def main(words: Sequence[str]) -> None:
    """Print the entry of a log as it is read today."""
    logs, options = list(words), []
    if "--" in logs:
        cut = logs.index("--")
        logs, options = logs[:cut], logs[cut + 1 :]
    paths = [Path(log) for log in logs]
    with tempfile.TemporaryDirectory() as scratch:
        reading = read(paths, options, Path(scratch) / "made")
    names = [path.name for path in paths]
    print(reading.printed, file=sys.stderr)
    print(
        entry_text(
            paths[0].stem, entry_of(names[0] if len(names) == 1 else names, options, reading)
        )
    )


if __name__ == "__main__":
    main(sys.argv[1:])
