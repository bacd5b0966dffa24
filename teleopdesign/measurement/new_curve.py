"""A friction curve from a table of speeds and forces: its columns, and the folder.

A table without a time and a position is one if one column is a speed and one a force, by their
names or units.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..base.errors import ExperimentError, quote, unknown
from ..base.files import write_text
from ..base.toml import comment_text, inline_text, string_text
from ..base.units import AXES, measures, unit_of
from .column_names import as_unit, likeness, unit_in_name
from .doors._log import Log
from .friction_curve import CURVE
from .new_folder import copy_logs

#: what a column may be: channel -> quantity of its name
QUANTITIES = {"velocity": "velocity", "actuator_force": "actuator_force"}
_KINDS = {"velocity": "velocity", "actuator_force": "force"}


@dataclass(frozen=True)
class CurveColumns:
    """The columns of a friction curve.

    columns, units: by channel, "velocity" and "actuator_force"
    axis: "prismatic" or "revolute";  guesses: key of the file -> reason
    torque_constant: value and unit, where the force is a current; None: it is a force
    """

    columns: Mapping[str, str]
    units: Mapping[str, str]
    axis: str
    guesses: Mapping[str, str]
    torque_constant: tuple[float, str] | None = None


def looks_like_a_curve(log: Log) -> bool:
    """Whether a log has a speed and a force, and neither a time nor a position."""
    others = ("time", "position")
    if any(likeness(name, q) > 0.0 for name in log.names for q in others):
        return False
    if any(unit_in_name(name, q, a) for name in log.names for q in others for a in AXES):
        return False
    return all(_candidates(log, channel) for channel in QUANTITIES)


def _candidates(log: Log, channel: str) -> list[str]:
    """Columns that may be this channel, the likeliest first."""
    score = {
        name: likeness(name, QUANTITIES[channel])
        + any(unit_in_name(name, _KINDS[channel], axis) is not None for axis in AXES)
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
) -> CurveColumns:
    """The columns, units and axis of a friction curve, with reasons for what was guessed.

    file: name in messages;  velocity, force, units: as the user states them; None: guessed
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
    known = {c: as_unit(u) for c, u in (units or {}).items()} | {
        c: u for c, u in log.units.items() if c not in (units or {})
    }
    written = {
        channel: known.get(column) or _unit_of_name(column, channel, axis)
        for channel, column in columns.items()
    }
    if torque_constant is not None:  # the column is a current
        written["actuator_force"] = None
    axis = axis or _axis_of(columns, written, file)
    for channel in columns:
        if written[channel] is None:
            written[channel] = unit_of(_KINDS[channel], axis)
            guesses[f"channels.{channel}.unit"] = "no unit is stated: SI"
    if torque_constant is not None:
        column = columns["actuator_force"]
        written["actuator_force"] = known.get(column) or unit_in_name(column) or "A"
    stated_units = {c: str(u) for c, u in written.items()}
    return CurveColumns(columns, stated_units, axis, guesses, torque_constant)


def _unit_of_name(column: str, channel: str, axis: str | None) -> str | None:
    for one in (axis,) if axis else AXES:
        if (unit := unit_in_name(column, _KINDS[channel], one)) is not None:
            return unit
    return None


def _axis_of(columns: Mapping[str, str], units: Mapping[str, str | None], file: str) -> str:
    """The axis on which all units that are known are units of their quantities."""
    fits = [
        axis
        for axis in AXES
        if all(u is None or measures(u, _KINDS[c], axis) for c, u in units.items())
    ]
    if len(fits) != 1 or not any(units.values()):
        raise ExperimentError(
            f"{file}: the units of {' and '.join(map(quote, columns.values()))} do not tell the "
            "axis: state --axis prismatic or revolute, and --unit COLUMN=UNIT"
        )
    return fits[0]


def make_curve_folder(
    curve: CurveColumns,
    logs: Sequence[Path],
    folder: Path,
    *,
    title: str,
    effects: Sequence[str] = ("coulomb", "viscous"),
) -> Path:
    """Copy the tables into a folder and write experiment.toml; of several, the last is for checks.

    raises ExperimentError: the folder cannot be written
    """
    copy_logs(logs, folder)
    lines = [f"kind = {string_text(CURVE)}", f"title = {string_text(title)}", ""]
    lines += ["[model.device]", f"axis = {string_text(curve.axis)}", "[model.device.effects]"]
    lines += [f"{name} = {{}}" for name in effects]
    lines += ["", "[channels]"]
    lines += [comment_text(f"guessed: {key}: {why}") for key, why in curve.guesses.items()]
    for channel, column in curve.columns.items():
        entry = {"column": string_text(column), "unit": string_text(curve.units[channel])}
        if channel == "actuator_force" and curve.torque_constant is not None:
            value, unit = curve.torque_constant
            constant = {"value": repr(value), "unit": string_text(unit)}
            entry["torque_constant"] = inline_text(constant)
        lines.append(f"{channel} = {inline_text(entry)}")
    for k, log in enumerate(logs):
        use = "check" if k and k == len(logs) - 1 else "fit"
        lines += ["", "[[records]]", f"file = {string_text(log.name)}", f"use = {string_text(use)}"]
    if curve.guesses:
        lines += ["", "[guessed]"]
        lines += [f"{string_text(k)} = {string_text(why)}" for k, why in curve.guesses.items()]
    write_text(folder / "experiment.toml", "\n".join(lines) + "\n")
    return folder
