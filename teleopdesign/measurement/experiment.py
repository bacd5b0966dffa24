"""An experiment: a folder with experiment.toml and the record files that it names."""

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import final

import numpy as np

from ..base.errors import ExperimentError, did_you_mean, quote
from ..base.files import follow_links
from ..base.frozen import ByValue
from ..base.shown import html_table
from ..base.toml import Table, read_toml
from ..base.units import unit_of
from .arm_description import ArmDescription, arm_from
from .channel import BODY_QUANTITIES, Channel, LogLayout, frequency_from, layout_from
from .description import BodyDescription, EnvironmentDescription, bodies_from, environment_from
from .doors._log import join_names
from .friction_curve import CURVE, bodies_and_channels, curve_record
from .reading import ReadingStep, reading_lines
from .record import Record, RecordEntry, read_record, record_entries
from .tables import is_log, read_columns

_FILE = "experiment.toml"
#: most samples of all records together; if there are more, only windows of the records are used
MOST = 100_000
#: s, length of a window: forty time constants of a 2 Hz low-pass
WINDOW = 4.0


@final
@dataclass(frozen=True, eq=False)
class Experiment(ByValue):
    """Records of a device, their channels, and the model that the user states. Signals in SI units.

    bodies: "device", or "master" and "slave", or the joints of an arm by their names
    channels: "device.position" and the like, "time", "segment"
    bandwidth: Hz; model and measurement are compared below it; None: chosen from the records
    arm: the links that couple the bodies, where these are the joints of an arm; else None
    kind: "friction curve": points of speed and force, without time; "": records over time
    guesses: entries that `teleopdesign new` guessed and nobody confirmed: key -> reason
    """

    folder: Path
    title: str
    bodies: Mapping[str, BodyDescription]
    environment: EnvironmentDescription | None
    channels: Mapping[str, Channel]
    bandwidth: float | None
    records: tuple[Record, ...]
    guesses: Mapping[str, str] = field(default_factory=dict)
    arm: ArmDescription | None = None
    kind: str = ""

    @property
    def is_curve(self) -> bool:
        """Whether the records are points of a friction curve, without time."""
        return self.kind == CURVE

    @property
    def fit_records(self) -> tuple[Record, ...]:
        """Records on which parameters are estimated; at least one."""
        return tuple(record for record in self.records if record.use == "fit")

    @property
    def check_records(self) -> tuple[Record, ...]:
        """Records on which errors are reported, which are never fitted; may be empty."""
        return tuple(record for record in self.records if record.use == "check")

    @property
    def reading(self) -> tuple[ReadingStep, ...]:
        """Steps that made even records of the logs; empty: the logs are used unchanged."""
        return tuple(step for record in self.records for step in record.reading)

    def save(self, folder: str | Path) -> Path:
        """Write the experiment as a folder with experiment.toml and its records in SI.

        raises ExperimentError: the folder holds an experiment already, or cannot be written
        """
        from .saving import write_experiment

        return write_experiment(self, folder)

    def axis(self, body: str) -> str:
        """Axis of a body: "prismatic" or "revolute"; raises ExperimentError: no such body."""
        if body not in self.bodies:
            raise ExperimentError(
                f"{self.folder.name}/{_FILE}: no body {quote(body)}, found {', '.join(self.bodies)}"
            )
        return self.bodies[body].axis

    def _repr_html_(self) -> str:
        rows = [
            (
                name,
                body.axis,
                ", ".join(body.effects) or "no effects",
                ", ".join(q for q in BODY_QUANTITIES if f"{name}.{q}" in self.channels),
            )
            for name, body in self.bodies.items()
        ]
        rows += [
            (r.file, r.use, f"{r.duration:.6g} s", f"{1 / r.sample_time:.6g} Hz")
            for r in self.records
        ]
        title = f"Experiment {quote(self.title)} ({self.folder.name})"
        return html_table(title, ("body or record", "axis or use", "", ""), rows)

    def __repr__(self) -> str:
        return "\n".join([describe_content(self), *reading_lines(self.reading)])


def describe_content(experiment: Experiment) -> str:
    """Bodies, channels and records, one line each, without the steps of reading the logs."""
    lines = [f"Experiment {quote(experiment.title)} ({experiment.folder.name})"]
    for name, body in experiment.bodies.items():
        effects = ", ".join(body.effects) or "no effects"
        lines.append(f"  {name}: {body.axis}, {effects}")
        for quantity in BODY_QUANTITIES:
            channel = experiment.channels.get(f"{name}.{quantity}")
            if channel is not None:
                unit = unit_of(BODY_QUANTITIES[quantity], body.axis)
                lines.append(f"    {quantity} in {unit}{_exactness(channel, unit)}")
    if experiment.arm is not None:
        lines += [f"  {line}" for line in repr(experiment.arm).splitlines()]
    lines += [f"  {record!r}" for record in experiment.records]
    return "\n".join(lines)


