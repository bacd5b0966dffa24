"""Whether records determine what an effect adds to a model."""

from __future__ import annotations

import numpy as np

from .candidates import Candidate
from .criteria import CRITERIA, Criteria
from .fit import Fit


def is_identifiable(fit: Fit, base: Fit, *, criteria: Criteria = CRITERIA) -> bool:
    """Whether the new parameters are determined and the base's parameters cannot imitate them.

    Each must be further from absence than its standard error (an angle within half a turn) unless
    the effect is there without it, what is essential to it surely so, and some must change the
    residual in a way of its own.
    """
    new = [i for i, n in enumerate(fit.free) if n not in base.free]
    for i in new:
        name = fit.free[i]
        value, declared = fit.model.parameters[name], fit.model.declared(name)
        if declared.optional:
            continue
        away = np.pi if declared.quantity == "angle" else fit.model.from_absence(name)
        if not value.stderr * (criteria.surely if declared.search.essential else 1.0) < away:
            return False
    old = [i for i, n in enumerate(fit.free) if n in base.free]
    for i in new:
        column = fit.jacobian[:, i]
        size = float(np.linalg.norm(column))
        if size == 0.0:
            continue
        if not old:
            return True
        old_columns = fit.jacobian[:, old]
        rest = column - old_columns @ np.linalg.lstsq(old_columns, column, rcond=1e-10)[0]
        if float(np.linalg.norm(rest)) > criteria.own_column * size:
            return True
    return False


def doubt(fit: Fit, candidate: Candidate) -> str:
    """Which parameter an accepted effect stands on and the stated errors do not tell from absence.

    By the errors at the end of a ladder, which hold what the readings themselves bring in. Others
    of its parameters may be open. "": none
    """
    for name, declared in candidate.effect.parameters.items():
        full = f"{candidate.at}.{candidate.effect.name}.{name}"
        absent = candidate.effect.absent.get(name)
        strength = absent is not None and np.isfinite(absent)
        if full not in fit.free or declared.optional:
            continue
        if not (strength or declared.search.essential):
            continue
        value = fit.model.parameters[full]
        if not value.stderr < fit.model.from_absence(full):
            unit = fit.model.unit(full)
            return (
                f"{name} = {value.value:.3g} +- {value.stderr:.2g} {unit} is not told from absence "
                "by the errors of the readings"
            )
    return ""
