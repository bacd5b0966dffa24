"""Columns of a log that are the position once more, in another unit, or computed from it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..encoder import reading_step
from ..first_guess import SURELY, explain_force, goes_one_way, motion_columns
from ..law_of_readings import FEWEST_STEPS, LOST, is_copy, law_of_readings, spring_of_copy
from .content import Array
from .set_point import has_numbers_of, lags

#: fits of a line to the half of the rows that lies nearest to it: each leaves out rows further off
FITS = 4
#: part of its travel that a body crosses between two rows at most: the command of a relay jumps
#: over all of its range
JUMP = 0.5
#: coefficients of a cubic: one position as a function of another bends at both ends at most; and
#: the part of the squares of a position that it leaves
POWERS, OF_A_POSITION = 4, 0.01


def repeats_mostly(column: Array, other: Array) -> bool:
    """Whether a column is a straight line of another one in most rows, up to rounding.

    So is a set point that is logged once more in another unit or with the other sign, also where
    the two are written a row apart or begin apart.
    """
    near = np.ones(len(column), dtype=bool)
    for _ in range(FITS):  # the rows that lie nearer to a line than the others tell the line
        x, y = other[near] - other[near].mean(), column[near] - column[near].mean()
        power = float(x @ x)
        if power == 0.0:
            return False
        slope = float(x @ y) / power
        off = np.abs(column - column[near].mean() - slope * (other - other[near].mean()))
        near = off <= np.median(off)
    rounding = abs(slope) * reading_step(other) + reading_step(column)
    reach = float(np.ptp(column))
    exact = off <= rounding + LOST * reach
    return rounding * FEWEST_STEPS <= reach and 2 * int(exact.sum()) > len(column)


def follows(column: Array, position: Array, sample_time: float) -> bool:
    """Whether a column (n,) follows a position as a second position behind a gear or spring does.

    A cubic of the position then leaves next to nothing of it, in which no friction is certain: that
    is part of a force. Along a motion one way everything that rises is a function of the position,
    and nothing is said.
    """
    if goes_one_way(motion_columns(position, sample_time)[2]):
        return False
    place = (position - position.mean()) / max(float(np.ptp(position)), np.finfo(float).tiny)
    powers = np.vander(place, POWERS)
    rest = column - powers @ np.linalg.lstsq(powers, column, rcond=None)[0]
    if np.var(rest) >= OF_A_POSITION * np.var(column):
        return False
    guess = explain_force(rest, position, sample_time)
    brakes = zip((guess.level, guess.damping), guess.errors[1:], strict=True)
    return not any(abs(value) > SURELY * error for value, error in brakes)


def pulls_back(command: Array, position: Array, h: float) -> bool:
    """Whether a controller computes a command from the position so that it pulls back.

    Where a hand moves a device against such a law, the damper of the controller drives as friction
    with a wrong sign would.

    h: time between two rows
    """
    law = spring_of_copy(command, position)
    law = law or law_of_readings(command, position, [slice(0, len(command))], sample_time=h)
    return law is not None and law.stiffness > 0.0


def _jumps(column: Array) -> bool:
    """Whether a column crosses a large part of its range between two rows, as no body does."""
    return float(np.max(np.abs(np.diff(column)))) > JUMP * float(np.ptp(column))


def most_explained(names: list[str], flat: Mapping[str, Array], h: float) -> str:
    """That of equally likely positions whose motion explains most of any other column.

    Of two with the same numbers it is the later one: the earlier one is the path that was planned.
    A set point is no such column: friction alone explains the steps of a set point that the
    position reaches.

    flat: values (n,) of the columns, by name;  h: time between two rows
    """
    if len(names) == 1:
        return names[0]
    names = [n for n in names if not _jumps(flat[n])] or names
    shares = {
        name: max(
            (
                explain_force(f, flat[name], h).explained
                for n, f in flat.items()
                if n != name and not is_copy(f, flat[name]) and not has_numbers_of(f, flat[name])
            ),
            default=0.0,
        )
        for name in names
    }
    best = max(shares, key=lambda name: shares[name])
    return next((name for name in names if lags(flat[name], flat[best])), best)