def load_experiment(folder: str | Path) -> Experiment:
    """Read and check a whole experiment.

    folder: the folder of experiment.toml (the path of the file is also accepted)
    raises ExperimentError: anything missing, unknown, of the wrong type or unit, in one line
    """
    folder = folder_of_experiment(Path(folder))
    experiment = read_toml(folder / _FILE, f"{folder.name}/{_FILE}")
    if "diagram" in experiment.content:
        raise ExperimentError(
            f"{experiment.where('diagram')}: found a whole diagram, expected [model]: it is "
            "compared by `teleopdesign diagnose` and td.find_missing"
        )
    kind = experiment.choice("kind", (CURVE,)) if "kind" in experiment.content else ""
    over_time = () if kind else ("comparison", "sample_rate")
    known = ("kind", "title", "model", "channels", "records", "guessed", *over_time)
    experiment.allow(known)
    title, model = experiment.text("title", folder.name), experiment.table("model")
    arm = environment = bandwidth = None
    if kind:
        bodies, channels = bodies_and_channels(experiment)
        layout = LogLayout(channels, bodies)
    else:
        is_arm = "arm" in model.content
        arm, bodies = arm_from(model, folder) if is_arm else (None, bodies_from(model))
        environment = environment_from(model, bodies) if arm is None else None
        layout = layout_from(experiment, bodies)
        comparison = experiment.table("comparison")
        comparison.allow(("bandwidth",))
        bandwidth = frequency_from(comparison, "bandwidth") if comparison.content else None
    entries = record_entries(experiment, folder)
    if kind and any(entry.span is not None for entry in entries):
        raise ExperimentError(f"{experiment.where('records')}: span: a {CURVE} has no time")
    read = _read_points if kind else read_record
    records = tuple(read(folder, entry, layout) for entry in entries)
    if bandwidth is not None:
        _check_bandwidth(bandwidth, records, comparison)
    guessed = experiment.table("guessed")
    guesses = {key: guessed.text(key) for key in guessed.content}
    measured = (layout.channels, bandwidth, records)
    return Experiment(folder, title, bodies, environment, *measured, guesses, arm, kind)


def _read_points(folder: Path, entry: RecordEntry, layout: LogLayout) -> Record:
    """Read one record of a friction curve."""
    columns = read_columns(folder / entry.file, f"{folder.name}/{entry.file}", layout.wanted)
    return curve_record(columns, entry, layout.channels)


def folder_of_experiment(path: Path) -> Path:
    """The folder of an experiment, by its own path or that of a file in it.

    raises ExperimentError: there is no such folder, or it holds no experiment.toml
    """
    try:
        if path.is_file() and (path.parent / _FILE).is_file():
            path = path.parent
        elif path.is_file() and path.suffix not in (".toml", ".json"):
            if not is_log(path):
                raise ExperimentError(f"{path}: expected a folder with {_FILE}, or an answer.json")
            raise ExperimentError(
                f"{path}: a log with no {_FILE} beside it; to make one: "
                f"teleopdesign new {shlex.quote(str(path))}"
            )
        path = follow_links(path)
        if path.is_dir():
            names = sorted(entry.name for entry in path.iterdir())
        else:
            parent = path.parent
            names = [entry.name for entry in parent.iterdir()] if parent.is_dir() else []
            raise ExperimentError(f"{path.name}: no such folder{did_you_mean(path.name, names)}")
    except (OSError, ValueError) as problem:  # ValueError: a null character in the path
        reason = getattr(problem, "strerror", None) or str(problem)
        raise ExperimentError(f"{path.name}: cannot be read: {reason}") from None
    if _FILE not in names:
        listed = join_names(names)
        raise ExperimentError(
            f"{path.name}: no {_FILE}, "
            f"found {listed or 'an empty folder'}{did_you_mean(_FILE, names)}"
        )
    return path


def _check_bandwidth(bandwidth: float, records: Sequence[Record], comparison: Table) -> None:
    for record in records:
        highest = 0.5 / record.sample_time
        if bandwidth >= highest:
            raise ExperimentError(
                f"{comparison.where('bandwidth')}: found {bandwidth:g} Hz, expected less than "
                f"{highest:g} Hz, half the sample rate of {record.file}"
            )


def _exactness(channel: Channel, unit: str) -> str:
    parts = []
    if channel.resolution is not None:
        parts.append(f"resolution {channel.resolution:.3g} {unit}")
    if channel.noise is not None:
        parts.append(f"noise {channel.noise:.3g} {unit}")
    return f" ({', '.join(parts)})" if parts else ""


def isolate_joint(experiment: Experiment, joint: str) -> Experiment:
    """The experiment on one joint alone."""
    channels = {n: c for n, c in experiment.channels.items() if c.body in (joint, None)}
    bodies = {joint: experiment.bodies[joint]}
    return replace(experiment, bodies=bodies, channels=channels, arm=None)


def excerpt(experiment: Experiment, *, most: int = MOST) -> Experiment:
    """The experiment with about `most` samples; the experiment itself where it has no more.

    Nothing is copied: the windows are segments of the records. Hidden states start anew in each
        window.
    """
    total = sum(len(r.time) for r in experiment.records)
    if total <= most:
        return experiment
    part = most / total
    records = tuple(replace(r, segments=_windows(r, part)) for r in experiment.records)
    return replace(experiment, records=records)


def _windows(record: Record, part: float) -> tuple[slice, ...]:
    """Windows that make up about `part` of a record, spread over its segments; at least one.

    The number of windows follows the total length of the segments so far: of many short segments,
    every n-th becomes a window.
    """
    size = max(64, round(WINDOW / record.sample_time))
    windows, owed = [], 0.0
    for segment in record.segments:
        length = segment.stop - segment.start
        owed += part * length / size
        count = round(owed)
        if count * size >= length:
            windows.append(segment)
            owed -= length / size
        elif count:
            places = np.linspace(0.0, 1.0, count) if count > 1 else np.array([0.5])
            starts = [segment.start + int((length - size) * p) for p in places]
            windows += [slice(a, a + size) for a in starts]
            owed -= count
    longest = max(record.segments, key=lambda s: s.stop - s.start)
    return tuple(windows) or (slice(longest.start, min(longest.start + size, longest.stop)),)
