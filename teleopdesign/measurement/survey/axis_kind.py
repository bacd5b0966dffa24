"""Whether an axis turns or slides, from the units and names of a log's columns."""

from __future__ import annotations

from ...base.units import AXES, is_unit, measures
from ..column_names import words_of
from .content import Choices, Survey
from .derivative import turn_of
from .encoder_counts import is_counter
from .words import SAYS, says


def drives_in_turns(name: str) -> list[str]:
    """The drives that report turns under this name; ODrives call it "pos_estimate"."""
    words = set(words_of(name))
    return sorted({*SAYS["drive in turns"]} & words) or ["ODrive"] * ({"pos", "estimate"} <= words)


def axis_of(survey: Survey, position: str, choices: Choices) -> str:
    """The axis: the user's choice, or from the unit of the position, or a guess."""
    if choices.axis is not None:
        return choices.axis
    unit = choices.units.get(position) or survey.columns[position].unit
    if unit is not None and unit != "counts":
        for axis in ("prismatic", "revolute"):
            if measures(unit, "position", axis):
                return axis
    if (turn := turn_of(survey.columns[position].values)) is not None:
        survey.guesses["model.device.axis"] = (
            f"the axis is revolute: {position!r} wraps at a turn in {turn}"
        )
        return "revolute"
    if choices.torque_constant is not None:
        force = choices.torque_constant[1].rpartition("/")[0]
        return "revolute" if measures(force, "force", "revolute") else "prismatic"
    units = [c.unit for c in survey.columns.values() if c.unit and is_unit(c.unit)]
    rates = {a for a in AXES for u in units if measures(u, "velocity", a)}
    forces = [u for u in units if measures(u, "force")]
    turned = [u for u in units if measures(u, "force", "revolute")]
    if len(rates) == 1:
        axis = next(iter(rates))
        unit = next(u for u in units if measures(u, "velocity", axis))
        why = f"a velocity is in {unit}"
    elif forces and not turned or any(measures(u, "position") for u in units):
        lengths = [u for u in units if measures(u, "position")]
        why = f"forces are in {forces[0]}" if forces else f"a column is in {lengths[0]}"
        axis = "prismatic"
    elif turned and not forces:
        why, axis = f"forces are in {turned[0]}", "revolute"
    else:
        sliding = says(position, "sliding") and not says(position, "limb", "angle")
        turning = says(position, "turning", "limb", "angle") or drives_in_turns(position)
        torques = [name for name in survey.columns if says(name, "turning torque")]
        counts = unit is None and is_counter(survey.columns[position])
        revolute = turning or torques or counts or unit == "counts" or "A" in units
        axis = "revolute" if revolute and not sliding else "prismatic"
        why = "no unit and no name of a column determines the axis"
        if sliding:
            why = f"the name {position!r} is that of a part that slides"
        elif turning:
            why = f"the name {position!r} is that of an angle"
        elif torques:
            why = f"the name {torques[0]!r} is that of a torque"
        elif counts:
            why = f"{position!r} holds whole numbers, as the counter of an encoder does"
    survey.guesses["model.device.axis"] = f"the axis is {axis}: {why}"
    return axis
