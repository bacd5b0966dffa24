"""What a log seems to hold: which column is which quantity, in which unit, and what is a guess.

Names come first. Where they leave it open physics decides: a velocity is the derivative of a
position, a force is what inertia and friction of the motion ask for, and friction takes energy out,
which tells the sign. What rests on neither is said to be a guess.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import ExperimentError
from ..quantity import is_unit, measures, si_factor, unit_of
from .column_names import WANTED, is_wanted, likeness, unit_in_name, words_of
from .doors._log import Log, listed
from .encoder import reading_step
from .first_guess import FirstGuess, explain_force
from .tables import numbers_of
from .time_grid import clock_of

Array = NDArray[np.float64]

#: correlation from which one column is the derivative of another
DERIVATIVE = 0.9
#: part of the force that motion explains, from which physics says that a column is the force
DRIVES = 0.3
#: likeness of a name from which no physics is needed
SURE_NAME = 0.75
#: rows that are looked at
MOST = 60_000
#: part of a log that is fitted, where one log is all there is; the rest is the check record
FIT_PART = 0.6


@dataclass(frozen=True)
class SurveyedColumn:
    """One column on the even grid of the survey: `values` (n,); `readings` (m,) as written."""

    name: str
    values: Array
    readings: Array
    unit: str | None


@dataclass
class Survey:
    """What a log seems to hold.

    channels: quantity -> table as in [channels];  guesses: "channels.time.unit" -> why
    questions: what a person is asked: key -> (question, what is taken otherwise)
    time: (n,) s from the first row;  columns: by name, on it;  first: values of a first model
    """

    axis: str
    channels: dict[str, dict[str, Any]]
    duration: float
    guesses: dict[str, str] = field(default_factory=dict)
    time: Array = field(default_factory=lambda: np.zeros(0))
    columns: dict[str, SurveyedColumn] = field(default_factory=dict)
    first: FirstGuess | None = None
    notes: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Choices:
    """What the user says: columns, units, axis, constants; None: to be found.

    units: column -> unit;  torque_constant, gear_ratio: (value, unit)
    """

    axis: str | None = None
    time: str | None = None
    position: str | None = None
    actuator_force: str | None = None
    interaction_force: str | None = None
    units: Mapping[str, str] = field(default_factory=dict)
    torque_constant: tuple[float, str] | None = None
    gear_ratio: float | None = None
    counts_per_turn: float | None = None
    sample_rate: float | None = None


def survey_log(log: Log, file: str, choices: Choices) -> Survey:
    """Look at one log.

    raises ExperimentError: no position, no force among the columns, or a column that is not there
    """
    raw = _numeric(log, file)
    for key in ("time", "position", "actuator_force", "interaction_force"):
        name = getattr(choices, key)
        if name is not None and name not in raw:
            raise ExperimentError(f"{file}: {key}: no column {name!r}, found {listed(raw)}")
    guesses: dict[str, str] = {}
    time_name, unit = _time(raw, log, choices, guesses, file)
    time, columns = _on_one_grid(raw, log, time_name, unit, choices, file)
    survey = Survey("", {}, float(time[-1] - time[0]), guesses, time, columns)
    if time_name is not None:
        survey.channels["time"] = {"column": time_name, "unit": unit}
    else:
        survey.channels["sample_rate"] = {"value": choices.sample_rate or 1000.0, "unit": "Hz"}
    position, velocity = _position(survey, time_name, choices, file)
    survey.axis = _axis(survey, position, choices)
    _describe_position(survey, position, velocity, choices)
    _forces(survey, position, velocity, time_name, choices, file)
    return survey


def _numeric(log: Log, file: str) -> dict[str, Array]:
    """Columns that hold numbers or dates, by name."""
    raw: dict[str, Array] = {}
    for name in log.names:
        if log.names.count(name) > 1:
            continue
        try:
            values = numbers_of(log.read({name: ""})[name], name, file)
        except ExperimentError:
            continue
        if len(values) > 1 and np.isfinite(values).mean() > 0.5:
            raw[name] = values
    if not raw:
        raise ExperimentError(f"{file}: found no column of numbers among {listed(log.names)}")
    return raw


def _time(
    raw: Mapping[str, Array],
    log: Log,
    choices: Choices,
    guesses: dict[str, str],
    file: str,
) -> tuple[str | None, str]:
    """The column of time and its unit; None: there is none."""
    if choices.sample_rate is not None:
        return None, "s"
    rising = {n: x for n, x in raw.items() if _rises(x)}
    if choices.time is not None:
        name = choices.time
    elif log.clocks:
        name = _busiest_clock(log, raw, choices)
    else:
        scores = {n: likeness(n, "time") for n in rising}
        if not scores:
            guesses["sample_rate"] = "no column rises like a time: 1000 Hz is a guess"
            return None, "s"
        name = max(scores, key=lambda n: scores[n])
        if scores[name] == 0.0:
            name = next(iter(rising))
            guesses["channels.time.column"] = f"{name!r} is the first column that always rises"
    unit = choices.units.get(name) or log.units.get(name) or unit_in_name(name, "time")
    if unit is None or not measures(unit, "time"):
        unit, why = _time_unit(raw[name])
        if why:
            guesses["channels.time.unit"] = why
    return name, unit


def _busiest_clock(log: Log, raw: Mapping[str, Array], choices: Choices) -> str:
    """Of the clocks of a bag: that of the position."""
    if choices.position is not None:
        return log.clocks[choices.position]
    scores = {n: likeness(n.rpartition(".")[2], "position") - 0.6 * is_wanted(n) for n in raw}
    best = max(scores, key=lambda n: (scores[n], len(raw[n])))
    return log.clocks[best]


def _rises(x: Array) -> bool:
    steps = np.diff(x[np.isfinite(x)])
    return len(steps) > 1 and float(np.mean(steps >= 0)) > 0.99 and float(np.mean(steps > 0)) > 0.5


def _time_unit(stamps: Array) -> tuple[str, str]:
    """Unit of a time from its usual step, and why if it is a guess."""
    step = float(np.median(np.abs(np.diff(stamps[np.isfinite(stamps)]))))
    scales = ((0.2, "s"), (200.0, "ms"), (2e5, "us"), (math.inf, "ns"))
    unit = next(name for largest, name in scales if step < largest or largest == math.inf)
    if unit == "s" and step > 1e-5:
        return "s", ""
    return unit, f"steps of {step:.4g} are those of a log only in {unit}"


def _on_one_grid(
    raw: Mapping[str, Array],
    log: Log,
    time_name: str | None,
    unit: str,
    choices: Choices,
    file: str,
) -> tuple[Array, dict[str, SurveyedColumn]]:
    """All columns on one even grid, by straight lines: good enough to tell which is which."""
    if time_name is None:
        count = max(map(len, raw.values()))
        stamps = np.arange(count) / (choices.sample_rate or 1000.0)
    else:
        stamps = raw[time_name] * si_factor(unit, quantity="time")
    beside_time = {n: x for n, x in raw.items() if len(x) == len(stamps)}
    rows = np.flatnonzero(np.isfinite(stamps))[:MOST]
    origin = stamps[rows[0]]
    clock = clock_of(
        stamps[rows] - origin, (slice(0, len(rows)),), np.zeros(len(rows), dtype=bool), file
    )
    used = rows[clock.rows]
    columns: dict[str, SurveyedColumn] = {}
    for name, values in raw.items():
        if name == time_name:
            continue
        clock_name = log.clocks.get(name)
        at, x = clock.time[clock.places], values
        if clock_name is not None and clock_name != time_name and name not in log.clocks.values():
            at = raw[clock_name] - origin
        elif name in beside_time:
            x = values[used]
        else:
            continue
        fine = np.isfinite(x) & np.isfinite(at)
        if fine.sum() < 2:
            continue
        said = choices.units.get(name) or log.units.get(name) or unit_in_name(name)
        columns[name] = SurveyedColumn(
            name, np.interp(clock.time, at[fine], x[fine]), x[fine], said
        )
    return clock.time, columns


def _step(survey: Survey) -> float:
    return float(np.median(np.diff(survey.time)))


def unwrapped(x: Array, jump: float | None) -> Array:
    """A column without its wraps."""
    return x if jump is None else np.asarray(np.unwrap(x, period=jump))


def wrap_of(x: Array) -> float | None:
    """Period at which a column wraps: that of jumps over most of its range; None: it does not."""
    reach = float(np.ptp(x))
    steps = np.diff(x)
    usual = float(np.quantile(np.abs(steps), 0.95))
    jumps = np.abs(steps[np.abs(steps) > max(0.6 * reach, 20.0 * usual)])
    if len(jumps) == 0 or reach == 0.0:
        return None
    jump = float(np.median(jumps))
    if np.any(np.abs(jumps - jump) > 0.1 * jump):
        return None
    for period in (360.0, 2 * math.pi, 1.0, 400.0, *(2.0**k for k in range(8, 33))):
        if abs(period - jump) < 0.1 * period and reach <= 1.001 * period:
            return period
    return None


def derivative_factor(x: Array, v: Array, sample_time: float) -> tuple[float, float]:
    """Factor and correlation of one column with the derivative of another."""
    from .filtering import spectrum

    s = spectrum(len(x), sample_time)
    low = s.lowpass(min(0.02 / sample_time, 20.0))
    rate = s.back(s.transform(x) * low * s.derivative(1))
    slow = s.multiply(v, low)
    inner = slice(len(x) // 50 + 1, -len(x) // 50 - 1)
    a, b = rate[inner] - rate[inner].mean(), slow[inner] - slow[inner].mean()
    power = float(a @ a)
    if power <= 0 or float(b @ b) <= 0:
        return 0.0, 0.0
    return float(a @ b) / power, float(a @ b) / math.sqrt(power * float(b @ b))


def _moves(column: SurveyedColumn) -> bool:
    return bool(np.ptp(column.values) > 0)


def _position(
    survey: Survey, time_name: str | None, choices: Choices, file: str
) -> tuple[str, str | None]:
    """The column of the position, and that of its velocity if there is one."""
    h = _step(survey)
    moving = {n: c for n, c in survey.columns.items() if _moves(c) and not _rises(c.values)}
    flat = {n: unwrapped(c.values, wrap_of(c.values)) for n, c in moving.items()}
    derivative: dict[str, tuple[str, float]] = {}
    scores: dict[str, float] = {}
    for name, column in moving.items():
        score = likeness(name, "position") - 0.8 * is_wanted(name)
        kinds = [q for q in ("position", "velocity", "force") if _is_of(column.unit, q)]
        score += 0.5 * ("position" in kinds) - 0.8 * bool(kinds and "position" not in kinds)
        score -= 0.4 * max(likeness(name, "velocity"), likeness(name, "actuator_force"))
        for other, column_2 in moving.items():
            if other == name or (_is_of(column_2.unit, "force") and column_2.unit):
                continue
            _, agree = derivative_factor(flat[name], column_2.values, h)
            if agree > max(DERIVATIVE, derivative.get(name, ("", 0.0))[1]):
                derivative[name] = (other, agree)
        scores[name] = score + 0.4 * (name in derivative)
    if choices.position is not None:
        best = choices.position
    elif scores:
        best = max(scores, key=lambda n: scores[n])
    else:
        raise ExperimentError(f"{file}: found no column that moves among {listed(survey.columns)}")
    if choices.position is None and likeness(best, "position") < SURE_NAME:
        why = "its derivative is there too" if best in derivative else "by its name and unit"
        survey.guesses["channels.position.column"] = f"{best!r} is taken for the position: {why}"
    velocity = derivative.get(best, (None, 0.0))[0]
    if velocity is not None:
        survey.notes.append(f"{velocity!r} is the derivative of {best!r}")
    return best, velocity


def _is_of(unit: str | None, quantity: str) -> bool:
    if unit is None:
        return False
    if unit == "counts":
        return quantity == "position"
    if quantity == "force" and is_unit(unit) and unit in ("A", "mA", "V", "%"):
        return True
    return any(measures(unit, quantity, axis) for axis in ("prismatic", "revolute"))


def _axis(survey: Survey, position: str, choices: Choices) -> str:
    if choices.axis is not None:
        return choices.axis
    unit = choices.units.get(position) or survey.columns[position].unit
    if unit is not None and unit != "counts":
        for axis in ("prismatic", "revolute"):
            if measures(unit, "position", axis):
                return axis
    units = [c.unit for c in survey.columns.values() if c.unit]
    if "N" in units or any(measures(u, "position") for u in units if u != "counts"):
        why, axis = "forces are in N", "prismatic"
    else:
        words = words_of(position)
        turning = {"q", "angle", "winkel", "theta", "phi", "enc", "encoder", "joint"} & set(words)
        axis = "revolute" if turning or unit == "counts" or "A" in units else "prismatic"
        why = f"the position is called {position!r}"
    survey.guesses["model.device.axis"] = f'"{axis}": {why}'
    return axis


def _describe_position(
    survey: Survey, position: str, velocity: str | None, choices: Choices
) -> None:
    """Unit, wrap and resolution of the position, and the velocity beside it."""
    column, axis = survey.columns[position], survey.axis
    entry: dict[str, Any] = {"column": position}
    unit = choices.units.get(position) or column.unit
    if unit == "counts" or unit is None and choices.counts_per_turn is not None:
        unit = "counts"
    if unit is None or unit != "counts" and not measures(unit, "position", axis):
        unit, why = _position_unit(survey, column, velocity, axis)
        survey.guesses["channels.position.unit"] = why
    entry["unit"] = unit
    jump = wrap_of(column.values)
    factor = 1.0
    if unit == "counts":
        per_turn = choices.counts_per_turn
        if per_turn is None:
            per_turn = jump or 4096.0
            survey.guesses["channels.position.counts_per_turn"] = (
                f"{per_turn:g} counts a turn: look at the encoder"
            )
        entry["counts_per_turn"] = per_turn
    else:
        factor = si_factor(unit, quantity="position", axis=axis)
        step = _seen_step(column.readings)
        if step > 0:
            entry["resolution"] = float(f"{step:.5g}")
            survey.notes.append(f"{position!r} moves in steps of {step:.4g} {unit}")
    if jump is not None:
        turn = 2 * math.pi / factor
        whole = axis == "revolute" and unit != "counts" and abs(jump - turn) < 1e-3 * turn
        entry["unwrap"] = True if whole else jump
        survey.notes.append(f"{position!r} wraps at {jump:g}")
    if choices.gear_ratio is not None:
        entry["gear_ratio"] = choices.gear_ratio
    survey.channels["position"] = entry
    if velocity is not None:
        said = choices.units.get(velocity) or survey.columns[velocity].unit
        if said is not None and measures(said, "velocity", axis):
            more = {} if choices.gear_ratio is None else {"gear_ratio": choices.gear_ratio}
            survey.channels["velocity"] = {"column": velocity, "unit": said, **more}


def _seen_step(values: Array) -> float:
    """Step of an encoder that the readings show; 0 where they are too fine to show one."""
    raw = values[:20_000]
    some = raw[np.r_[True, np.diff(raw) != 0]]
    step = reading_step(raw)
    if step <= 0 or len(some) < 10:
        return 0.0
    places = (raw - raw[0]) / step
    on = np.abs(np.exp(2j * np.pi * places).mean())
    return step if on > 0.9 and np.ptp(raw) > 20 * step else 0.0


def _position_unit(
    survey: Survey, column: SurveyedColumn, velocity: str | None, axis: str
) -> tuple[str, str]:
    """A unit where the name says none: from the velocity's, or from the range."""
    whole = unwrapped(column.values, wrap_of(column.values))
    reach = float(np.ptp(whole))
    if velocity is not None and (said := survey.columns[velocity].unit):
        factor, _ = derivative_factor(whole, survey.columns[velocity].values, _step(survey))
        scale = (
            factor * si_factor(said, quantity="velocity", axis=axis)
            if _is_of(said, "velocity") and measures(said, "velocity", axis)
            else 0.0
        )
        for unit in ("deg", "rad", "turns") if axis == "revolute" else ("mm", "m", "um"):
            if abs(scale / si_factor(unit, quantity="position", axis=axis) - 1.0) < 0.05:
                return unit, f"{unit}: then it agrees with {velocity!r} in {said}"
    if axis == "revolute":
        unit = "deg" if reach > 50 else "rad"
    else:
        unit = "mm" if reach > 3 else "m"
    return unit, f"{unit}, from its range of {reach:.3g}: its name says no unit"


