"""One force of a log as an entry of experiment.toml: its unit, and the motor constant."""

from __future__ import annotations

import re
from typing import Any

from ...quantity import measures, unit_of
from ..column_names import unit_in_name, why_no_unit
from ..conversion import conversion_of
from ..toml_table import Table
from .acting import names_current, names_torque
from .content import Choices, Survey
from .remarks import torque_constant_in

#: N*m/A: constant of a motor if nothing states it
PLACEHOLDER = 1.0
#: names of forces in parts of what a drive is rated for: "[0.1%]", "(%)", "permille"
PER_CENT = re.compile(r"[%‰]|per ?mill?e", re.I)


def describe_force(survey: Survey, name: str, key: str, choices: Choices) -> dict[str, Any]:
    """The channel table of a force: its column and unit, and for a current the motor constant."""
    axis = survey.axis
    # known as a force, a name may end with a unit of one letter: "F_cmd_N", "i_A"
    unit = choices.units.get(name) or survey.columns[name].unit or unit_in_name(name, "force", axis)
    entry: dict[str, Any] = {"column": name}
    if unit is None and choices.torque_constant is not None and key == "actuator_force":
        if not names_torque(name):
            unit = choices.torque_constant[1].rpartition("/")[2]
    if unit is None and names_current(name):
        unit = "A"
        survey.guesses[f"channels.{key}.unit"] = f"A: {name!r} is a current by its name"
    if unit in ("A", "mA", "V"):
        entry["unit"] = unit
        base = "V" if unit == "V" else "A"
        constant = choices.torque_constant
        if constant is None:
            constant = (PLACEHOLDER, f"{unit_of('force', axis)}/{base}")
            why = (
                f"{constant[0]:g} {constant[1]} is a placeholder for the motor's constant: "
                "state the true constant, forces and parameters scale in proportion"
            )
            if (stated := torque_constant_in(survey.remarks)) and measures(
                stated[1].rpartition("/")[0], "force", axis
            ):
                constant = stated[:2]
                why = f"{constant[0]:g} {constant[1]}: the log says {stated[2]!r}"
            survey.guesses[f"channels.{key}.torque_constant"] = why
        entry["torque_constant"] = {"value": constant[0], "unit": constant[1]}
        return entry
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


def force_to_si(survey: Survey, key: str) -> float:
    """Factor of a force from its column to SI, with the proposed unit, constant and gear ratio."""
    entry = survey.channels[key]
    if key == "actuator_force" and "gear_ratio" in survey.channels["position"]:
        entry = {**entry, "gear_ratio": survey.channels["position"]["gear_ratio"]}
    conversion, _ = conversion_of(
        Table(entry, "log"), quantity=key, kind="force", axis=survey.axis, unit=entry["unit"]
    )
    return conversion.factor
