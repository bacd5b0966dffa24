"""The unit prefix that suits the values on an axis: 0.012 m as 12 mm."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...base.finding import Array
from ...base.sentences import unit_on_page as unit_text

#: SI unit -> (unit that is shown, factor), from small to large; other units are not changed
_SHOWN = {
    "m": (("µm", 1e6), ("mm", 1e3), ("m", 1.0)),
    "m/s": (("µm/s", 1e6), ("mm/s", 1e3), ("m/s", 1.0)),
    "N": (("mN", 1e3), ("N", 1.0)),
    "N*m": (("mN·m", 1e3), ("N·m", 1.0)),
    "rad": (("mrad", 1e3), ("rad", 1.0)),
    "rad/s": (("mrad/s", 1e3), ("rad/s", 1.0)),
}


@dataclass(frozen=True)
class Scaled:
    """A unit for display, and the factor from SI to it."""

    unit: str
    factor: float


def choose_prefix(unit: str, size: float) -> Scaled:
    """The largest prefix in which `size` (SI) is at least 0.5, or the smallest that exists."""
    choices = _SHOWN.get(unit, ((unit_text(unit), 1.0),))
    for shown, factor in reversed(choices):
        if size * factor >= 0.5:
            return Scaled(shown, factor)
    return Scaled(*choices[0])


def size_of(values: Array) -> float:
    """Size of values: the 98 % quantile of their magnitudes."""
    return float(np.quantile(np.abs(values), 0.98))
