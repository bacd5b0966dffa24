"""Assumptions of a design about values that no record shows; each can be stated by the user.

They contain the sampling of the controllers in simulation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..base.arguments import check_types
from ..base.errors import ModelError
from ..blocks import NINETY_FIVE
from ..realise.reach import Reach
from ..simulate import Sampling


@check_types
@dataclass(frozen=True)
class Assumptions:
    """Assumptions of a design, SI. None: derived from the record, as `design` says.

    load: inertia that stands for the hand, kg or kg m^2; None: three times that of the device
    sample_period: of the controller, s; None: that of the record
    delay: from a sample to the change of the command, s; None: one sample period
    bandwidth: of the low-pass in H, Hz
    velocity_bandwidth: of the filter on the differenced position, Hz; None: 50, at most 0.1/period
    errors: half width of the interval of a level, in standard errors; 1.96: 95 %
    fraction: part of the least level in this interval that is cancelled, at most 1
    delay_factor: H remains stable with this multiple of the delay of its loop
    count_force: part of the level by which one encoder count may change a smoothed cancellation
    counts: encoder counts in the bristle length of a Dahl cancellation
    amplitude, frequency: of the predicted motion, m or rad, Hz; None: from the record
    """

    load: float | None = None
    sample_period: float | None = None
    delay: float | None = None
    bandwidth: float = 20.0
    velocity_bandwidth: float | None = None
    errors: float = NINETY_FIVE
    fraction: float = 0.9
    delay_factor: float = 3.0
    count_force: float = 0.25
    counts: float = 10.0
    amplitude: float | None = None
    frequency: float | None = None

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if value is None:
                continue
            least = 0.0 if name in ("errors", "delay") else math.ulp(0.0)
            most = 1.0 if name in ("fraction", "count_force") else math.inf
            if not (math.isfinite(value) and least <= value <= most):
                words = "above 0, at most 1" if most == 1.0 else "a finite number above 0"
                raise ModelError(f"design: {name}: found {value:g}, expected {words}")
        if self.delay_factor < 1.0:
            raise ModelError(
                f"design: delay_factor: found {self.delay_factor:g}, expected 1 or more"
            )


def sampling_of(assumptions: Assumptions, reach: Reach) -> Sampling:
    """The sampling that the assumptions state, with the encoder of the record.

    assumptions: complete: period, delay and velocity filter are numbers
    """
    period, delay, filtered = (
        assumptions.sample_period,
        assumptions.delay,
        assumptions.velocity_bandwidth,
    )
    assert period is not None and delay is not None and filtered is not None
    return Sampling(
        period=period,
        # in tenths of a sample, the inner steps of the simulation
        delay=round(10 * delay / period) * period / 10,
        encoder_step=reach.step,
        velocity_bandwidth=filtered,
    )
