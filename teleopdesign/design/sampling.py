"""Sampling of the controllers of a design in simulation."""

from __future__ import annotations

from ..realise.reach import Reach
from ..simulate import Sampling
from .assumptions import Assumptions


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
