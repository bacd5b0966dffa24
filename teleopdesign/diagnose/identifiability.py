"""Whether records determine what an effect adds to a model."""

from __future__ import annotations

import numpy as np

from .criteria import CRITERIA, Criteria
from .fit import Fit


def is_identifiable(found: Fit, base: Fit, *, criteria: Criteria = CRITERIA) -> bool:
    """Whether the new parameters are determined and do what the base's cannot imitate.

    Each must be further from absence than its standard error (an angle within half a turn) unless
    the effect is there without it, what is essential to it surely so, and some must change the
    residual in a way of its own.
    """
    new = [i for i, n in enumerate(found.free) if n not in base.free]
    for i in new:
        name = found.free[i]
        value, declared = found.model.parameters[name], found.model.declared(name)
        if declared.optional:
            continue
        away = np.pi if declared.quantity == "angle" else found.model.from_absence(name)
        if not value.stderr * (criteria.surely if declared.search.essential else 1.0) < away:
            return False
    old = [i for i, n in enumerate(found.free) if n in base.free]
    for i in new:
        column = found.jacobian[:, i]
        size = float(np.linalg.norm(column))
        if size == 0.0:
            continue
        if not old:
            return True
        own = found.jacobian[:, old]
        rest = column - own @ np.linalg.lstsq(own, column, rcond=1e-10)[0]
        if float(np.linalg.norm(rest)) > criteria.own_column * size:
            return True
    return False
