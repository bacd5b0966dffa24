"""What one linear step from a start promises: the sum of squares that it would leave.

Many starts of an effect differ at one body only. The other bodies are computed once for all of
them.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Sequence

import numpy as np

from ..measurement.filtering import Array
from ..measurement.prepare import Prepared
from ..model import Model
from .bodies_apart import Apart, separate_bodies
from .fit import Fit, free_parameters
from .least_squares import RIDGE, add_damping, reduce_to_triangle, sum_of_squares


class Promises:
    """Sums of squares after one linear step from starts of one model.

    base: the fit of the model without its new effects, on the same samples
    """

    def __init__(self, prepared: Prepared, base: Fit) -> None:
        self._base, self._scales = base, prepared.scales
        self._parts = separate_bodies(prepared.of("fit"))
        self._known: dict[Hashable, tuple[Array, Array]] = {}

    def squares(self, model: Model) -> float:
        """Sum of squares after one step from this start, by all free parameters."""
        base, values, before = self._base, model.parameters, self._base.model.parameters
        same = all(values[n].value == before[n].value for n in base.free)
        wanted = [n for n in free_parameters(model) if not (same and n in base.free)]
        places = [model.locate(n)[0] for n in wanted]
        size = np.array([self._scales[model.declared(n).quantity] for n in wanted])
        residual = base.fit_residual.copy()
        columns = np.zeros((len(residual), len(wanted)))
        for part in self._parts:
            mine = np.flatnonzero([place in part.bodies for place in places])
            if len(mine) or not wanted:
                here = self._along(part, model, [wanted[i] for i in mine])
                residual[part.rows] = here[0]
                columns[np.ix_(part.rows, mine)] = here[1] * size[mine]
        whole = np.hstack([base.jacobian, base.by_shift, columns]) if same else columns
        is_number = np.isfinite(whole).all() and np.isfinite(residual).all()
        return _remaining_squares(whole, residual) if is_number else math.inf

    def _along(self, part: Apart, model: Model, names: Sequence[str]) -> tuple[Array, Array]:
        """Residual and derivatives of some bodies, computed once for equal parameters of theirs."""
        values = model.parameters.items()
        theirs = tuple((n, v.value) for n, v in values if model.locate(n)[0] in part.bodies)
        start = (part.bodies, tuple(names), theirs)
        if start not in self._known:
            self._known[start] = part.relative(model, names)
        return self._known[start]


def _remaining_squares(columns: Array, residual: Array) -> float:
    """Squares of the residual that no combination of these columns removes."""
    size, triangle, target = reduce_to_triangle(columns, residual)
    if not np.isfinite(size).all():
        return math.inf
    rows, right = add_damping(triangle, target, RIDGE)
    step = np.linalg.lstsq(rows, right, rcond=None)[0]
    # least squares: the step is at right angles to what it leaves
    return sum_of_squares(residual) - float(right @ (rows @ step))
