"""What an effect of a controller block is: one operation on a row of samples, one parameter."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..._parameter import Parameter

Array = NDArray[np.float64]

#: order in which the effects of one block act; the law stands between the first and the second
ORDER = ("velocity_filter", "gain", "bias", "lag", "delay", "dead_zone", "saturation")


@dataclass(frozen=True)
class ControlEffect:
    """An effect on samples (n,) of a block's output, or of the velocity that its law uses.

    act(samples, value, period): the samples with the effect;  value: of the parameter, SI;
        period: of the computer, s
    parameter: the name of its parameter;  declared: its quantity, meaning and bounds
    starts(samples, period): values of the parameter at which a fit begins
    passes(samples, value): the rows whose input still changes the output; None: all rows
    absent: value of the parameter at which there is no effect
    on_velocity: acts on the velocity in front of the law, not on the output behind it
    of_law: no effect, but a parameter of the law itself that is free
    """

    act: Callable[[Array, float, float], Array]
    parameter: str
    declared: Parameter
    starts: Callable[[Array, float], Array]
    passes: Callable[[Array, float], NDArray[np.bool_]] | None = None
    on_velocity: bool = False
    of_law: bool = False
    absent: float = 0.0
    name: str = ""
    text: str = field(default="", repr=False)


def times(samples: Array, period: float) -> Array:
    """Start values of a time constant, s: half a period to a fifth of a second.

    A slower filter than 0.2 s has the same shape below any usual bandwidth.
    """
    return np.geomspace(0.5 * period, max(0.2, 2.0 * period), 12)


def amplitudes(samples: Array, period: float) -> Array:
    """Start values of a level of the output: parts of its largest value."""
    largest = float(np.abs(samples).max(initial=0.0))
    return largest * np.array([0.01, 0.03, 0.1, 0.2, 0.35, 0.5, 0.7, 0.9])
