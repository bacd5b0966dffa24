"""Motion that the position readings hide: where no direction is certain, friction holds any force.

The higher the bandwidth of the comparison, the more reading error is in the velocity. Rows in which
it cannot be distinguished from rest test no model with dry friction.
"""

from __future__ import annotations

from dataclasses import dataclass

from .bandwidth import hides_motion, share_in_motion
from .experiment import Experiment

#: a bandwidth is proposed if the rows in motion are at least this part of those at a bandwidth two
#: octaves lower
ENOUGH = 0.9


@dataclass(frozen=True)
class HiddenMotion:
    """A bandwidth (Hz) at which far fewer rows of a body show a motion than at a lower one.

    moving, could: share of the rows (0 to 1) at `bandwidth` and two octaves below
    proposed: the highest bandwidth (Hz) that shows most of the motion, in the share `shown`
    """

    body: str
    bandwidth: float
    moving: float
    could: float
    proposed: float
    shown: float

    def __str__(self) -> str:
        return (
            f"below {self.bandwidth:.3g} Hz, the bandwidth of the comparison, the position tells a "
            f"motion in {100 * self.moving:.0f} % of the rows, below {self.proposed:.2g} Hz in "
            f"{100 * self.shown:.0f} %. In the other rows static friction balances any force, and "
            f"no model is tested: write bandwidth = {{ value = {self.proposed:.2g}, "
            'unit = "Hz" } at comparison, or leave it out.'
        )


def find_hidden_motion(experiment: Experiment, body: str, bandwidth: float) -> HiddenMotion | None:
    """What a bandwidth (Hz) hides of a body's motion, and one that does not; None: little."""
    if not hides_motion(experiment, body, bandwidth):
        return None
    shares = {b: share_in_motion(experiment, body, b) for b in (bandwidth / 2, bandwidth / 4)}
    moving, could = share_in_motion(experiment, body, bandwidth), shares[bandwidth / 4]
    proposed = max(b for b, share in shares.items() if share >= ENOUGH * could)
    return HiddenMotion(body, bandwidth, moving, could, proposed, shares[proposed])
