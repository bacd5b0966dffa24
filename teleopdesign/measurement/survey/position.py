"""Which columns of a log are position and velocity."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product

from ..column_names import is_wanted, likeness
from ..encoder import Array
from .content import (
    SURE_NAME,
    Choices,
    Survey,
    SurveyedColumn,
    columns_in_use,
    moves,
    sample_time_of,
)
from .derivative import (
    DERIVATIVE,
    is_no_velocity,
    is_velocity,
    leaps,
    may_be_position,
    rate_agreement,
    unwrap_column,
)
from .forces import score_forces
from .refusals import error_without_position, explain_ambiguity
from .relations import lags, left_in_turn, may_be_set_point, possible_forces, relations_of
from .roles import (
    LEAST_LEFT,
    as_likely,
    first_of,
    is_named_force,
    is_nameless,
    is_no_position,
    is_unit_of,
    of_another_axis,
    score_of,
)


def find_position(survey: Survey, choices: Choices, file: str) -> tuple[str, str | None]:
    """The column of the position, and that of its velocity or None.

    raises ExperimentError: no column may be the position
    """
    chosen, h = choices.position, sample_time_of(survey)
    columns, used = survey.columns, columns_in_use(survey)
    moving = {n: c for n, c in columns.items() if moves(c) and n not in used}
    if choices.states_all:  # only its velocity is looked for, among the columns that are called so
        moving = {n: c for n, c in moving.items() if n == chosen or is_velocity(c)}
    moving = {n: c for n, c in moving.items() if n == chosen or may_be_position(n, columns, h)}
    flat = {n: unwrap_column(c.values) for n, c in moving.items()}
    # a wrong unit that is stated is refused later, with its name
    may_be = [n for n, c in moving.items() if n in choices.units or not is_no_position(c)]
    may_be = may_be if chosen is None else [chosen]
    velocities = {n: _velocity_of(n, moving, flat, h) for n in may_be}
    if chosen is None:
        followed = {} if len(may_be) < 2 else _followed_columns(may_be, moving, flat)
        scores = {
            n: score_of(
                "position",
                moving[n],
                its_velocity_is_logged=velocities[n] is not None,
                it_follows_a_column=n in followed,
                a_column_follows_it=n in followed.values(),
                it_leaps=likeness(n, "position") < SURE_NAME and leaps(flat[n]),
            )
            for n in may_be
        }
        best = max(scores, key=lambda n: scores[n], default=None)
        if best is None:
            raise error_without_position(survey, moving, file)
        if alike := as_likely(scores, best):
            motions = ((n, velocities[n], flat[n]) for n in (best, *alike))
            best = first_of({n: score_beside(survey, n, v, x) for n, v, x in motions})
        # a velocity of no column's motion is that of a body whose position is not in the log
        speeds = (n for n, c in moving.items() if n != best and is_velocity(c) and not is_wanted(n))
        shown = velocities[best] is not None or best in followed
        if is_nameless(moving[best]) and not shown and any(speeds):
            raise error_without_position(survey, moving, file, best)
        _note_choice(survey, best, scores, velocities[best], followed)
    else:
        best = chosen
    velocity = velocities[best]
    if velocity is not None:
        survey.notes.append(f"{velocity!r} is the derivative of {best!r}")
    return best, velocity


def _velocity_of(
    name: str, moving: Mapping[str, SurveyedColumn], flat: Mapping[str, Array], h: float
) -> str | None:
    """The most likely column that is the derivative of another one; None: there is none.

    Those of another axis by their names are looked at where no other is the derivative.
    """
    others = {n: c for n, c in moving.items() if n != name and not is_no_velocity(c)}
    apart = {n for n in others if of_another_axis(n, name, moving)}
    for group in (others.keys() - apart, apart):
        scores: dict[str, tuple[float, float]] = {}
        for other in (n for n in others if n in group):
            column = others[other]
            agree = rate_agreement(flat[name], column.values, h)
            if agree < DERIVATIVE:
                continue
            scores[other] = score_of("velocity", column, left=1.0 - agree), agree
        if scores:
            return max(scores, key=scores.__getitem__)
    return None


def _followed_columns(
    may_be: Sequence[str], moving: Mapping[str, SurveyedColumn], flat: Mapping[str, Array]
) -> dict[str, str]:
    """Column -> the column that it follows as a position its set point, where no name tells."""
    free = [
        n for n in may_be if likeness(n, "position") < SURE_NAME and may_be_set_point(moving[n])
    ]
    ahead = [n for n in may_be if n in free or is_wanted(n)]
    pairs = ((n, m) for n, m in product(free, ahead) if n != m)
    return {n: m for n, m in pairs if lags(flat[n], flat[m])}


def _note_choice(
    survey: Survey,
    best: str,
    scores: Mapping[str, float],
    velocity: str | None,
    followed: Mapping[str, str],
) -> None:
    """Mark the chosen column as a guess, with the reason, where its name alone does not decide."""
    key, others = "channels.position.column", as_likely(scores, best)
    if likeness(best, "position") >= SURE_NAME:
        if others:
            survey.guesses[key] = explain_ambiguity(best, others, "the position")
        return
    if best in followed:
        why = f"it follows {followed[best]!r}, as a position follows its set point"
    elif velocity is not None:
        why = "another column is its derivative"
    elif likeness(best, "position") > 0 or is_unit_of(survey.columns[best].unit, "position"):
        why = "name or unit suggest a position"
    elif others:
        why = "its motion explains more of another column than those of other columns do"
    else:
        why = "it is the first column that moves"
    survey.guesses[key] = f"{best!r} is read as the position: {why}"


def score_beside(survey: Survey, position: str, velocity: str | None, x: Array) -> float:
    """The score of the other columns beside a position x (n,): one is a force, others its place."""
    h, columns = sample_time_of(survey), survey.columns
    beside = {n: c for n, c in columns.items() if not of_another_axis(n, position, columns)}
    trial = replace(survey, columns=beside)
    trial.relations = dict(relations_of(trial, position, velocity, x))
    free = possible_forces(trial, position, velocity)
    left = {n: left_in_turn(c.values, x, h) for n, c in free.items()}
    trial.explained = {n: 1.0 - by_motion for n, (_, by_motion) in left.items()}
    forces = score_forces(trial, position, free, False)
    places = [
        math.log(max(by_place, LEAST_LEFT))
        for n, (by_place, _) in left.items()
        if not is_named_force(free[n])
    ]
    return max(forces.values(), default=-math.inf) - sum(places)
