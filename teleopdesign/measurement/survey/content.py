"""Results of a survey: columns of a log on one time grid, and the quantity that each may hold."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..encoder import Array, is_most
from ..first_guess import FirstGuess
from ..signed_numbers import SignCode

#: likeness of a name from which the name alone decides, without physics
SURE_NAME = 0.75
#: units of a sensor that a scope or an analog input has read, as the package writes them
OF_SENSORS = ("V", "mV")
#: rate that is assumed where nothing tells it, Hz: that of most controllers
ASSUMED = 1000.0
#: in place of a column's name: the log has none of that quantity
NONE = "none"


@dataclass(frozen=True)
class SurveyedColumn:
    """One column: `values` (n,) on the even grid of the survey; `readings` (m,) as written.

    code: how the log holds signed numbers, which are decoded here; None: as they are
    """

    name: str
    values: Array
    readings: Array
    unit: str | None
    code: SignCode | None = None


@dataclass
class Survey:
    """The proposed content of a log.

    axis: "prismatic" or "revolute";  channels: quantity -> table as in [channels]
    duration: of the whole log, s;  guesses: "channels.time.unit" -> reason
    time: (n,) s from the first row, of the part that was examined;  columns: by name, on this time
    first: values of a first model;  notes: remarks for the user
    explained: column that may be a force -> part of it that the motion explains (up to 1)
    unused: column that is in no channel -> reason;  unread: column without numbers -> reason
    remarks: lines of text above the table
    trials: where the second and later trials begin, s from the first row
    is_stated: whether the user states all columns, so that none is guessed
    relations: column that is no force beside the position -> what it is
    """

    axis: str
    channels: dict[str, dict[str, Any]]
    duration: float
    guesses: dict[str, str] = field(default_factory=dict)
    time: Array = field(default_factory=lambda: np.zeros(0))
    columns: dict[str, SurveyedColumn] = field(default_factory=dict)
    first: FirstGuess | None = None
    notes: list[str] = field(default_factory=list)
    explained: dict[str, float] = field(default_factory=dict)
    unused: dict[str, str] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()
    unread: dict[str, str] = field(default_factory=dict)
    trials: tuple[float, ...] = ()
    relations: dict[str, str] = field(default_factory=dict)
    is_stated: bool = False


@dataclass(frozen=True)
class Choices:
    """What the user states: columns, units, axis, constants; None: to be detected.

    interaction_force: "none" if the log has none;  units: column -> unit
    torque_constant: (value, unit);  lever_arm: (value, unit) of a force in N beside an angle
    gear_ratio: turns of the motor per turn of the joint
    counts_per_turn: of the encoder;  sample_rate: Hz
    """

    axis: str | None = None
    time: str | None = None
    position: str | None = None
    actuator_force: str | None = None
    interaction_force: str | None = None
    units: Mapping[str, str] = field(default_factory=dict)
    torque_constant: tuple[float, str] | None = None
    lever_arm: tuple[float, str] | None = None
    gear_ratio: float | None = None
    counts_per_turn: float | None = None
    sample_rate: float | None = None

    @property
    def states_all(self) -> bool:
        """Whether the user states each column that takes part in a comparison."""
        stated = (self.position, self.actuator_force, self.interaction_force)
        return None not in stated


def moves(column: SurveyedColumn) -> bool:
    return bool(np.ptp(column.values) > 0)


def columns_in_use(survey: Survey) -> set[str]:
    """The columns that are in a channel already, such as that which numbers trials."""
    return {entry["column"] for entry in survey.channels.values() if "column" in entry}


def rises(x: Array) -> bool:
    """Whether numbers grow from row to row, like those of a clock."""
    steps = np.diff(x[np.isfinite(x)])
    return len(steps) > 1 and float(np.mean(steps >= 0)) > 0.99 and is_most(steps > 0)


def sample_time_of(survey: Survey) -> float:
    """Time between two rows of the survey's grid, s."""
    return float(np.median(np.diff(survey.time)))