def _forces(
    survey: Survey,
    position: str,
    velocity: str | None,
    time_name: str | None,
    choices: Choices,
    file: str,
) -> None:
    """The force that is commanded, the force that is measured, their units and signs."""
    h = _step(survey)
    entry = survey.channels["position"]
    x = unwrapped(survey.columns[position].values, wrap_of(survey.columns[position].values))
    used = {position, velocity, time_name}
    free = {
        n: c
        for n, c in survey.columns.items()
        if n not in used and _moves(c) and not _rises(c.values)
    }
    free = {
        n: c
        for n, c in free.items()
        if not c.unit or _is_of(c.unit, "force") or not is_unit(c.unit)
    }
    physics = {n: explain_force(c.values, x, h) for n, c in free.items()}
    scores = {n: _force_score(c, physics[n]) for n, c in free.items()}
    if choices.actuator_force is not None:
        force = choices.actuator_force
    elif scores:
        force = max(scores, key=lambda n: scores[n])
    else:
        raise ExperimentError(
            f"{file}: found no column that could be a force beside {position!r}, "
            f"found {listed(survey.columns)}"
        )
    if choices.actuator_force is None and likeness(force, "actuator_force") < SURE_NAME:
        share = physics[force].explained
        survey.guesses["channels.actuator_force.column"] = (
            f"{force!r} is taken for the actuator's force: the motion explains {share:.0%} of it"
        )
    hand = _hand(free, force, choices)
    survey.channels["actuator_force"] = _force_entry(survey, force, "actuator_force", choices)
    if hand is not None:
        survey.channels["interaction_force"] = _force_entry(
            survey, hand, "interaction_force", choices
        )
    _signs(survey, x, h, force, hand)
    if entry.get("gear_ratio") is not None:
        survey.channels["actuator_force"]["gear_ratio"] = entry["gear_ratio"]


