"""Minima of rugged functions of few variables, by the simplex method of Nelder and Mead (1965)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..measurement.filtering import Array
from .search_plan import PLAN


def minimise_nearby(
    function: Callable[[Array], float],
    start: Array,
    *,
    evaluations: int,
    reach: float | None = None,
) -> Array:
    """The variables (n,), logarithms of parameters, of the least value near a start.

    evaluations: most evaluations of the function
    reach: largest distance from the start along each variable; None: any
    """
    from scipy.optimize import minimize  # takes half a second: imported only for a gap or a gear

    corners = np.vstack([start, start + PLAN.simplex * np.eye(len(start))])
    bounds = None if reach is None else [(x - reach, x + reach) for x in start.tolist()]
    best = minimize(
        function,
        start,
        method="Nelder-Mead",
        bounds=bounds,
        options={"maxfev": evaluations, "initial_simplex": corners},
    )
    return np.asarray(best.x)
