"""Sampling of a controller: period, computing delay, encoder, and its estimate of the velocity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ..base.arguments import check_types
from ..base.errors import ModelError, unknown


@check_types
@dataclass(frozen=True)
class Sampling:
    """How a computer samples positions, and when its commands act.

    period: s;  delay: from a sample to the change of the command, s; simulated in whole steps,
        refused where these differ from it by more than 2 %
    encoder_step: m or rad; 0: no quantisation
    velocity: estimate of the velocity: "difference" of readings; "filtered": the difference through
        a first-order low-pass; "observer" of position, velocity and, at order 3, acceleration
    velocity_bandwidth: of the low-pass, or of all poles of the observer, Hz; inf: no low-pass
    observer_order: 2: least noise, delayed by two time constants; 3: no delay in slow motion
    raises ModelError: another name or order, an observer without bandwidth

        >>> td.Sampling(period=1e-3, delay=2e-4, velocity_bandwidth=100.0).velocity
        'filtered'
    """

    period: float = 1e-3
    delay: float = 0.0
    encoder_step: float = 0.0
    velocity_bandwidth: float = float("inf")
    velocity: Literal["difference", "filtered", "observer"] = "filtered"
    observer_order: Literal[2, 3] = 3

    def __post_init__(self) -> None:
        names = ("difference", "filtered", "observer")
        if self.velocity not in names:
            raise ModelError(f"Sampling: {unknown('velocity', self.velocity, names)}")
        if not 0 < self.period < float("inf") or min(self.delay, self.encoder_step) < 0:
            raise ModelError(
                "Sampling: expected a period > 0 s, delay and encoder_step >= 0, found "
                f"{self.period:g}, {self.delay:g}, {self.encoder_step:g}"
            )
        bounded = self.velocity_bandwidth < float("inf")
        if self.velocity == "difference" and bounded:
            raise ModelError(
                'Sampling: a velocity by "difference" has no bandwidth: leave velocity_bandwidth '
                'away, or take "filtered"'
            )
        if self.velocity == "observer" and not bounded:
            raise ModelError("Sampling: an observer needs a velocity_bandwidth, Hz")
        if self.observer_order not in (2, 3):
            raise ModelError(f"Sampling: observer_order is 2 or 3, found {self.observer_order}")

    @property
    def observer(self) -> int:
        """Order of the velocity observer; 0: no observer."""
        return self.observer_order if self.velocity == "observer" else 0


SAMPLED = Sampling()