def _force_score(column: SurveyedColumn, guess: FirstGuess) -> float:
    score = likeness(column.name, "actuator_force") + max(guess.explained, 0.0)
    score -= 0.7 * (likeness(column.name, "interaction_force") >= SURE_NAME)
    # the command is wanted, not what a drive says that it reached
    wanted_words = set(words_of(column.name)) & set(WANTED)
    score += 0.3 * bool(wanted_words) + 0.5 * _is_of(column.unit, "force")
    return score - 0.6 * (likeness(column.name, "position") >= SURE_NAME)


def _hand(free: Mapping[str, SurveyedColumn], force: str, choices: Choices) -> str | None:
    if choices.interaction_force is not None:
        return choices.interaction_force
    scores = {n: likeness(n, "interaction_force") for n in free if n != force}
    best = max(scores, key=lambda n: scores[n], default=None)
    return best if best is not None and scores[best] >= SURE_NAME else None


def _force_entry(survey: Survey, name: str, key: str, choices: Choices) -> dict[str, Any]:
    """A force with its unit, and the constant that a current needs."""
    axis = survey.axis
    unit = choices.units.get(name) or survey.columns[name].unit
    entry: dict[str, Any] = {"column": name}
    if unit is None and choices.torque_constant is not None and key == "actuator_force":
        unit = choices.torque_constant[1].rpartition("/")[2]
    if unit in ("A", "mA", "V"):
        entry["unit"] = unit
        base = "V" if unit == "V" else "A"
        constant = choices.torque_constant
        if constant is None:
            constant = (1.0, f"{unit_of('force', axis)}/{base}")
            survey.guesses[f"channels.{key}.torque_constant"] = (
                f"1 {constant[1]} stands for the motor's constant: fill it in, forces and "
                "parameters follow in proportion"
            )
        entry["torque_constant"] = {"value": constant[0], "unit": constant[1]}
        return entry
    if unit is None or not measures(unit, "force", axis):
        unit = unit_of("force", axis)
        survey.guesses[f"channels.{key}.unit"] = f"{unit}: the name {name!r} says no unit"
    return {**entry, "unit": unit}


