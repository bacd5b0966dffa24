"""One force of a log as an entry of experiment.toml: unit, motor constant or lever arm, and noise.

With a stated step of the position and no stated noise, a diagnosis takes the steps of the encoder
for the only error of the readings. A motor current scatters as well, and this scatter is no missing
effect. A command scatters, too, but its scatter acts on the body.
"""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np

from ...base.errors import ExperimentError
from ...base.sentences import with_standard_error
from ...base.toml import Table
from ...base.units import is_unit, measures, si_factor, unit_of
from ..channel import BODY_QUANTITIES
from ..column_names import is_wanted, unit_in_name, why_no_unit
from ..conversion import conversion_of
from ..encoder import SIGN_BIT, Array, reading_noise
from ..first_guess import balance_factor
from .content import Choices, Survey, gear_ratio_in, torque_constant_in
from .roles import says

FACTOR_OF_ONE = 1.25
#: relative standard error of a factor up to which a balance states a constant: the printed number
#: then has more than one valid digit
KNOWN = 0.05

#: N*m/A or m: constant of a motor, or lever arm of a force beside an angle, if nothing states it
PLACEHOLDER = 1.0
#: names of forces in parts of what a drive is rated for: "[0.1%]", "(%)", "permille", and objects
#: of drives on a field bus (CiA 402), which are in thousandths
PER_CENT = re.compile(r"[%‰]|per ?mill?e|\b0x60(?:71|74|77|78)\b", re.I)
#: scatter over the standard deviation of the force below which none is stated: a noise floor of
#: less than a thousandth of the force decides nothing
LEAST = 1e-3
#: the same ratio above which none is stated: a force that is tossed from row to row, such as noise
#: as an excitation or a relay, and not a reading. Any model would be adequate within such a noise
MOST = 0.3


def describe_force(survey: Survey, name: str, key: str, choices: Choices) -> dict[str, Any]:
    """The channel table of a force: column, unit, and the motor constant of a current or the lever
    arm of a force beside an angle.
    """
    axis = survey.axis
    # known as a force, a name may end with a unit of one letter: "F_cmd_N", "i_A"
    unit = survey.columns[name].unit or unit_in_name(name, "force", axis)
    entry: dict[str, Any] = {"column": name}
    entry |= describe_code(survey, name, key)
    if unit is None and choices.torque_constant is not None and key == "actuator_force":
        if not (says(name, "torque") and not says(name, "current")):
            unit = choices.torque_constant[1].rpartition("/")[2]
    for kind, usual in (("current", "A"), ("voltage", "V")):
        if unit is None and says(name, kind):
            unit = usual
            why = f"{unit}: the name {name!r} is that of a {kind}"
            survey.guesses[f"channels.{key}.unit"] = why
    if unit in ("A", "mA", "V"):
        entry["unit"] = unit
        constant = _motor_constant(survey, key, unit, choices)
        entry["torque_constant"] = {"value": constant[0], "unit": constant[1]}
        return entry
    if axis == "revolute" and (newton := _unit_at_lever(name, unit)):
        return {**entry, "unit": newton, "lever_arm": _lever_arm(survey, name, key, choices)}
    if unit is None or not measures(unit, "force", axis):
        unit = unit_of("force", axis)
        why = why_no_unit(name, survey.columns[name].unit, "force", axis)
        if PER_CENT.search(name):
            why = f"{name!r} is in parts of a rated force: `scale` is one part in {unit}"
        survey.guesses[f"channels.{key}.unit"] = f"{unit}: {why}"
    if choices.torque_constant is not None and key == "actuator_force":
        survey.guesses["channels.actuator_force.column"] = (
            f"{name!r} is in {unit}, no current: the motor's constant is not used; "
            "--force COLUMN selects a current"
        )
    return {**entry, "unit": unit}


