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
from ..first_guess import balance_factor, explain_force
from .content import SURE_NAME, Array, Choices, Survey, SurveyedColumn
from .force_entry import PLACEHOLDER, force_to_si
from .remarks import gear_ratio_in
from .words import says

#: a column without a clear name counts as the force of the hand if it leaves at most this part of
#: the squares that the motion does not explain: with a higher limit, one of many columns would pass
#: by chance. The limit also bounds the deviation of its factor from one: a calibration error of a
#: quarter still passes
BALANCES = 2.0 / 3.0
FACTOR_OF_ONE = 1.25
#: relative standard error of a factor up to which a balance states a constant: the printed number
#: then has more than one valid digit
KNOWN = 0.05
#: a measured current equals the commanded one if the difference has at most this part of its
#: squares, without the noise of single rows: the current loop of a drive and its sensor leave less
#: than a tenth of the force. If the difference is larger, another force than the command acted:
#: feedback, or a limit
FOLLOWED = 0.01
#: part of the larger of two sides (values above and below zero) up to which the smaller one may be
#: noise about zero: the current that a drive draws from its supply has one side, a motor's has both
ONE_SIDE = 0.1
#: most rows by which a drive may be late behind its command; it may also smooth over these rows
LATE = 4


def hand_by_balance(
    survey: Survey, free: Mapping[str, SurveyedColumn], force: str, motion: tuple[Array, float]
) -> str | None:
    """The force of the hand by its balance with the command, if names do not decide; else None.

    The motion requires `k command + hand`. The column must explain a good part of what the motion
    leaves of the command alone, with a factor of one where the scale of the command is known.
    """
    x, h = motion
    u = survey.columns[force].values * force_to_si(survey, "actuator_force")
    alone = explain_force(u, x, h)
    is_free = _is_open(survey, "actuator_force", "torque_constant")
    best: tuple[float, str] | None = None
    for name, column in free.items():
        if name == force or not _may_balance(column, survey.axis, named=is_free):
            continue
        other = column.values
        if column.unit:
            other = other * si_factor(column.unit, quantity="force", axis=survey.axis)
        factor, _ = balance_factor(u, other, x, h)
        if not is_free and not 1 / FACTOR_OF_ONE < abs(factor) < FACTOR_OF_ONE:
            continue
        whole = explain_force(u + (factor if is_free else math.copysign(1.0, factor)) * other, x, h)
        # a command that was logged twice cancels itself: the motion explains no more of the rest
        if (
            whole.left**2 > BALANCES * alone.left**2
            or 1 - whole.explained > BALANCES * (1 - alone.explained)
            or best is not None
            and best[0] < whole.left
        ):
            continue
        best = whole.left, name
    if best is None:
        return None
    left, name = best
    survey.guesses["channels.interaction_force.column"] = (
        f"{name!r} is read as the force of the hand: with it, the motion leaves "
        f"{1 - (left / alone.left) ** 2:.0%} less of the command {force!r} unexplained"
    )
    return name


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
    """Guess gear ratio, motor constant and lever arm if neither the user nor the log states them.

    The one that is open follows from the factor by which the command balances the force of the
    hand. If this factor is far from one and none of them is guessed, a note reports it.
    """
    stated = gear_ratio_in(survey.remarks) if choices.gear_ratio is None else None
    is_motors = choices.gear_ratio is None and all(
        says(_column_of(survey, key), "motor side") for key in ("position", "actuator_force")
    )
    if stated is not None and is_motors:
        _guess_gear(survey, stated[0], f"a line of the log states {stated[1]!r}")
    elif stated is not None:
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
        if is_motors and stated is None and scale > 1:
            whole = float(round(scale))
            ratio = whole if abs(scale - whole) < 2 * error else float(f"{scale:.3g}")
            _guess_gear(survey, ratio, f"{force!r} balances {hand!r} with a factor of {factor}")
        else:
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


def _guess_gear(survey: Survey, ratio: float, why: str) -> None:
    """Position, velocity and command are those of the motor: set the gear ratio to the joint."""
    for key in ("position", "velocity", "actuator_force"):
        if key in survey.channels:
            survey.channels[key]["gear_ratio"] = ratio
    survey.guesses["channels.position.gear_ratio"] = (
        f"{ratio:g}: the names of position and force are those of a motor, and {why}"
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
        if name != force and _is_current(column) and not is_wanted(name)
        # the current that a drive draws from its supply has one side
        if not _smaller_side(column.values) < ONE_SIDE < _smaller_side(columns[force].values)
    ]
    if not measured:
        return None
    best = max(measured, key=lambda name: scores[name])
    share = _unexplained_share(columns[force].values, columns[best].values)
    return (best, share**0.5) if share > FOLLOWED else None


def _is_current(column: SurveyedColumn) -> bool:
    """Whether a column is the current of a motor, by unit or by name."""
    if likeness(column.name, "actuator_force") < SURE_NAME:
        return False
    return column.unit in ("A", "mA") or column.unit is None and says(column.name, "current")


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
    if rows <= LATE:
        return 0.0
    late = [wanted[LATE - k : LATE - k + rows] for k in range(LATE + 1)]
    columns = np.column_stack([*late, np.ones(rows)])
    target = measured[LATE:]
    whole = float(np.mean((target - target.mean()) ** 2))
    solution, *_ = np.linalg.lstsq(columns, target, rcond=1e-8)
    left = target - columns @ solution
    return float(np.mean(left[1:] * left[:-1])) / whole if whole > 0 else 0.0