def _signs(survey: Survey, x: Array, h: float, force: str, hand: str | None) -> None:
    """Friction takes energy out and inertia is positive: what drives instead has the other sign."""
    position = survey.channels["position"]
    unit = position["unit"]
    scale = 1.0
    if unit == "counts":
        scale = 2 * math.pi / float(position["counts_per_turn"])
    else:
        scale = si_factor(unit, quantity="position", axis=survey.axis)
    scale /= float(position.get("gear_ratio", 1.0))
    u = survey.columns[force].values * _to_si(survey, "actuator_force")
    whole = explain_force(u, x * scale, h)
    with_hand = whole
    if hand is not None:
        f = survey.columns[hand].values * _to_si(survey, "interaction_force")
        by_sign = {s: explain_force(u + s * f, x * scale, h) for s in (1.0, -1.0)}
        better = max(by_sign, key=lambda s: by_sign[s].explained)
        if better < 0 and by_sign[-1.0].explained > by_sign[1.0].explained + 0.05:
            survey.channels["interaction_force"]["sign"] = -1
            survey.guesses["channels.interaction_force.sign"] = (
                f"-1: {hand!r} then balances with {force!r}, which leaves "
                f"{1 - by_sign[-1.0].explained:.0%} of the force instead of "
                f"{1 - by_sign[1.0].explained:.0%}"
            )
        else:
            better = 1.0
        with_hand = by_sign[better]
    turned = with_hand.inertia < -3.0 * with_hand.errors[0] or (
        abs(with_hand.inertia) < 3.0 * with_hand.errors[0] and with_hand.level < 0
    )
    if turned and with_hand.explained > DRIVES:
        survey.channels["position"]["sign"] = -1
        if "velocity" in survey.channels:
            survey.channels["velocity"]["sign"] = -1
        survey.guesses["channels.position.sign"] = (
            "-1: as logged, friction would drive the motion and inertia be negative"
        )
        with_hand = FirstGuess(
            -with_hand.inertia,
            -with_hand.level,
            -with_hand.damping,
            with_hand.explained,
            with_hand.errors,
        )
    survey.first = with_hand
    ratio = float(position.get("gear_ratio", 1.0))
    if ratio != 1.0:
        survey.notes.append(f"forces and positions are those behind the gear of {ratio:g}")


def _to_si(survey: Survey, key: str) -> float:
    """Factor of a force from its column to SI, as proposed."""
    from .conversion import conversion_of
    from .toml_table import Table

    entry = survey.channels[key]
    if key == "actuator_force" and "gear_ratio" in survey.channels["position"]:
        entry = {**entry, "gear_ratio": survey.channels["position"]["gear_ratio"]}
    conversion, _ = conversion_of(
        Table(entry, "log"), quantity=key, kind="force", axis=survey.axis, unit=entry["unit"]
    )
    return conversion.factor


def spans_of(duration: float) -> tuple[tuple[float, float], tuple[float, float]]:
    """(begin, end) in s of the fit record and of the check record in one log."""
    cut = float(f"{FIT_PART * duration:.4g}")
    return (0.0, cut), (cut, math.ceil(duration + 1.0))


def same_columns(logs: Sequence[Log], files: Sequence[str]) -> None:
    """Raise an ExperimentError where a later log lacks a column of the first."""
    for log, file in zip(logs[1:], files[1:], strict=True):
        missing = [n for n in logs[0].names if n not in log.names]
        if missing:
            raise ExperimentError(f"{file}: has no column {missing[0]!r}, which {files[0]} has")