def _motor_constant(survey: Survey, key: str, unit: str, choices: Choices) -> tuple[float, str]:
    """The constant of a motor and its unit: stated by the user or by a line, or a placeholder.

    raises ExperimentError: what the user states gives no force of this axis
    """
    axis = survey.axis
    usual = f"{unit_of('force', axis)}/{'V' if unit == 'V' else 'A'}"
    constant = choices.torque_constant
    if constant is not None:
        if not measures(constant[1].rpartition("/")[0], "force", axis):
            raise ExperimentError(
                f"--torque-constant: found {constant[1]!r} on a {axis} axis, expected {usual!r}"
            )
        return constant
    constant = (PLACEHOLDER, usual)
    why = (
        f"{constant[0]:g} {constant[1]} is a placeholder for the motor's constant: "
        "state the true constant, since forces and parameters scale in proportion"
    )
    if (line := torque_constant_in(survey.remarks)) and measures(
        line[1].rpartition("/")[0], "force", axis
    ):
        constant = line[:2]
        why = f"{constant[0]:g} {constant[1]}: a line of the log states {line[2]!r}"
    survey.guesses[f"channels.{key}.torque_constant"] = why
    return constant


def describe_code(survey: Survey, name: str, key: str) -> dict[str, Any]:
    """How a column holds signed numbers as in experiment.toml, as a guess; {}: as they are."""
    code = survey.columns[name].code
    if code is None:
        return {}
    numbers = survey.columns[name].readings
    least = float(np.min(numbers))
    count = 0.5 * code.end - least if code.key == SIGN_BIT else code.end + least
    what = f"bit {code.bits} is a sign" if code.key == SIGN_BIT else f"it has {code.bits} bits"
    survey.guesses[f"channels.{key}.{code.key}"] = (
        f"{code.bits}: {name!r} holds signed numbers without their sign, {count:.0f} for "
        f"{least:.0f}: it changes far less from row to row if {what}; else delete {code.key} from "
        "experiment.toml"
    )
    return {code.key: code.bits}


def _unit_at_lever(name: str, unit: str | None) -> str | None:
    """Unit of a force beside an angle, such as N, by the column's unit or name; None: no force."""
    if unit is None and not says(name, "turning torque"):
        unit = unit_in_name(name, "force")
    return unit if unit and is_unit(unit) and measures(unit, "force") else None


def _lever_arm(survey: Survey, name: str, key: str, choices: Choices) -> dict[str, Any]:
    """The lever arm of a force beside an angle as in experiment.toml: stated, or a placeholder."""
    arm = choices.lever_arm
    if arm is None:
        arm = (PLACEHOLDER, "m")
        survey.guesses[f"channels.{key}.lever_arm"] = (
            f"{arm[0]:g} {arm[1]} is a placeholder: {name!r} is a force beside an angle, and its "
            "distance from the axis is not known"
        )
    return {"value": arm[0], "unit": arm[1]}


def signal_in_si(survey: Survey, key: str) -> Array:
    """A channel's column (n,) in SI, with the proposed unit, constant and gear ratio."""
    entry = survey.channels[key]
    if key == "actuator_force" and "gear_ratio" in survey.channels["position"]:
        entry = {**entry, "gear_ratio": survey.channels["position"]["gear_ratio"]}
    kind, table = BODY_QUANTITIES[key], Table(entry, "log")
    conversion, _ = conversion_of(
        table, quantity=key, kind=kind, axis=survey.axis, unit=entry["unit"]
    )
    return conversion.signal({entry["column"]: survey.columns[entry["column"]].values})


def state_scatter(survey: Survey, name: str) -> None:
    """State the scatter of the actuator force as its noise, in the unit of its column, with a note.

    Nothing is stated where the name is that of a command, where the channel is marked as measured
    (a diagnosis then estimates the noise), where no step of the position is known, or where the
    force scatters nearly as much as it varies.
    """
    entry, position = survey.channels["actuator_force"], survey.channels["position"]
    is_command = is_wanted(name) or entry["unit"] in ("V", "mV") or says(name, "voltage", "output")
    is_estimated = entry.get("measured") or not position.keys() & {"resolution", "counts_per_turn"}
    if is_command or is_estimated:
        return
    values = survey.columns[name].values
    scatter = reading_noise(values)
    if not LEAST < scatter / max(float(np.std(values)), 1e-300) < MOST:
        return
    entry["noise"] = float(f"{scatter:.3g}")
    survey.notes.append(
        f"{name!r} scatters by {entry['noise']:g} {entry['unit']} from row to row, stated as "
        "noise: delete it if the column holds the exact command"
    )


