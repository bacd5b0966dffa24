"""Accuracy of a fit for each purpose: number of evaluations and relative change of squares."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Effort:
    """When a fit ends: relative change of the sum of squares, and most evaluations."""

    tolerance: float
    evaluations: int


@dataclass(frozen=True)
class Efforts:
    """An effort for each purpose; `EFFORTS` are those in use. Less effort is faster."""

    #: a few real steps: enough to see which of many starts lead down
    first_steps: Effort = Effort(1e-3, 4)
    #: blocks that are held out in turn: the step to the optimum without a block mostly is linear;
    #: where it is not, each fit begins next to its optimum
    held_out: Effort = Effort(1e-3, 5)
    #: candidates before they are ranked: closer than they differ
    rough: Effort = Effort(1e-4, 12)
    #: candidates that were followed to the optimum on few samples: what all samples move is less
    #: than that; those that contend are fitted finely afterwards
    near: Effort = Effort(1e-3, 6)
    #: readings of a simulated motion: closer than their spread
    again: Effort = Effort(1e-5, 12)
    #: what is reported: far below standard errors
    fine: Effort = Effort(1e-7, 60)
    #: residuals and derivatives alone: the values stay where they are
    stay: Effort = Effort(1.0, 1)
    #: squares of what a body's residual changes by, over the squares themselves and over the
    #: tolerance, up to
    #: which the residual follows its tangents: what they miss is of higher order. More: faster, and
    #: fits end where the tangents lead
    followed: float = 0.1
    #: part of each coordinate, or of its scale, within which tangents are followed, however little
    #: changes. Larger: faster, and along a valley of nearly equal squares a fit is led astray by
    #: its bend (on one recording with slipping elements to 5.0 % where 3.1 % can be reached)
    followed_within: float = 1e-3


#: the efforts in use
EFFORTS = Efforts()
