"""Balance of two logged forces along the motion: which one is the hand's, and unknown factors.

    k command + hand = m a + c sgn(v) + b v + constant

k is one if both are forces at the joint, the motor constant if the command is a current, the gear
ratio if the command is a torque at the motor, and the inverse of the lever arm if the hand's force
is in N beside an angle.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ...base.sentences import with_standard_error
from ...base.units import measures, si_factor
from ..column_names import is_wanted, likeness
from ..encoder import Array
from ..first_guess import balance_factor, explain_force
from ..limits import SMALL
from .content import NONE, SURE_NAME, Choices, Survey, SurveyedColumn, gear_ratio_in
from .force_entry import PLACEHOLDER, force_to_si
from .roles import LEAST_LEFT, is_current, says, score_of

#: a column without a clear name counts as the force of the hand if it leaves at most this part of
#: the squares that the motion does not explain: with a higher limit, one of many columns would pass
#: by chance. The limit also bounds the deviation of its factor from one: a calibration error of a
#: quarter still passes
BALANCES = 2.0 / 3.0
FACTOR_OF_ONE = 1.25
#: relative standard error of a factor up to which a balance states a constant: the printed number
#: then has more than one valid digit
KNOWN = 0.05
#: most rows by which a drive may be late behind its command; it may also smooth over these rows
LATE = 4


def find_hand(
    survey: Survey,
    free: Mapping[str, SurveyedColumn],
    force: str,
    motion: tuple[Array, float],
    choices: Choices,
) -> str | None:
    """The force of the hand: stated, or by its name, or by its balance with the command."""
    if choices.interaction_force is not None:
        return None if choices.interaction_force == NONE else choices.interaction_force
    scores: dict[str, float] = {}
    for name, column in free.items():
        if name != force:
            is_called = likeness(name, "interaction_force") >= SURE_NAME
            left = 1.0 if is_called else _left_by_balance(survey, column, motion)
            scores[name] = score_of("interaction_force", column, left=left)
    hand = max(scores, key=lambda n: scores[n], default="")
    if not hand or scores[hand] < -math.log(BALANCES):
        return None
    if likeness(hand, "interaction_force") < SURE_NAME:
        survey.guesses["channels.interaction_force.column"] = (
            f"{hand!r} is read as the force of the hand: with it, the motion leaves "
            f"{1 - math.exp(-scores[hand]):.0%} less of the command {force!r} unexplained"
        )
    return hand


def _left_by_balance(survey: Survey, column: SurveyedColumn, motion: tuple[Array, float]) -> float:
    """Part of what the motion leaves of the command that it leaves of `k command + hand`.

    Where the scale of the command is known, the factor is one.
    """
    is_free = _is_open(survey, "actuator_force", "torque_constant")
    if not _may_balance(column, survey.axis, named=is_free):
        return 1.0
    name = _column_of(survey, "actuator_force")
    u = survey.columns[name].values * force_to_si(survey, "actuator_force")
    other = column.values
    if column.unit:
        other = other * si_factor(column.unit, quantity="force", axis=survey.axis)
    factor, _ = balance_factor(u, other, *motion)
    if not is_free and not 1 / FACTOR_OF_ONE < abs(factor) < FACTOR_OF_ONE:
        return 1.0
    alone = explain_force(u, *motion)
    factor = factor if is_free else math.copysign(1.0, factor)
    whole = explain_force(u + factor * other, *motion)
    if not alone.left > 0.0 or not alone.explained < 1.0:
        return 1.0
    # a command that was logged twice cancels itself: the motion explains no more of the rest
    return max((whole.left / alone.left) ** 2, (1 - whole.explained) / (1 - alone.explained))


def _may_balance(column: SurveyedColumn, axis: str, *, named: bool) -> bool:
    """Whether a column may be the force of the hand by its name and unit.

    named: the column needs the unit of a force, or the name of one that is not the motor's: with a
        free factor, a motor voltage balances a current too
    """
    name, unit = column.name, column.unit
    if is_wanted(name) or likeness(name, "position") >= SURE_NAME:
        return False
    if unit is not None:
        return measures(unit, "force", axis)
    return not named or says(name, "torque") and not says(name, "motor side")


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
    u, hand = (
        survey.columns[_column_of(survey, key)].values * force_to_si(survey, key)
        for key in ("actuator_force", "interaction_force")
    )
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


def current_that_acted(
    force: str, columns: Mapping[str, SurveyedColumn], scores: Mapping[str, float]
) -> tuple[str, float] | None:
    """A measured current that acted in place of the commanded `force`, and how far the two differ.

    A model-based controller logs the force that its model demands. Friction that the model lacks
    shows only in the measured current: with the commanded force no effect would seem to be missing.

    returns: the column of the current, and the rms of the part that the command does not explain,
        over the rms of the current; None: `force` is no command, or the drive followed it
    """
    if not is_wanted(force):
        return None
    measured = [
        name
        for name, column in columns.items()
        if name != force and is_current(column) and not is_wanted(name)
        if likeness(name, "actuator_force") >= SURE_NAME
        # the current that a drive draws from its supply has one side
        if not _smaller_side(column.values) < SMALL < _smaller_side(columns[force].values)
    ]
    if not measured:
        return None
    best = max(measured, key=lambda name: scores[name])
    share = _unexplained_share(columns[force].values, columns[best].values)
    return (best, share**0.5) if share > LEAST_LEFT else None


def _smaller_side(x: Array) -> float:
    """The largest value of the smaller side of zero, over that of the larger side."""
    sides = sorted((max(float(np.max(x)), 0.0), max(-float(np.min(x)), 0.0)))
    return sides[0] / sides[1] if sides[1] > 0.0 else 0.0


def _unexplained_share(wanted: Array, measured: Array) -> float:
    """Part of the variance of a measured force that the commanded force does not explain.

    The residual of each row is multiplied by that of the next row, so that noise of single rows and
    the steps of a converter average out.
    """
    rows = len(measured) - LATE
    late = [wanted[LATE - k : LATE - k + rows] for k in range(LATE + 1)]
    columns = np.column_stack([*late, np.ones(rows)])
    target = measured[LATE:]
    whole = float(np.mean((target - target.mean()) ** 2))
    solution, *_ = np.linalg.lstsq(columns, target, rcond=1e-8)
    left = target - columns @ solution
    return float(np.mean(left[1:] * left[:-1])) / whole if whole > 0 else 0.0
