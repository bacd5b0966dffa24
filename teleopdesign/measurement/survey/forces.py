"""Which columns of a log are the commanded and the measured force, with their units and signs."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from ...base.units import si_factor
from ..column_names import likeness
from ..encoder import Array
from ..first_guess import SURELY_LESS, explain_force, is_turned
from .balance import current_that_acted, find_hand, scale_by_balance
from .content import SURE_NAME, Choices, Survey, SurveyedColumn, sample_time_of
from .derivative import unwrap_column, wrap_of
from .force_entry import describe_force, force_to_si, state_scatter
from .refusals import error_without_force, error_without_position, explain_ambiguity, tells_forces
from .relations import causes_acceleration, left_in_turn, possible_forces, relations_of
from .roles import (
    AS_LIKELY,
    LEAST_LEFT,
    as_likely,
    is_current,
    is_named_force,
    is_nameless,
    of_another_axis,
    score_of,
    stand_together,
)


def describe_forces(
    survey: Survey, position: str, velocity: str | None, choices: Choices, file: str
) -> None:
    """Set the channels of the actuator force and of the measured force, with units and signs.

    raises ExperimentError: no column may be the force
    """
    h = sample_time_of(survey)
    entry = survey.channels["position"]
    x = unwrap_column(survey.columns[position].values, wrap_of(survey.columns[position].values))
    free: dict[str, SurveyedColumn] = {}
    scores: dict[str, float] = {}
    if not choices.states_all:
        survey.relations = dict(relations_of(survey, position, velocity, x))
        free = possible_forces(survey, position, velocity)
        survey.explained = {n: 1.0 - left_in_turn(c.values, x, h)[1] for n, c in free.items()}
        scores = _score_forces(survey, position, free, choices.torque_constant is not None)
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
    _choose_signs(survey, (x * _position_to_si(survey), h), force, hand)


def score_beside(survey: Survey, position: str, velocity: str | None, x: Array) -> float:
    """The score of the other columns beside a position x (n,): one is a force, others its place."""
    h, columns = sample_time_of(survey), survey.columns
    beside = {n: c for n, c in columns.items() if not of_another_axis(n, position, columns)}
    trial = replace(survey, columns=beside)
    trial.relations = dict(relations_of(trial, position, velocity, x))
    free = possible_forces(trial, position, velocity)
    left = {n: left_in_turn(c.values, x, h) for n, c in free.items()}
    trial.explained = {n: 1.0 - by_motion for n, (_, by_motion) in left.items()}
    forces = _score_forces(trial, position, free, False)
    places = [
        math.log(max(by_place, LEAST_LEFT))
        for n, (by_place, _) in left.items()
        if not is_named_force(free[n])
    ]
    return max(forces.values(), default=-math.inf) - sum(places)


def _score_forces(
    survey: Survey, position: str, free: Mapping[str, SurveyedColumn], needs_constant: bool
) -> dict[str, float]:
    """The score of each column that may be the force;  needs_constant: one is stated."""
    return {
        n: score_of(
            "actuator_force",
            c,
            left=1.0 - survey.explained[n],
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
    elif likeness(force, "actuator_force") < SURE_NAME or not is_named_force(free[force]):
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


def _position_to_si(survey: Survey) -> float:
    """Factor of the position from its column to SI, on the output side of the gear."""
    position = survey.channels["position"]
    if position["unit"] == "counts":
        scale = 2 * math.pi / float(position["counts_per_turn"])
    else:
        scale = si_factor(position["unit"], quantity="position", axis=survey.axis)
    return scale / float(position.get("gear_ratio", 1.0))


def _choose_signs(
    survey: Survey, motion: tuple[Array, float], force: str, hand: str | None
) -> None:
    """Choose the signs of position and hand so that friction brakes and inertia is positive."""
    x, h = motion
    u = survey.columns[force].values * force_to_si(survey, "actuator_force")
    if hand is None:
        total, fit = u, explain_force(u, x, h)
    else:
        f = survey.columns[hand].values * force_to_si(survey, "interaction_force")
        total, fit = u + f, explain_force(u + f, x, h)
        other = explain_force(u - f, x, h)
        if other.left < SURELY_LESS * fit.left:
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
