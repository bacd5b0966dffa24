"""From the columns of a log to a signal in SI: scale, offset, sign, wraps, gears, currents, counts.

    signal = sign * unit * (torque constant) * (lever arm) * (gear ratio)^(+-1)
             * (sum of scale * column + offset)

A column of counts that hold a sign is decoded first. A column that wraps (an angle within one turn,
a counter) is unwrapped then. `gear_ratio` is the number of motor turns per turn of the joint: a
position or velocity read at the motor is divided by the ratio, a force at the motor is multiplied
by it. On a prismatic axis the ratio has a unit, `{ value = 1.257, unit = "rad/mm" }`. On a revolute
axis a force in N acts at a `lever_arm`, such as a handle at `{ value = 70, unit = "mm" }` from it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..base.errors import ExperimentError, quote
from ..base.toml import Table
from ..base.units import converting_factor, is_unit, measures, si_factor, to_si
from .encoder import SIGN_BIT, TWOS_COMPLEMENT, Array, SignCode, sign_code_from

#: words for the steps of a counter
COUNTS = ("counts", "count", "ticks", "increments")
#: s, longest delay of a channel: what the comparison trims at the ends of a record
LONGEST_DELAY = 0.2
#: keys of a channel that say how its column becomes a signal
KEYS = (
    "scale", "offset", "sign", "unwrap", "torque_constant", "lever_arm", "gear_ratio", "count",
    "counts_per_turn", "delay", TWOS_COMPLEMENT, SIGN_BIT,
)  # fmt: skip
#: key -> kinds of quantities, and these in words; unit that is required; whether it is above 0
_CONSTANTS = {
    "torque_constant": (("force",), "a force", "N*m/A", False),
    "lever_arm": (("force",), "a force of a revolute axis", "m", True),
    "gear_ratio": (
        ("force", "position", "velocity"),
        "a position, a velocity or a force",
        "",
        True,
    ),
}


@dataclass(frozen=True)
class Conversion:
    """How columns become one signal.

    columns: names of the columns that are summed;  scales: factor of each column
    offset: added to the sum, in the unit of the column
    factor: from the sum to SI, with sign, gear ratio and torque constant
    period: of a wrap, in the unit of the column; 0: the column does not wrap
    delay: of the signal in the log, s; positive if the log has the signal late
    code: how the columns hold signed numbers; None: as they are
    """

    columns: tuple[str, ...]
    scales: tuple[float, ...]
    offset: float = 0.0
    factor: float = 1.0
    period: float = 0.0
    delay: float = 0.0
    code: SignCode | None = None

    def signal(self, columns: Mapping[str, Array]) -> Array:
        """The signal (n,) in SI."""
        names = self.columns or tuple(columns)
        is_one = len(names) == 1 and self.scales == (1.0,) and self.offset == self.period == 0.0
        if is_one and self.code is None:  # a sum would lose the sign of a zero
            return columns[names[0]] * self.factor
        total = np.full(len(columns[names[0]]), self.offset)
        for name, scale in zip(names, self.scales, strict=True):
            total += scale * self._unwrap(columns[name])
        return total * self.factor

    def wraps(self, columns: Mapping[str, Array]) -> int:
        """How many times the columns wrap."""
        if self.period == 0.0:
            return 0
        half = 0.5 * self.period
        decoded = (self._decode(columns[n]) for n in self.columns)
        return sum(int(np.sum(np.abs(np.diff(column)) > half)) for column in decoded)

    def refuse_other_counts(self, columns: Mapping[str, Array], where: str) -> None:
        """Raise an ExperimentError for a reading that the code of signed numbers does not have."""
        if self.code is not None:
            for name in self.columns:
                self.code.refuse_other_counts(columns[name], where)

    def _decode(self, column: Array) -> Array:
        return column if self.code is None else self.code.decode(column)

    def _unwrap(self, column: Array) -> Array:
        column = self._decode(column)
        if self.period == 0.0:
            return column
        return np.asarray(np.unwrap(column, period=self.period), dtype=np.float64)


#: of one column, whatever its name, in SI
AS_WRITTEN = Conversion((), (1.0,))


def conversion_of(
    table: Table, *, quantity: str, kind: str, axis: str, unit: str
) -> tuple[Conversion, float | None]:
    """The conversion that a channel's table describes, and the size of one count (SI) or None.

    quantity: of the channel ("position", "actuator_force");  kind: of quantity in the table of
        units
    raises ExperimentError: keys that do not suit each other, units that do not fit
    """
    columns = _columns(table)
    scales = _scales(table, len(columns))
    sign = _sign(table)
    constant, names = _constants(table, quantity=quantity, kind=kind, axis=axis)
    base, per_count = _unit_of_count(table, unit, kind=kind, axis=axis)
    where = table.where("unit")
    if names:
        factor = converting_factor(base, "*".join(names), quantity=kind, axis=axis, where=where)
    else:
        factor = _without_constant(base, kind, axis, where)
    factor *= sign * constant * per_count
    period = _period(table, unit, kind=kind, axis=axis, scales=scales)
    offset = table.number_or_none("offset") or 0.0
    code = sign_code_from(table)
    conversion = Conversion(columns, scales, offset, factor, period, _delay(table), code)
    counts = unit in COUNTS
    return conversion, abs(factor) * max(map(abs, scales)) if counts else None


def _force(axis: str) -> str:
    return "N" if axis == "prismatic" else "N*m"


def _columns(table: Table) -> tuple[str, ...]:
    value = table.content.get("column")
    if isinstance(value, list):
        if not value or not all(isinstance(v, str) and v.strip() for v in value):
            raise table.error("column", "names of columns")
        if len(set(value)) < len(value):
            raise ExperimentError(f"{table.where('column')}: found a column twice")
        return tuple(value)
    return (table.text("column"),)


def _scales(table: Table, count: int) -> tuple[float, ...]:
    value = table.content.get("scale", 1.0)
    listed = value if isinstance(value, list) else [value] * count
    numbers = [v for v in listed if isinstance(v, int | float) and not isinstance(v, bool)]
    if len(numbers) != len(listed) or not all(math.isfinite(v) and v != 0 for v in numbers):
        raise table.error("scale", "a number other than 0" + ", or a list of them" * (count > 1))
    if len(listed) != count:
        raise table.error("scale", f"{count}, one a column", f"{len(listed)} numbers")
    return tuple(float(v) for v in numbers)


def _sign(table: Table) -> float:
    sign = table.number_or_none("sign")
    if sign not in (None, 1.0, -1.0):
        raise table.error("sign", "1 or -1", f"{sign:g}")
    return 1.0 if sign is None else sign


def _constants(table: Table, *, quantity: str, kind: str, axis: str) -> tuple[float, list[str]]:
    """The product of motor constant, lever arm and gear ratio, and the units of its factors.

    A ratio divides a motion, and multiplies a force.
    """
    product, units = 1.0, list[str]()
    for key, (kinds, words, example, is_positive) in _CONSTANTS.items():
        if key not in table.content:
            continue
        where, unit = table.where(key), ""
        if kind not in kinds or key == "lever_arm" and axis != "revolute":
            on = f"{quote(quantity)} of a {axis} axis"
            raise ExperimentError(f"{where}: found on {on}, expected on {words}")
        if isinstance(table.content[key], dict):
            entry = table.table(key)
            entry.allow(("value", "unit"))
            value, unit = entry.number("value"), entry.text("unit", "")
        else:
            value = table.number(key)
        if example and not unit:
            example = f"{_force(axis)}/A" if key == "torque_constant" else example
            raise ExperimentError(
                f"{where}: no unit, expected {{ value = ..., unit = {quote(example)} }}"
            )
        if value == 0 or is_positive and value < 0:
            expected = "a number above 0; sign = -1 turns it" if is_positive else "another number"
            raise ExperimentError(f"{where}: found {value:g}, expected {expected}")
        is_inverse = key == "gear_ratio" and kind != "force"
        product = product / value if is_inverse else product * value
        if unit:
            units.append(f"(1/({unit}))" if is_inverse else f"({unit})")
    return product, units


def _unit_of_count(table: Table, unit: str, *, kind: str, axis: str) -> tuple[str, float]:
    """Unit of one count and its size in that unit; for a unit other than counts, the unit and 1."""
    keys = [key for key in ("count", "counts_per_turn") if key in table.content]
    if unit not in COUNTS:
        if keys:
            raise table.error(keys[0], f"unit {quote(COUNTS[0])}", f"with unit {quote(unit)}")
        return unit, 1.0
    if len(keys) != 1:
        raise ExperimentError(
            f'{table.where("unit")}: found "{unit}", expected beside it counts_per_turn = 4096, or '
            'count = { value = 0.5, unit = "um" }: what one count is'
        )
    if keys == ["counts_per_turn"]:
        return "turns", 1.0 / table.number("counts_per_turn", above=0)
    entry = table.table("count")
    entry.allow(("value", "unit"))
    return entry.text("unit"), entry.number("value", above=0)


def _without_constant(unit: str, kind: str, axis: str, where: str) -> float:
    try:
        return si_factor(unit, quantity=kind, axis=axis, where=where)
    except ExperimentError as problem:
        if kind == "force" and unit in ("A", "mA"):
            raise ExperimentError(
                f"{where}: found {quote(unit)}, expected beside a current "
                f'torque_constant = {{ value = ..., unit = "{_force(axis)}/A" }} of the motor'
            ) from None
        if kind == "force" and axis == "revolute" and is_unit(unit) and measures(unit, "force"):
            raise ExperimentError(
                f"{where}: found {quote(unit)}, expected a torque, or beside a force "
                'lever_arm = { value = ..., unit = "m" }: its distance from the axis'
            ) from None
        raise problem


def _period(table: Table, unit: str, *, kind: str, axis: str, scales: Sequence[float]) -> float:
    """Period of a wrap in the unit of the column; 0 where the column does not wrap."""
    value = table.content.get("unwrap", False)
    if value is False:
        return 0.0
    where = table.where("unwrap")
    if kind != "position":
        raise ExperimentError(f"{where}: found on a {kind}, expected on a position")
    if value is not True:
        return table.number("unwrap", above=0)
    if unit in COUNTS:
        if "counts_per_turn" in table.content:
            return table.number("counts_per_turn")
        raise ExperimentError(f"{where}: found true with counts, expected where the counter wraps")
    try:  # an angle wraps at one turn of the shaft with the encoder
        turn = to_si(1.0, "turn", quantity="angle") / si_factor(unit, quantity="angle")
    except ExperimentError:
        raise ExperimentError(
            f"{where}: found true with unit {quote(unit)}, expected the length at which it wraps"
        ) from None
    return turn / abs(scales[0])


def _delay(table: Table) -> float:
    delay = si_from(table, "delay", "time") if "delay" in table.content else 0.0
    if abs(delay) > LONGEST_DELAY:
        raise table.error("delay", f"at most {LONGEST_DELAY:g} s", f"{delay:g} s")
    return delay


def si_from(table: Table, key: str, quantity: str, *, above: float = -math.inf) -> float:
    """Read { value, unit } under `key` in SI;  above: bound of the value."""
    entry = table.table(key)
    entry.allow(("value", "unit"))
    value, where = entry.number("value", above=above), entry.where("unit")
    return to_si(value, entry.text("unit"), quantity=quantity, where=where)
