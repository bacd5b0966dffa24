"""Motions of other bodies among columns without names: a position and its derivative."""

from __future__ import annotations

from collections.abc import Mapping

from ..law_of_readings import is_copy
from .content import Array
from .derivative import DERIVATIVE, EXACT, derivative_factor, follows_direction, has_both_signs
from .set_point import has_numbers_of

#: part of what the position leaves of a velocity, below which another column is its position: two
#: joints that move alike explain most of each other's velocities, and a spring's force is nearly a
#: copy of its position
CLEARLY_LESS = 0.5

Agreements = Mapping[str, Mapping[str, float]]


def agreements(columns: Mapping[str, Array], h: float) -> dict[str, dict[str, float]]:
    """Column -> other column -> correlation between the derivative of the first and the second.

    columns: (n,) each, those without names;  h: time between two rows, s
    """
    return {
        one: {other: derivative_factor(x, v, h)[1] for other, v in columns.items() if other != one}
        for one, x in columns.items()
    }


def planned_paths(rates: Agreements) -> set[str]:
    """The columns without name that hold position, velocity and acceleration of planned paths.

    Each is exactly the derivative of the one before. Two such columns alone tell less: the friction
    of a body that goes to and fro at one speed is the derivative of its position, too.
    """
    exact = {one: [n for n, a in of.items() if a > EXACT] for one, of in rates.items()}
    chains = ((a, b, c) for a, after in exact.items() for b in after for c in exact[b])
    return {name for chain in chains if len(set(chain)) == 3 for name in chain}


def other_motions(
    rates: Agreements, columns: Mapping[str, Array], x: Array, h: float
) -> dict[str, str]:
    """Column -> its velocity, for the positions of other bodies than that with the position x (n,).

    columns: (n,) each, those without names.  A velocity belongs to the column whose derivative it
        is most exactly
    """
    motions: dict[str, str] = {}
    if len(columns) < 2:
        return motions
    for name, values in columns.items():
        agree, place = max((of[name], one) for one, of in rates.items() if name in of)
        if agree <= DERIVATIVE or has_numbers_of(columns[place], x) or is_copy(columns[place], x):
            continue
        beside = abs(derivative_factor(x, values, h)[1])
        if 1.0 - agree > CLEARLY_LESS * (1.0 - beside):
            continue
        if derivative_factor(x, columns[place], h)[1] > DERIVATIVE:
            continue  # the velocity of this body: its derivative is a force of inertia
        friction = follows_direction(columns[place], values, h)
        if not friction and has_both_signs(columns[place], values, h):
            motions[place] = name
    speeds = set(motions.values())
    return {place: name for place, name in motions.items() if place not in speeds}
