"""The verdict of a ladder, by what its effects explain against what is left.

Every threshold is a field of `Criteria`.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Literal, Protocol

import numpy as np

from .adequacy import Errors, is_adequate
from .candidates import Candidate
from .noise_floor import NoiseFloor

#: how a diagnosis ends
VerdictName = Literal["effects_missing", "model_adequate", "undecided"]


class Step(Protocol):
    """A step of a ladder: the added effect, its look-alikes on the records, and the errors."""

    @property
    def added(self) -> Candidate | None: ...
    @property
    def alternatives(self) -> Collection[object]: ...
    @property
    def errors(self) -> Errors: ...


def explained_share(before: Errors, after: Errors, floor: NoiseFloor) -> float:
    """G / (G + L), 0 to 1: what the effects added between two fits explain, against what is left.

    The smaller of two shares: of the force, and of the force referred to the command.
    G: squares that they remove;  L: squares that are left above the noise floor
    """
    fits = (before, after)
    return min(
        removed_share([f.check_error for f in fits], floor.value),
        removed_share([f.check_error_at_command for f in fits], floor.value_at_command),
    )


def removed_share(errors: Sequence[float], floor: float) -> float:
    """`explained_share` of one kind of error: before and after."""
    before, after = errors
    # no step explains more of the force than the last fit, as of a model with a turned sign
    gain = min(before**2 - after**2, 1.0 - after**2)
    left = max(after**2 - floor**2, 0.0)  # NaN where all is blind: nothing is explained
    return gain / (gain + left) if gain > 0.0 and np.isfinite(left) else 0.0


def verdict(rungs: Sequence[Step], floor: NoiseFloor) -> VerdictName:
    """The verdict by the rungs alone, whatever the probabilities of their effects."""
    added = [r for r in rungs if r.added is not None]
    if not added:
        adequate = is_adequate(rungs[-1].errors, floor)
        return "model_adequate" if adequate else "undecided"
    return "undecided" if all(r.alternatives for r in added) else "effects_missing"
