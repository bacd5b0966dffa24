"""The verdict of a ladder, by what its effects explain against what is left.

Every threshold is a field of `Criteria`.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Literal, Protocol

import numpy as np

from .adequacy import Errors, is_adequate
from .candidates import Candidate
from .criteria import CRITERIA, Criteria
from .learnable import Learnable
from .noise_floor import NoiseFloor
from .one_moment import Moment
from .repeats import Repeatability

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


def explained_share(
    before: Errors,
    after: Errors,
    floor: NoiseFloor,
    *,
    last: Errors | None = None,
    open_part: float = 1.0,
) -> float:
    """G / (G + L), 0 to 1: what the effects added between two fits explain, against what is left.

    The smaller of two shares: of the force, and of the force referred to the command.
    G: squares that they remove
    L: squares that the last fit leaves above the noise floor, times the part of them that another
        effect could explain;  last: `after` where None;  open_part: see `open_to_others`
    """
    fits = (before, after, last or after)
    return min(
        removed_share([f.check_error for f in fits], floor.value, open_part),
        removed_share([f.check_error_at_command for f in fits], floor.value_at_command, open_part),
    )


def removed_share(errors: Sequence[float], floor: float, open_part: float = 1.0) -> float:
    """`explained_share` of one kind of error: before, after, and of the last fit."""
    before, after, last = errors
    # no step explains more of the force than the last fit, as of a model with a turned sign
    gain = min(before**2 - after**2, 1.0 - last**2)
    left = open_part * max(last**2 - floor**2, 0.0)  # NaN where all is blind: nothing is explained
    return gain / (gain + left) if gain > 0.0 and np.isfinite(left) else 0.0


def open_to_others(
    trees: Learnable | None,
    after: Errors,
    repeats: Repeatability | None = None,
    *,
    criteria: Criteria = CRITERIA,
) -> float:
    """Part of the squares left by a fit that another effect could explain, 0 to 1.

    Another effect would be a function of the motion, so neither a residual that differs from pass
    to pass of the same motion nor one that cannot be learned from the motion hides one; the smaller
    part counts.
    trees: errors of the black box;  repeats: of the fit's residual;  None: not known
    """
    repeating = 1.0
    if repeats is not None and repeats.left > 0.0:
        same = float(np.clip(1.0 - (repeats.error / repeats.left) ** 2, criteria.missed, 1.0))
        repeating = 1.0 - repeats.squares * (1.0 - same)
    return min(repeating, _open_to_trees(trees, after, criteria))


def _open_to_trees(trees: Learnable | None, after: Errors, criteria: Criteria) -> float:
    """Part of the squares left by a fit that a black box could learn, or would not detect, 0 to 1.

    If a black box that predicts the force from
    the motion alone leaves no more than the model, it would detect any force as large as the
    residual; if it leaves twice the squares, it would not. A residual that it would detect but
    cannot learn does not repeat, except for a part (`Criteria.missed`) that it may miss.
    returns: 1 without a black box
    """
    error = after.check_error
    if trees is None or not (error > 0.0 and trees.left > 0.0):
        return 1.0
    sees = float(np.clip(2.0 - (trees.alone / error) ** 2, 0.0, 1.0))
    learned = float(np.clip(1.0 - (trees.error / trees.left) ** 2, criteria.missed, 1.0))
    return 1.0 - sees * (1.0 - learned)


def verdict(
    rungs: Sequence[Step],
    floor: NoiseFloor,
    moment: Moment | None = None,
    *,
    trees: Learnable | None = None,
    repeats: Repeatability | None = None,
    criteria: Criteria = CRITERIA,
) -> VerdictName:
    """The verdict by the errors of the rungs alone, whatever the probabilities of their effects.

    moment: from `moment_above_noise`; a residual at one moment only is no missing physics
    trees, repeats: without both, another effect could explain all that is left
    """
    added = [r for r in rungs if r.added is not None]
    if not added:
        adequate = is_adequate(rungs[-1].errors, floor, criteria=criteria) or moment is not None
        return "model_adequate" if adequate else "undecided"
    last = rungs[-1].errors
    open_part = open_to_others(trees, last, repeats, criteria=criteria)
    part = explained_share(rungs[0].errors, last, floor, open_part=open_part)
    if part < criteria.mostly or all(r.alternatives for r in added):
        return "undecided"
    return "effects_missing"
