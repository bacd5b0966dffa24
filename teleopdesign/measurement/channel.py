"""Channels: which column of a record is which quantity of which body, its unit and its accuracy."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..base.errors import ExperimentError, did_you_mean, quote
from ..base.toml import Table
from ..base.units import si_factor
from .conversion import AS_WRITTEN, KEYS, Conversion, conversion_of, si_from
from .description import ONE_BODY, BodyDescription
from .encoder import Array

# name of a body's channel -> its quantity in the table of units
BODY_QUANTITIES = {
    "position": "position",
    "velocity": "velocity",
    "actuator_force": "force",
    "interaction_force": "force",
    # what laws of effects may use besides
    "temperature": "temperature",
    "other_position": "position",
}
_OF_THE_RECORD = ("time", "segment")


@dataclass(frozen=True)
class Channel:
    """One measured signal.

    quantity: a key of `BODY_QUANTITIES` such as "position" or "actuator_force", or "time" or
        "segment"
    body: None for time and segment
    column: header, variable or dataset name in the record files ("i_1 + i_2" for a sum)
    unit: the unit in which the file holds the values
    resolution: step of the encoder or converter, SI; None: not stated
    noise: rms, SI; None: not stated
    conversion: how the columns become the signal in SI; default: one column, as it is
    measured: an actuator force that is measured (for example by the motor current), not commanded
    beside: a force that acts, but to which no error is relative, as a command nobody recorded
    one_pass: written in one pass with the position, so that its log is neither late nor early
    """

    quantity: str
    body: str | None
    column: str
    unit: str
    resolution: float | None
    noise: float | None
    conversion: Conversion = AS_WRITTEN
    measured: bool = False
    beside: bool = False
    one_pass: bool = False

    @property
    def columns(self) -> tuple[str, ...]:
        """The columns from which the signal is computed."""
        return self.conversion.columns or (self.column,)

    @property
    def delay(self) -> float:
        """Delay of the signal in the log, s; positive if the log has the signal late."""
        return self.conversion.delay

    def signal(self, values: Mapping[str, Array]) -> Array:
        """The signal (n,) in SI;  values: column -> (n,)."""
        return self.conversion.signal({name: values[name] for name in self.columns})


@dataclass(frozen=True)
class LogLayout:
    """What the columns of an experiment's logs are.

    channels: "device.position" and the like, "time", "segment"
    sample_rate: of the rows, Hz; None: the channel "time" has their times
    """

    channels: Mapping[str, Channel]
    bodies: Mapping[str, BodyDescription]
    sample_rate: float | None = None

    @property
    def wanted(self) -> dict[str, str]:
        """Column -> the channel that needs it, as messages name the channel."""
        return {
            column: f"channels.{key.removeprefix('device.')}"
            for key, channel in self.channels.items()
            for column in channel.columns
        }

    def stamps(self, values: Mapping[str, Array], apart: Collection[str] = ()) -> Array:
        """The time of each row (n,), s, as written, or counted; NaN where there is none.

        values: column -> (n,);  apart: columns with other rows
        """
        if self.sample_rate is not None:
            count = max((len(x) for c, x in values.items() if c not in apart), default=0)
            return np.asarray(np.arange(count) / self.sample_rate)
        return self.channels["time"].signal(values)


def layout_from(experiment: Table, bodies: Mapping[str, BodyDescription]) -> LogLayout:
    """Read [channels] and the sample rate of an experiment; raises ExperimentError: see there."""
    table = experiment.table("channels")
    return LogLayout(channels_from(table, bodies), bodies, sample_rate_from(experiment, table))


def channels_from(
    table: Table,
    bodies: Mapping[str, BodyDescription],
    required: Sequence[str] = ("position", "actuator_force"),
) -> dict[str, Channel]:
    """Read [channels]: a dict from names ("device.position", "time", "segment") to channels.

    The name of a body's channel always contains the body.

    required: channels that each body must have

    raises ExperimentError: unknown or missing channel, wrong kind of unit, a column used twice
    """
    table = _flatten(table, bodies)
    known = _known_names(bodies)
    channels: dict[str, Channel] = {}
    for key in table.content:
        if key == "sample_rate":
            continue
        if key not in known:
            listed = ", ".join((*known, "sample_rate"))
            hint = did_you_mean(key, (*known, "sample_rate"))
            raise ExperimentError(
                f"{table.where()}: no quantity {quote(key)}, expected some of {listed}{hint}"
            )
        name = known[key]
        if name in channels:
            raise ExperimentError(f"{table.where(key)}: {quote(name)} is given twice")
        channels[name] = channel_from(table.table(key), name, bodies)
    _refuse_missing(table, channels, bodies, required)
    _refuse_shared_columns(table, channels)
    return channels


def sample_rate_from(experiment: Table, channels: Table) -> float | None:
    """Read `sample_rate` in Hz, under [channels] or at the top of the file; None if absent.

    raises ExperimentError: both or neither of `sample_rate` and the channel `time`
    """
    tables = [table for table in (channels, experiment) if "sample_rate" in table.content]
    if "time" in channels.content and tables:
        raise ExperimentError(
            f"{tables[0].where('sample_rate')}: found beside channels.time, expected one of the two"
        )
    if len(tables) == 2:
        raise ExperimentError(f"{experiment.where('sample_rate')}: is given twice")
    if not tables:
        if "time" not in channels.content:
            raise ExperimentError(
                f'{channels.where()}: no "time", expected {{ column = ..., unit = "s" }} '
                'or sample_rate = { value = 1000, unit = "Hz" }'
            )
        return None
    return frequency_from(tables[0], "sample_rate")


def frequency_from(table: Table, key: str) -> float:
    """Read { value, unit } under `key` as a positive frequency in Hz."""
    return si_from(table, key, "frequency", above=0)


def _flatten(table: Table, bodies: Mapping[str, BodyDescription]) -> Table:
    """Join nested keys: TOML reads an unquoted "master.position" as a table within a table."""
    content: dict[str, Any] = {}
    for key, value in table.content.items():
        if key in bodies and isinstance(value, dict):
            content |= {f"{key}.{quantity}": entry for quantity, entry in value.items()}
        else:
            content[key] = value
    return Table(content, table.file, table.key)


def _known_names(bodies: Mapping[str, BodyDescription]) -> dict[str, str]:
    """Key in the file -> name in the package; one body may be written with or without prefix."""
    names = {
        f"{body}.{quantity}": f"{body}.{quantity}"
        for body in bodies
        for quantity in BODY_QUANTITIES
    }
    short = {quantity: f"device.{quantity}" for quantity in BODY_QUANTITIES}
    of_the_record = {name: name for name in _OF_THE_RECORD}
    return of_the_record | (short | names if tuple(bodies) == ONE_BODY else names)


def channel_from(table: Table, name: str, bodies: Mapping[str, BodyDescription]) -> Channel:
    """The channel that a table describes;  name: in the package, such as "device.position"."""
    body, _, quantity = name.rpartition(".")
    if quantity in _OF_THE_RECORD:
        table.allow(("column", "unit"))
        unit = table.text("unit", "1" if quantity == "segment" else None)
        column, where = table.text("column"), table.where("unit")
        kind = "time" if quantity == "time" else "dimensionless"
        plain = Conversion((column,), (1.0,), factor=si_factor(unit, quantity=kind, where=where))
        return Channel(quantity, None, column, unit, None, None, plain)
    actuator = ("measured",) if quantity == "actuator_force" else ()
    table.allow(("column", "unit", "resolution", "noise", *KEYS, *actuator))
    unit = table.text("unit")
    conversion, count = conversion_of(
        table,
        quantity=quantity,
        kind=BODY_QUANTITIES[quantity],
        axis=bodies[body].axis,
        unit=unit,
    )
    resolution = table.number_or_none("resolution", above=0)
    noise = table.number_or_none("noise", above=0)
    factor = abs(conversion.factor)
    return Channel(
        quantity,
        body,
        " + ".join(conversion.columns),
        unit,
        count if resolution is None else resolution * factor,
        None if noise is None else noise * factor,
        conversion,
        table.flag("measured", False),
    )


def _refuse_missing(
    table: Table,
    channels: Mapping[str, Channel],
    bodies: Mapping[str, BodyDescription],
    required: Sequence[str],
) -> None:
    for body in bodies:
        for quantity in required:
            if f"{body}.{quantity}" not in channels:
                name = quantity if tuple(bodies) == ONE_BODY else f"{body}.{quantity}"
                listed = ", ".join(table.content) or "no channel"
                raise ExperimentError(f"{table.where()}: no {quote(name)}, found {listed}")


def _refuse_shared_columns(table: Table, channels: Mapping[str, Channel]) -> None:
    first_use: dict[str, str] = {}
    for name, channel in channels.items():
        for column in channel.columns:
            other = first_use.setdefault(column, name)
            if other != name:
                raise ExperimentError(
                    f"{table.where(name)}: found column {quote(column)}, which {other} uses"
                )
