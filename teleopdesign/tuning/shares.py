"""Values scaled to 0..1 of their intervals, logarithmically where an interval is wide."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..base.errors import ModelError
from ..base.expectations import describe_value
from ..passivity.intervals.box import ValueBox

#: intervals whose ends differ by more than this factor are searched in logarithms
_WIDE = 9.9
#: a parameter is at an end of its interval if it is nearer than this share of the interval
AT_END = 0.01


def box_of_parameters(parameters: Mapping[str, tuple[float, float]]) -> ValueBox:
    """The intervals of the searched parameters.

    raises ModelError: no parameter, or no interval (low, high)
    """
    if not parameters:
        raise ModelError("parameters: found none, expected a name with (low, high)")
    for name, ends in parameters.items():
        if len(ends) != 2 or not all(map(np.isfinite, ends)) or not ends[0] < ends[1]:
            raise ModelError(
                f"parameters: {name}: found {describe_value(ends)}, expected (low, high)"
            )
    low, high = (tuple(float(ends[k]) for ends in parameters.values()) for k in (0, 1))
    return ValueBox(tuple(parameters), low, high)


def unit_box(names: tuple[str, ...]) -> ValueBox:
    """The box of all shares."""
    return ValueBox(names, (0.0,) * len(names), (1.0,) * len(names))


def is_logarithmic(box: ValueBox) -> np.ndarray:
    """Mask (n,) of the parameters that are searched in logarithms."""
    low, high = np.array(box.low), np.array(box.high)
    return np.asarray((low > 0) & (high > _WIDE * low))


def values_at(box: ValueBox, shares: np.ndarray) -> np.ndarray:
    """Values at shares of the intervals, (..., n)."""
    low, high, logarithmic = np.array(box.low), np.array(box.high), is_logarithmic(box)
    safe = np.where(logarithmic, low, 1.0)
    ratio = np.where(logarithmic, high / safe, 1.0)
    share = np.clip(shares, 0, 1)
    inside = np.where(logarithmic, safe * ratio**share, low + share * (high - low))
    return np.asarray(np.clip(inside, low, high))


def shares_of(box: ValueBox, values: np.ndarray) -> np.ndarray:
    """Shares of the intervals at values, (n,)."""
    low, high, is_wide = np.array(box.low), np.array(box.high), is_logarithmic(box)
    safe, x = np.where(is_wide, low, 1.0), np.clip(values, low, high)
    logarithmic = np.log(np.where(is_wide, x, 1.0) / safe) / np.log(
        np.where(is_wide, high / safe, 2)
    )
    return np.asarray(np.where(is_wide, logarithmic, (x - low) / (high - low)))


def units_at(box: ValueBox, values: np.ndarray) -> np.ndarray:
    """Derivative of the values by their shares, (n,), SI."""
    low, high, logarithmic = np.array(box.low), np.array(box.high), is_logarithmic(box)
    ratio = np.where(logarithmic, high / np.where(logarithmic, low, 1.0), 1.0)
    return np.asarray(np.where(logarithmic, values * np.log(ratio), high - low))
