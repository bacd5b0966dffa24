"""A friction curve from a table of speeds and forces, or from arrays in memory.

A table without a time and a position is one if one column is a speed and one a force, by their
names or units.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ..base.arguments import check_types
from ..base.errors import ExperimentError, quote, unknown
from ..base.files import write_text
from ..base.toml import Table
from ..base.units import AXES, measures, unit_of
from .channel import BODY_QUANTITIES
from .column_names import as_unit, likeness, unit_in_name
from .doors._log import Log
from .experiment import Experiment
from .friction_curve import CHANNELS, CURVE, bodies_and_channels, curve_record
from .new_folder import body_with_friction, copy_logs, experiment_text, records_of
from .record import RecordEntry
from .survey.content import Survey
from .tables import LogColumns


def is_over_time(log: Log) -> bool:
    """Whether a column of a log is a time or a position, by its name or unit."""
    others = ("time", "position")
    named = any(likeness(name, q) > 0.0 for name in log.names for q in others)
    return named or any(unit_in_name(n, q, a) for n in log.names for q in others for a in AXES)


def looks_like_a_curve(log: Log) -> bool:
    """Whether a log has a speed and a force, and neither a time nor a position."""
    return not is_over_time(log) and all(_candidates(log, channel) for channel in CHANNELS)


def _candidates(log: Log, channel: str) -> list[str]:
    """Columns that may be this channel, the likeliest first."""
    score = {
        name: likeness(name, channel)
        + any(unit_in_name(name, BODY_QUANTITIES[channel], axis) is not None for axis in AXES)
        for name in log.names
    }
    return sorted((n for n in score if score[n] > 0.0), key=lambda n: -score[n])


def curve_columns(
    log: Log,
    file: str,
    *,
    axis: str | None = None,
    velocity: str | None = None,
    force: str | None = None,
    units: Mapping[str, str] | None = None,
    torque_constant: tuple[float, str] | None = None,
    gear_ratio: float | None = None,
) -> Survey:
    """The channels and the axis of a friction curve, with reasons for what was guessed.

    file: name in messages;  velocity, force, units: as the user states them; None: guessed
    gear_ratio: turns of the motor, whose speed and force these are, per turn of the joint
    raises ExperimentError: no such column, no speed or force, units that leave the axis open
    """
    columns: dict[str, str] = {}
    guesses = {"kind": "no column is a time or a position: points, not samples"}
    for channel, stated in (("velocity", velocity), ("actuator_force", force)):
        possible = _candidates(log, channel)
        if stated is not None and stated not in log.names:
            raise ExperimentError(f"{file}: {unknown('column', stated, log.names)}")
        if stated is None and not possible:
            option = "--velocity" if channel == "velocity" else "--force"
            raise ExperimentError(
                f"{file}: no column sounds like the {channel.replace('_', ' ')} of a {CURVE}, "
                f"found {', '.join(log.names)}: state it with {option} COLUMN"
            )
        columns[channel] = stated or possible[0]
        if stated is None:
            guesses[f"channels.{channel}.column"] = f"the name {quote(columns[channel])}"
    if columns["velocity"] == columns["actuator_force"]:
        raise ExperimentError(
            f"{file}: {quote(columns['velocity'])} is speed and force: state them"
        )
    known = {**log.units, **{c: as_unit(u) for c, u in (units or {}).items()}}
    written = {
        channel: known.get(column) or _unit_of_name(column, channel, axis)
        for channel, column in columns.items()
    }
    if torque_constant is not None:  # the column is a current
        written["actuator_force"] = None
    axis = axis or _axis_of(columns, written, file)
    for channel in columns:
        if written[channel] is None:
            written[channel] = unit_of(BODY_QUANTITIES[channel], axis)
            guesses[f"channels.{channel}.unit"] = "no unit is stated: SI"
    if torque_constant is not None:
        column = columns["actuator_force"]
        written["actuator_force"] = known.get(column) or unit_in_name(column) or "A"
    channels: dict[str, dict[str, Any]] = {
        channel: {"column": column, "unit": written[channel]} for channel, column in columns.items()
    }
    if torque_constant is not None:
        value, unit = torque_constant
        channels["actuator_force"]["torque_constant"] = {"value": value, "unit": unit}
    if gear_ratio is not None:
        for entry in channels.values():
            entry["gear_ratio"] = gear_ratio
    return Survey(axis, channels, 0.0, guesses)


def _unit_of_name(column: str, channel: str, axis: str | None) -> str | None:
    for one in (axis,) if axis else AXES:
        if (unit := unit_in_name(column, BODY_QUANTITIES[channel], one)) is not None:
            return unit
    return None


def _axis_of(columns: Mapping[str, str], units: Mapping[str, str | None], file: str) -> str:
    """The axis on which all units that are known are units of their quantities."""
    fits = [
        axis
        for axis in AXES
        if all(u is None or measures(u, BODY_QUANTITIES[c], axis) for c, u in units.items())
    ]
    if len(fits) != 1 or not any(units.values()):
        raise ExperimentError(
            f"{file}: the units of {' and '.join(map(quote, columns.values()))} do not tell the "
            "axis: state --axis prismatic or revolute, and --unit COLUMN=UNIT"
        )
    return fits[0]


def make_curve_folder(
    curve: Survey,
    logs: Sequence[Path],
    folder: Path,
    *,
    title: str,
) -> Path:
    """Copy the tables into a folder and write experiment.toml; of several, the last is for checks.

    raises ExperimentError: the folder cannot be written
    """
    copy_logs(logs, folder)
    records = records_of([log.name for log in logs])
    body = body_with_friction(curve.axis)
    text = experiment_text(curve, records, title=title, body=body, kind=CURVE)
    write_text(folder / "experiment.toml", text)
    return folder


@check_types
def friction_curve(
    velocity: Any,
    force: Any,
    *,
    axis: str,
    check: Sequence[Any] | None = None,
    units: Mapping[str, str] | None = None,
    noise: float | None = None,
    effects: Sequence[str] = ("coulomb", "viscous"),
    title: str = CURVE,
) -> Experiment:
    """A friction curve: points of constant speed and the force that holds it, without time.

    velocity, force: (n,) each, with their signs; several points may have one speed
    axis: "prismatic" (m/s, N) or "revolute" (rad/s, N*m)
    check: (velocity, force) of points that are not fitted; None: every fourth speed is held out in
        turn
    units: {"velocity": "rpm", "force": "mN*m"}; default: SI
    noise: rms of the force, in its unit; None: read from the points
    effects: those of the model: friction of the speed, and "bias"
    raises ExperimentError: arrays of different lengths, an unknown unit, too few points

        >>> speed = np.array([-0.2, -0.1, -0.05, -0.02, 0.02, 0.05, 0.1, 0.2])
        >>> curve = td.friction_curve(speed, 1.5 * np.sign(speed) + 0.4 * speed, axis="prismatic")
        >>> curve.kind
        'friction curve'
    """
    where = "friction_curve"
    stated = dict(units or {})
    names = {"velocity": "velocity", "actuator_force": "force"}
    if strangers := set(stated) - set(names.values()):
        raise ExperimentError(f"{where}: units: found {min(strangers)!r}, expected velocity, force")
    channels: dict[str, Any] = {
        channel: {
            "column": channel,
            "unit": stated.get(name, unit_of(name, axis if axis == "revolute" else "prismatic")),
        }
        for channel, name in names.items()
    }
    if noise is not None:
        channels["actuator_force"]["noise"] = noise
    body = {"axis": axis, "effects": {name: {} for name in effects}}
    content = Table({"channels": channels, "model": {"device": body}}, where)
    bodies, read = bodies_and_channels(content)
    records = []
    for use, points in (("fit", (velocity, force)), *([("check", check)] if check else [])):
        values = [np.asarray(x, dtype=float).ravel() for x in points]
        if len(values) != 2 or len(values[0]) != len(values[1]):
            raise ExperimentError(
                f"{where}: {use}: found {' and '.join(str(len(v)) for v in values)} values, "
                "expected as many speeds as forces"
            )
        columns = LogColumns(dict(zip(names, values, strict=True)))
        records.append(curve_record(columns, RecordEntry(use, use), read))
    return Experiment(Path(title), title, bodies, None, read, None, tuple(records), kind=CURVE)
