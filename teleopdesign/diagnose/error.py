"""The force error: rms of the residual force relative to the measured force.

    error = rms(LP residual) / rms(LP (actuator force + interaction force)),  without the ends

LP is the zero-phase low-pass at the comparison's bandwidth; sums of squares run over all bodies,
records and segments of one use ("fit" or "check"). The ends of each record do not count.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..measurement.filtering import Array
from ..measurement.prepare import Stretch
from ..model import Model
from .residual import residuals


def error_of(stretches: Sequence[Stretch], values: Sequence[Array]) -> float:
    """The force error of these stretches, from the low-passed residual of each (N or N m)."""
    with np.errstate(over="ignore"):  # inf where a hidden body grew beyond all numbers
        left = sum(s.weight * float(np.sum(r**2)) for s, r in zip(stretches, values, strict=True))
    whole = sum(s.measured for s in stretches)
    return float(np.sqrt(left / whole))


def weigh_residuals(stretches: Sequence[Stretch], values: Sequence[Array]) -> Array:
    """Residuals of all stretches in one array, each row times the square root of its weight.

    The weight of a row is the number of rows that it represents.
    """
    parts = [np.sqrt(s.weight) * r for s, r in zip(stretches, values, strict=True)]
    return np.concatenate(parts) if parts else np.zeros(0)


def force_error(model: Model, stretches: Sequence[Stretch]) -> float:
    """Relative force error of a model on these stretches, without estimation; NaN: no stretch."""
    if not stretches:
        return float("nan")
    return error_of(stretches, [r for r, _ in residuals(model, stretches)])
