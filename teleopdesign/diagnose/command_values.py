"""The search for a body's parameters together with values on which its command depends.

Where the laws of a computer give the command, an effect in a law moves it: each value is one more
coordinate of the search, its derivative a difference.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ..measurement.filtering import Array
from ..measurement.prepare import Prepared, Stretch
from ..model import Model
from .least_squares import minimise
from .search_plan import Effort
from .solve import SearchProblem, search_problem

#: step of a value of size one, for a derivative
_STEP = 1e-4


@dataclass(frozen=True, eq=False)
class CommandValues:
    """k values of size one on which the command of a body depends.

    stretches: the fit records with the command at other values;  start, lower, upper: (k,)
    """

    stretches: Callable[[Array], Sequence[Stretch]]
    start: Array
    lower: Array
    upper: Array


@dataclass(frozen=True, eq=False)
class CommandSolution:
    """A body and the values on which its command depends, at the optimum of both.

    values: (k,);  jacobian: (rows, k + p + shifts) derivative of the residual, by the values first
    """

    model: Model
    values: Array
    residual: Array
    jacobian: Array


def solve_with_command(
    model: Model, prepared: Prepared, command: CommandValues, effort: Effort
) -> CommandSolution:
    """As `solve` on the fit records, by the values of the command as well.

    prepared: the records, with any command of these values
    """
    count = len(command.start)

    def problem(x: Array) -> SearchProblem:
        return search_problem(model, prepared, command.stretches(x[:count]))

    def residual(x: Array) -> Array:
        return problem(x).residual_with_prior(x[count:])

    def both(x: Array) -> tuple[Array, Array]:
        here, jacobian = problem(x).with_prior(x[count:])
        columns = []
        for i in range(count):
            moved = x.copy()
            moved[i] += _STEP if x[i] + _STEP <= command.upper[i] else -_STEP
            columns.append((residual(moved) - here) / (moved[i] - x[i]))
        return here, np.hstack([np.column_stack(columns), jacobian])

    first = problem(command.start)
    minimum = minimise(
        both,
        np.append(command.start, first.start),
        np.append(command.lower, first.lower),
        np.append(command.upper, first.upper),
        tolerance=effort.tolerance,
        evaluations=effort.evaluations,
        residual_alone=residual,
    )
    rows, best = len(minimum.residual) - len(first.shifts.logs), minimum.values
    return CommandSolution(
        first.model_at(best[count:]),
        best[:count],
        minimum.residual[:rows],
        minimum.jacobian[:rows],
    )
