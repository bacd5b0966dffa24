"""What reading a motion by sensors does to estimates: their spread, and their shift.

Where a body sticks, friction balances, and where readings cannot tell a direction it may be
anything up to its level. That freedom shifts estimates in one way (levels up, dampings down) by
little, but by more than residuals tell: at the optimum they are as small as they can be. So the
motion is read off once more by its own sensors, and the shift that this second reading brings is
taken for the shift of the first.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..blocks import Value
from ..measurement.filtering import Array
from .fit import Fit, weighted
from .force_error import Prepared, referred
from .noise_floor import read_again

#: readings drawn anew
DRAWS = 8
#: part of the shift that a second reading shows: the smoothed motion that it starts from has lost
#: what the first reading hid. Set so that intervals cover on simulated records: docs/theory.md
SHOWN = 0.4


@dataclass(frozen=True)
class ReadingError:
    """Shift and spread of the free parameters, in their standard errors."""

    shift: Array
    spread: Array


def reading_error(found: Fit, prepared: Prepared, generator: np.random.Generator) -> ReadingError:
    """By how much readings drawn anew move the estimates of a fit, to first order."""
    stretches = prepared.of("fit")
    size = np.linalg.norm(found.jacobian, axis=0)
    size = np.where(size > 0, size, 1.0)
    inverse = np.linalg.pinv(found.jacobian / size, rcond=1e-6)
    moved = []
    for _ in range(DRAWS):
        drawn = [replace(s, motion=read_again(s, prepared, generator)) for s in stretches]
        after = weighted(drawn, [r for r, _ in referred(found.model, drawn)])
        moved.append(-(inverse @ (after - found.fit_residual)) / size)
    steps = np.array(moved)
    return ReadingError(steps.mean(axis=0), steps.std(axis=0, ddof=1))


def widened(found: Fit, prepared: Prepared, generator: np.random.Generator) -> Fit:
    """The fit with standard errors that hold the shift and spread of its readings too."""
    if not found.free:
        return found
    error = reading_error(found, prepared, generator)
    values: dict[str, Value | float] = {}
    for i, name in enumerate(found.free):
        value = found.model.parameters[name]
        more = found.scale[i] * np.hypot(error.spread[i], error.shift[i] / SHOWN)
        values[name] = replace(value, stderr=float(np.hypot(value.stderr, more)))
    return replace(found, model=found.model.with_values(values))