def scale_by_balance(survey: Survey, motion: tuple[Array, float], choices: Choices) -> None:
    """Guess motor constant and lever arm if neither the user nor the log states them.

    The one that is open follows from the factor by which the command balances the force of the
    hand. If this factor is far from one and none of them is guessed, a note reports it.
    """
    stated = gear_ratio_in(survey.remarks) if choices.gear_ratio is None else None
    if stated is not None:
        survey.notes.append(
            f"a line of the log states {stated[1]!r}: if position and force are those of "
            f"the motor, use --gear-ratio {stated[0]:g}"
        )
    if "interaction_force" not in survey.channels:
        return
    scale, error = _command_scale(survey, motion)
    if error > KNOWN * scale:
        return
    places = (
        (key, part)
        for part in ("torque_constant", "lever_arm")
        for key in ("actuator_force", "interaction_force")
    )
    still_open = [p for p in places if _is_open(survey, *p)]
    if still_open and (len(still_open) == 1 or still_open[0][1] == "torque_constant"):
        _guess_constant(survey, *still_open[0], scale, error)
    elif not still_open and not 1 / FACTOR_OF_ONE < scale < FACTOR_OF_ONE:
        factor = with_standard_error(scale, error)
        force, hand = (_column_of(survey, f"{k}_force") for k in ("actuator", "interaction"))
        survey.notes.append(
            f"{force!r} balances {hand!r} only with a factor of {factor}: one of the two has "
            "another unit (--unit), or a gear lies between (--gear-ratio)"
        )


def _column_of(survey: Survey, key: str) -> str:
    return str(survey.channels[key]["column"])


def _is_open(survey: Survey, key: str, part: str) -> bool:
    """Whether a motor constant or a lever arm is a placeholder."""
    value = survey.channels[key].get(part, {}).get("value")
    return f"channels.{key}.{part}" in survey.guesses and value == PLACEHOLDER


def _command_scale(survey: Survey, motion: tuple[Array, float]) -> tuple[float, float]:
    """The factor by which the command balances the force of the hand, and its standard error."""
    u, hand = (signal_in_si(survey, f"{whose}_force") for whose in ("actuator", "interaction"))
    factor, error = balance_factor(u, hand, *motion)
    if factor == 0:
        return 1.0, math.inf
    return 1 / abs(factor), error / factor**2


def _guess_constant(survey: Survey, key: str, part: str, scale: float, error: float) -> None:
    """Set the motor constant or the lever arm of one force so that the two forces balance.

    scale: factor of the command in the balance, with the placeholder in place of the constant
    """
    other = "interaction_force" if key == "actuator_force" else "actuator_force"
    if key == "interaction_force":
        scale, error = 1.0 / scale, error / scale**2
    table, base = survey.channels[key][part], PLACEHOLDER
    if part == "torque_constant":
        unit = table["unit"].rpartition("/")[0]
        base /= si_factor(unit, quantity="force", axis=survey.axis)
    doubt = ""
    if f"channels.{other}.unit" in survey.guesses:
        doubt = f", if the latter is in {survey.channels[other]['unit']}"
    elif _is_open(survey, other, "lever_arm"):
        doubt = f", if the latter acts at {PLACEHOLDER:g} m from the axis"
    table["value"] = float(f"{scale * base:.4g}")
    value = with_standard_error(scale * base, error * base)
    survey.guesses[f"channels.{key}.{part}"] = (
        f"{value} {table['unit']}: with it, {_column_of(survey, key)!r} balances "
        f"{_column_of(survey, other)!r}{doubt}"
    )
