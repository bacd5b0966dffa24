"""Which columns of a log are the commanded and the measured force, with their units and signs."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from ...base.units import measures, si_factor
from ..column_names import is_wanted, likeness
from ..encoder import Array
from ..first_guess import SURELY_LESS, balance_factor, explain_force, is_turned
from .content import NONE, SURE_NAME, Choices, Survey, SurveyedColumn, sample_time_of
from .derivative import unwrap_column
from .force_entry import (
    FACTOR_OF_ONE,
    _is_open,
    describe_force,
    scale_by_balance,
    signal_in_si,
    state_scatter,
)
from .refusals import error_without_force, error_without_position, explain_ambiguity, tells_forces
from .relations import (
    causes_acceleration,
    current_that_acted,
    left_in_turn,
    possible_forces,
    relations_of,
)
from .roles import (
    AS_LIKELY,
    as_likely,
    evidence_of,
    is_current,
    is_named_force,
    is_nameless,
    of_another_axis,
    says,
    score_of,
    stand_together,
)

#: a column without a clear name counts as the force of the hand if it leaves at most this part of
#: the squares that the motion does not explain: with a higher limit, one of many columns would pass
#: by chance. The limit also bounds the deviation of its factor from one: a calibration error of a
#: quarter still passes
BALANCES = 2.0 / 3.0


def describe_forces(
    survey: Survey, position: str, velocity: str | None, choices: Choices, file: str
) -> None:
    """Set the channels of the actuator force and of the measured force, with units and signs.

    raises ExperimentError: no column may be the force
    """
    h = sample_time_of(survey)
    entry = survey.channels["position"]
    x = unwrap_column(survey.columns[position].values)
    free: dict[str, SurveyedColumn] = {}
    scores: dict[str, float] = {}
    if not choices.states_all:
        survey.relations = dict(relations_of(survey, position, velocity, x))
        free = possible_forces(survey, position, velocity)
        hand = choices.interaction_force or _named_hand(free)
        beside = free[hand].values if hand in free else None
        survey.explained = {
            n: 1.0 - left_in_turn(c.values, x, h, None if n == hand else beside)[1]
            for n, c in free.items()
        }
        constant = choices.torque_constant is not None
        scores = score_forces(survey, position, free, constant, hand)
    force, measured = _find_driving_force(survey, free, scores, choices, (file, velocity))
    survey.channels["actuator_force"] = describe_force(survey, force, "actuator_force", choices)
    if measured:
        survey.channels["actuator_force"]["measured"] = True
    state_scatter(survey, force)
    if entry.get("gear_ratio") is not None:
        survey.channels["actuator_force"]["gear_ratio"] = entry["gear_ratio"]
    # in the unit of the log: the balance of forces does not depend on the scale of the motion
    motion = x, h
    same_axis = {n: c for n, c in free.items() if not of_another_axis(n, position, survey.columns)}
    hand = find_hand(survey, same_axis, force, motion, choices)
    if hand is not None:
        survey.channels["interaction_force"] = describe_force(
            survey, hand, "interaction_force", choices
        )
    scale_by_balance(survey, motion, choices)
    # now in SI, and behind the guessed gear
    _choose_signs(survey, (signal_in_si(survey, "position"), h), force, hand)


def _named_hand(free: Mapping[str, SurveyedColumn]) -> str | None:
    """The column that by its name is surely the force of the hand; None: no name tells one."""
    named = {n: evidence_of(c)["name of an interaction force"] for n, c in free.items()}
    best = max(named, key=lambda n: named[n], default="")
    return best if named.get(best) else None


def score_forces(
    survey: Survey,
    position: str,
    free: Mapping[str, SurveyedColumn],
    needs_constant: bool,
    hand: str | None = None,
) -> dict[str, float]:
    """The score of each column that may be the force;  needs_constant: one is stated.

    hand: the force of the hand, if one is known. The forces of motor and hand together balance the
        motion, whichever moves the device: beside a motor's, the motion tells nothing of the hand's
    """
    of_motor = any(likeness(n, "actuator_force") >= SURE_NAME for n in free if n != hand)
    return {
        n: score_of(
            "actuator_force",
            c,
            left=1.0 if of_motor and n == hand else 1.0 - survey.explained[n],
            its_constant_is_stated=needs_constant and (c.unit == "V" or is_current(c)),
            beside_the_position=stand_together(n, position),
            of_another_axis=of_another_axis(n, position, survey.columns),
        )
        for n, c in free.items()
    }


def _find_driving_force(
    survey: Survey,
    free: Mapping[str, SurveyedColumn],
    scores: Mapping[str, float],
    choices: Choices,
    messages: tuple[str, str | None],
) -> tuple[str, bool]:
    """The column of the actuator force, and whether it was measured in place of a command.

    If names alone do not decide, a guess is noted.
    messages: the file, and the column of the velocity
    """
    file, velocity = messages
    if choices.actuator_force is not None:
        return choices.actuator_force, False
    if not scores:
        raise error_without_force(survey, file, velocity)
    force = max(scores, key=lambda n: scores[n])
    why = None
    if (acted := current_that_acted(force, free, scores)) is not None:
        wanted, (force, apart) = force, acted
        why = (
            f"{force!r} is read as the actuator's force: the command {wanted!r} leaves "
            f"{apart:.0%} of it unexplained, more than noise"
        )
    elif likeness(force, "actuator_force") < SURE_NAME:
        share = survey.explained[force]
        if not is_named_force(free[force]):
            if AS_LIKELY * (1.0 - share) > 1.0 or not tells_forces(survey):
                raise error_without_force(survey, file, velocity, force)
            place = survey.columns[survey.channels["position"]["column"]]
            if choices.position is None and is_nameless(place):
                if causes_acceleration(place.values, free[force].values, sample_time_of(survey)):
                    raise error_without_position(survey, free, file, place.name, force)
        why = f"{force!r} is read as the actuator's force: the motion explains {share:.0%} of it"
    elif others := as_likely(scores, force):
        why = explain_ambiguity(force, others, "the actuator's force")
    if why is not None:
        survey.guesses["channels.actuator_force.column"] = why
    return force, acted is not None


def _choose_signs(
    survey: Survey, motion: tuple[Array, float], force: str, hand: str | None
) -> None:
    """Choose the signs of position and hand so that friction brakes and inertia is positive."""
    x, h = motion
    u = signal_in_si(survey, "actuator_force")
    if hand is None:
        total, fit = u, explain_force(u, x, h)
    else:
        f = signal_in_si(survey, "interaction_force")
        total, fit = u + f, explain_force(u + f, x, h)
        other = explain_force(u - f, x, h)
        # a motor that follows the hand's force leaves less of it with the wrong sign, and of motion
        parts = [(1.0 - one.explained) ** 0.5 for one in (fit, other)]
        if other.left < SURELY_LESS * fit.left and parts[1] < SURELY_LESS * parts[0]:
            survey.channels["interaction_force"]["sign"] = -1
            survey.guesses["channels.interaction_force.sign"] = (
                f"-1: with this sign, {hand!r} balances {force!r} and leaves "
                f"{1 - other.left / fit.left:.0%} less of the forces unexplained"
            )
            total, fit = u - f, other
    if is_turned(total, x, h):
        survey.channels["position"]["sign"] = -1
        if "velocity" in survey.channels:
            survey.channels["velocity"]["sign"] = -1
        survey.guesses["channels.position.sign"] = (
            "-1: with the sign of the log, friction would drive the motion, or inertia be "
            "negative; a motor that brakes what a hand or a spring moves looks the same"
        )
        fit = replace(fit, inertia=-fit.inertia, level=-fit.level, damping=-fit.damping)
    survey.first = fit
    ratio = float(survey.channels["position"].get("gear_ratio", 1.0))
    if ratio != 1.0:
        survey.notes.append(
            f"forces and positions are those on the output side of the gear of {ratio:g}"
        )


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
    u = signal_in_si(survey, "actuator_force")
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
