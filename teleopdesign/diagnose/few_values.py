"""How many independent values a model fails at: too few let any effect describe them.

Below a bandwidth B a signal holds 2 B independent values a second. A motor that moves three times
for a third of a second, and rests in between, shows friction and inertia in a few of them only. An
effect with a hidden state then passes through all of them, whatever the machine is.
"""

from __future__ import annotations

import numpy as np

from ..measurement.filtering import Array
from ..measurement.prepare import Prepared
from .criteria import CRITERIA, Criteria
from .fit import Fit


def explain_few_values(
    base: Fit, fit: Fit, prepared: Prepared, *, criteria: Criteria = CRITERIA
) -> str:
    """Why the fit records cannot support a larger model, as a sentence; "": they can."""
    values, parameters = independent_values(base.fit_residual, prepared), len(fit.free)
    if not values < criteria.for_each * parameters:
        return ""
    return (
        f"the model fails at only about {max(values, 1.0):.0f} independent values of the fit "
        f"records, and has {parameters} parameters with this effect: any effect could describe them"
    )


def independent_values(residual: Array, prepared: Prepared) -> float:
    """Number of independent values, below the bandwidth, that hold most of a residual's squares.

    residual: (n,) of the rows that count of the fit records
    returns: inf for a residual of zero, and without rows
    """
    size = float(np.max(np.abs(residual), initial=0.0))
    if not (size > 0.0 and np.isfinite(size)):
        return float("inf")
    squares = (residual / size) ** 2
    # of normal noise, which fails everywhere, the mean fourth power is three squared mean squares
    part = 3.0 * float(np.mean(squares) ** 2 / np.mean(squares**2))
    seconds = sum(s.counted_time for s in prepared.of("fit"))
    return 2.0 * prepared.bandwidth * seconds * min(part, 1.0)
