"""What a survey knows: columns on one time grid, lines above the table, what the user states.

Lines may state constants: "8192 counts per turn", "kt = 0.1 Nm/A".
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ...base.errors import ExperimentError, quote
from ...base.units import is_unit, measures, si_factor
from ..column_names import unit_of_text
from ..doors._cells import holds_dates, number_of, numbers_of
from ..doors._log import Log, bare_column, join_names
from ..encoder import Array, SignCode, is_most
from ..first_guess import FirstGuess
from ..log_clock import OF_ANOTHER_CLOCK

_TURN = r"(?:turn|rev|revolution|umdrehung|tour|u\b)"
_COUNTS = r"(?:counts?|cnts?|ticks?|increments?|inkremente|ink|inc|pulses|impulse|cpr)"
#: texts that state counts per turn: a number before or after the words
_COUNTS_PER_TURN = (
    re.compile(rf"(\d{{2,9}})\s*{_COUNTS}\s*(?:/|per|pro|par)\s*{_TURN}", re.I),
    re.compile(rf"{_COUNTS}[ _]*(?:/|per|pro|par)[ _]*{_TURN}\w*\s*[=:]?\s*(\d{{2,9}})", re.I),
    re.compile(r"\bcpr\s*[=:]?\s*(\d{2,9})|\b(\d{2,9})\s*cpr\b", re.I),
)
_TORQUE_CONSTANT = re.compile(
    r"(?:\bk_?[tm]\b|torque[ _]constant|drehmomentkonstante|constante de couple)\D{0,12}?"
    r"(\d{1,9}(?:[.,]\d{1,9})?(?:e[-+]?\d{1,3})?)\s*([A-Za-z][A-Za-z*·⋅. -]{0,10})/\s*(m?A)\b",
    re.I,
)
#: "gear 50:1", "gear ratio = 50", "Getriebe i = 100"
_GEAR_RATIO = re.compile(
    r"(?:\bgear(?:box)?(?:[ _]?ratio)?\b|\bgetriebe\w*|\breduction\b|\buntersetzung\b)\D{0,12}?"
    r"(\d{1,5}(?:[.,]\d{1,6})?)(?:\s*:\s*1\b)?(?!\s*[:\d]|-)",
    re.I,
)
_RATE_NUMBER = r"([\d.,]{1,20}(?:e[-+]?\d{1,3})?)"
#: "Sample rate: 1000 Hz", "Delta_X 0,001", "Sample Interval,0.001", "tInc = 1e-3"
_SAMPLE_RATE = re.compile(
    r"(?:sampl(?:e|ing)[ _]?(?:rate|frequency)|abtastrate|(?<![a-z])f_?s(?![a-z]))[^\w+-]{1,12}"
    rf"{_RATE_NUMBER}\s*([kM]?Hz|)(?![A-Za-z:/\d-])",
    re.I,
)
_SAMPLE_TIME = re.compile(
    r"(?:sampl(?:e|ing)[ _]?(?:interval|time|period)|delta[ _]?[xt]|t_?inc|abtastzeit"
    r"|(?<![a-z])(?:t_?s|dt)(?![a-z])|^[Th](?= = [\d.e-]+$))"
    rf"(?:\s*[(\[]([mun]?s)[)\]])?[^\w+-]{{1,12}}{_RATE_NUMBER}\s*([mun]?s|)(?![A-Za-z:/\d-])",
    re.I,
)
#: units that are recognised whatever their case, where no other unit is meant by these letters
_UNITS = {"hz": "Hz", "khz": "kHz", "mhz": "MHz"}

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


def sample_rate_in(remarks: Sequence[str]) -> tuple[float, str] | None:
    """The rate of the rows in Hz, and the line that states it or the time from row to row, in s.

    A scope writes the time from row to row beside its table: "X, CH1, Start, Increment".
    """
    for line in remarks:
        rate, step = (pattern.search(line[:500]) for pattern in (_SAMPLE_RATE, _SAMPLE_TIME))
        if rate is not None and (value := _size(rate[1], rate[2] or "Hz", "frequency")):
            return value, line[:100]
        if step is not None and (value := _size(step[2], step[1] or step[3] or "s", "time")):
            return float(f"{1 / value:.9g}"), line[:100]
    for titles, values in itertools.pairwise(remarks):
        cells = [re.split(r"[,;\t]", text[:500]) for text in (titles, values)]
        for title, cell in zip(*cells, strict=False):
            if title.strip().casefold() == "increment" and (value := _size(cell.strip())):
                return float(f"{1 / value:.9g}"), f"{titles[:50]} / {values[:50]}"
    return None


def _size(text: str, unit: str = "s", quantity: str = "time") -> float:
    """A number with a decimal point or comma, in SI; 0: it is none.

    unit: as a program writes it, also "HZ" or "khz"
    """
    number = number_of(text.rstrip(".,"), comma="," in text)
    known = unit_of_text(unit) or unit_of_text(unit.lower()) or _UNITS.get(unit.lower(), unit)
    if not isinstance(number, float) or not measures(known, quantity):
        return 0.0
    return number * si_factor(known, quantity=quantity)


def counts_per_turn_in(remarks: Sequence[str]) -> tuple[float, str] | None:
    """Counts of an encoder per turn, and the line that states them."""
    for line in remarks:
        for pattern in _COUNTS_PER_TURN:
            if (match := pattern.search(line[:500])) is not None:
                return float(next(filter(None, match.groups()))), line[:100]
    return None


def torque_constant_in(remarks: Sequence[str]) -> tuple[float, str, str] | None:
    """A motor constant, its unit, and the line that states it."""
    for line in remarks:
        if (match := _TORQUE_CONSTANT.search(line[:500])) is None:
            continue
        unit = f"{unit_of_text(match[2]) or match[2].strip()}/{match[3]}"
        if is_unit(unit):
            return float(match[1].replace(",", ".")), unit, line[:100]
    return None


def gear_ratio_in(remarks: Sequence[str]) -> tuple[float, str] | None:
    """Turns of the motor per turn of the joint, and the line that states the ratio."""
    for line in remarks:
        if (match := _GEAR_RATIO.search(line[:500])) is not None:
            return float(match[1].replace(",", ".")), line[:100].lstrip("#%; ")
    return None


#: what a log may state of its clock and of the machine: its lines -> values, then the line
STATEMENTS = (sample_rate_in, counts_per_turn_in, torque_constant_in, gear_ratio_in)


def numeric_columns(log: Log, file: str) -> tuple[dict[str, Array], dict[str, str], Log]:
    """Columns of numbers or dates, by name; and the reason why each other column has none.

    returns: also the log with the unit of dates, and with single values ("gear = 30") as remarks
    """
    dated: list[str] = []
    remarks: list[str] = []
    raw: dict[str, Array] = {}
    unread: dict[str, str] = {}
    single = [name for name in log.names if log.names.count(name) == 1]
    try:
        # a text file is then read once, not once for each column
        together = log.read(dict.fromkeys(single, ""))
    except ExperimentError:
        together = {}
    for name in single:
        try:
            cells = together[name] if name in together else log.read({name: ""})[name]
            values = numbers_of(cells, name, file)
        except ExperimentError as problem:
            why = str(problem).removeprefix(f"{file}: ").removeprefix("column ")
            unread[name] = why.removeprefix(quote(name)).lstrip(":, ")
            continue
        filled = np.isfinite(values)
        if len(values) > 1 and is_most(filled):
            raw[name] = values
            dated += [name] if holds_dates(cells) else []
        elif len(values) == 1:
            unread[name] = f"one value: {values[0]:g}"
            remarks.append(f"{bare_column(name)} = {values[0]:g}")
        else:
            finite = float(filled.mean()) if len(values) else 0.0
            more = f": {OF_ANOTHER_CLOCK}" if finite > 0 else ""
            unread[name] = f"numbers in {finite:.0%} of its rows{more}"
    if not raw or log.clocks and not log.clocks.keys() & raw.keys():  # or clocks alone
        whys = set(unread.values())
        if len(whys) == 1 and "found" in (why := whys.pop()):  # the same row of all columns
            raise ExperimentError(f"{file}: {why}")
        raise ExperimentError(
            f"{file}: found no column of numbers among {join_names(log.names)}{reasons(unread)}"
        )
    units = {**log.units, **dict.fromkeys(dated, "s")}
    return raw, unread, replace(log, units=units, remarks=(*log.remarks, *remarks))


def reasons(unread: Mapping[str, str], most: int = 3) -> str:
    """Why columns of a log hold no numbers, as the end of a message; "" if all hold numbers."""
    shown = [f"{name!r}: {why}" for name, why in list(unread.items())[:most]]
    more = ["..."] if len(unread) > most else []
    return f"; not read as numbers: {'; '.join(shown + more)}" if unread else ""
