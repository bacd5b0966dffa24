"""The motion of a body in a record, in numbers and words, and what it lacks to show effects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..base.finding import Finding
from ..base.sentences import percent
from ..base.units import unit_of
from ..diagnose.candidates import tells_place_from_time
from ..measurement.filtering import Array
from ..measurement.first_guess import hardly_varies
from ..measurement.motion import RARE, Motion
from ..model import Model

#: standard deviation of the speed over its mean, below which the speed counts as constant
STEADY = 0.1
#: part of the force below which the force of inertia counts as negligible
LIGHT = 0.1
#: part of its way that a motion goes in one direction, and along which the forces act against it,
#: from which something else drives it: a controller that slows a body down acts along less
AGAINST = 0.9


def missing_excitation(motions: Sequence[Motion], model: Model, place: str) -> dict[str, str]:
    """Signal of a law -> in words, what the motion of one body lacks of it, with a number."""
    direction = np.concatenate([m.direction for m in motions])
    speed = np.abs(np.concatenate([m.velocity for m in motions]))
    forth, back = (float(np.mean(direction == way)) for way in (1, -1))
    moving = forth + back
    reasons: dict[str, str] = {}
    if moving < RARE:
        reasons["velocity"] = f"it moves only {percent(moving, '.2g')} of the time"
    elif min(forth, back) < RARE * moving:
        reasons["velocity"] = "it moves in one direction only"
    elif (spread := float(np.std(speed[direction != 0]) / np.mean(speed[direction != 0]))) < STEADY:
        reasons["velocity"] = f"its speed varies by only {percent(spread, '.2g')}"
    if not tells_place_from_time(motions):
        reasons["position"] = "it never returns to an earlier position"
    force = _rms([m.lowpassed(m.at_rows(m.command) + m.interaction) for m in motions])
    inertia = model.body(place).parameters["inertia"].value
    share = inertia * _rms([m.lowpassed(m.acceleration) for m in motions]) / force if force else 0.0
    if share < LIGHT:
        reasons["acceleration"] = f"inertia makes only {percent(share, '.2g')} of the force"
    commands = np.concatenate([m.command for m in motions])
    if hardly_varies(commands):
        reasons["command"] = reasons["acting_force"] = "the commanded force hardly varies"
    if not any(m.interaction.any() for m in motions):
        reasons["interaction_force"] = "no interaction force is measured"
    return reasons


def _rms(parts: Sequence[Array]) -> float:
    return float(np.sqrt(np.mean(np.concatenate(parts) ** 2)))


def describe_motion(
    motions: Sequence[Motion], place: str, poor: Mapping[str, str], axis: str
) -> Finding:
    """A finding with the motion of one body, in numbers.

    poor: result of `missing_excitation`
    """
    x = np.concatenate([m.position for m in motions])
    direction = np.concatenate([m.direction for m in motions])
    fastest = max(float(np.abs(m.velocity).max()) for m in motions)
    turns = sum(int(np.sum(np.diff(m.direction[m.direction != 0]) != 0)) for m in motions)
    forth, back = (float(np.mean(direction == way)) for way in (1, -1))
    numbers = {
        "travel": float(np.ptp(x)),
        "fastest": fastest,
        "reversals": float(turns),
        "forth": forth,
        "back": back,
        "motionless": 1.0 - forth - back,
    }
    missing = "; ".join(dict.fromkeys(poor.values()))
    against = _part_against(motions)
    driven = ""
    if against > AGAINST:
        numbers["against"] = against
        driven = (
            f" Along {100 * against:.0f} % of the way, the measured forces act against the motion: "
            "something else drives it, such as a weight that is let down, or a sign is wrong "
            "(sign = -1 at the position)."
        )
    return Finding(
        "motion",
        "note" if missing else "fine",
        f"travels {np.ptp(x):.3g} {unit_of('position', axis)}, up to {fastest:.3g} "
        f"{unit_of('velocity', axis)}, {turns} reversals; "
        f"{100 * forth:.0f} % of the time forward, {100 * back:.0f} % backward, "
        f"{100 * (1.0 - forth - back):.0f} % without visible motion"
        f"{'. Limits: ' + missing if missing else ''}.{driven}",
        numbers,
        place,
    )


def _part_against(motions: Sequence[Motion]) -> float:
    """Part of a way in one direction along which the measured forces act against it; 0: no such."""
    force = np.concatenate([m.lowpassed(m.at_rows(m.command) + m.interaction) for m in motions])
    direction = np.concatenate([m.direction for m in motions])
    steps = np.concatenate([np.abs(m.velocity) for m in motions]) * (direction != 0)
    way = float(steps.sum())
    if way == 0.0 or abs(float(steps @ direction)) < AGAINST * way:
        return 0.0
    return float(steps[force * direction < 0].sum()) / way
