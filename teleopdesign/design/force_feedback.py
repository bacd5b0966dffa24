"""The force feedback H that the delay allows: a low-pass with a gain that falls with speed.

At rest, where its gain is greatest, the loop of H between device (m) and load (m_H) is

    k m_H/(m + m_H) / (tau s + 1) e^(-s T_d)

T_d is the sum of the computing delay, of one sample period for holds (half for the command, half
for the error at the input of the sampled low-pass), and of the delay of the identified actuation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..base.sentences import round_down, round_up
from ..base.units import unit_of
from ..controllers import scheduled_force_feedback
from .cancellation import ProposedController, Reason
from .device import Device

#: largest proposed gain: at this gain only a few percent of friction is left
MOST_GAIN = 20.0
#: multiple of the delay that the loop tolerates while the device is held rigidly
HELD_FACTOR = 1.5
#: the scheduling velocity b is at least this multiple of the least one of P13
SCHEDULE_MARGIN = 1.25


@dataclass(frozen=True)
class FeedbackLoop:
    """The loop of H at rest.

    gain: k m_H/(m + m_H);  bandwidth: of the low-pass, Hz;  delay: T_d, s
    """

    gain: float
    bandwidth: float
    delay: float

    @property
    def crossover(self) -> float:
        """Angular frequency at which the loop gain is 1, rad/s; 0 if it is below 1 everywhere."""
        return 2 * math.pi * self.bandwidth * math.sqrt(max(self.gain**2 - 1.0, 0.0))

    @property
    def largest_delay(self) -> float:
        """Delay at the limit of stability, s; inf if the loop is stable with any delay."""
        w = self.crossover
        if w == 0.0:
            return math.inf
        return (math.pi - math.atan(w / (2 * math.pi * self.bandwidth))) / w

    @property
    def phase_margin(self) -> float:
        """Phase margin in degrees; inf if the loop gain never reaches 1."""
        margin = (self.largest_delay - self.delay) * self.crossover
        return math.degrees(margin) if self.crossover else math.inf


def largest_gain(*, share: float, bandwidth: float, delay: float, factor: float) -> float:
    """Largest k at which the loop is stable with `factor` times its delay.

    share: m_H/(m + m_H);  bandwidth: of the low-pass, Hz;  delay: s
    """
    from scipy.optimize import brentq

    def spare(k: float) -> float:
        return FeedbackLoop(k * share, bandwidth, delay).largest_delay - factor * delay

    if spare(MOST_GAIN) >= 0:
        return MOST_GAIN
    # the least k whose loop gain exceeds 1 bears a delay without limit
    return float(brentq(spare, (1 + 1e-9) / share, MOST_GAIN))


def force_feedback(
    device: Device, *, smoothing_velocity: float
) -> tuple[ProposedController, FeedbackLoop]:
    """H for a device with its load, and its loop at rest.

    smoothing_velocity: a of the cancellation beside H, 0: none
    """
    mass, load, assumptions, reach = device.inertia, device.load, device.assumptions, device.reach
    # the command is held for a sample, and so is the error that the low-pass takes in
    delay, axis = device.held_delay, device.body.axis
    share, bandwidth = load / (mass + load), assumptions.bandwidth
    factor = assumptions.delay_factor
    free = largest_gain(share=share, bandwidth=bandwidth, delay=delay, factor=factor)
    held = largest_gain(share=1.0, bandwidth=bandwidth, delay=delay, factor=HELD_FACTOR)
    gain = round_down(min(free, held), digits=2)
    loop = FeedbackLoop(gain * share, bandwidth, delay)
    least = smoothing_velocity * gain / (1 + gain)
    scheduling = round_up(max(SCHEDULE_MARGIN * least, reach.rms_speed), digits=2)
    law = scheduled_force_feedback(gain=gain, scheduling_velocity=scheduling, bandwidth=bandwidth)
    kilo, speed = unit_of("inertia", axis), unit_of("velocity", axis)
    with_load = f"with a load of {load:.3g} {kilo} on {mass:.3g} {kilo} tolerates {factor:g} times"
    rigid = f"held rigidly tolerates {HELD_FACTOR:g} times"
    why = f"the largest whose loop {with_load if free <= held else rigid} its delay of "
    why += f"{1e3 * delay:.3g} ms"
    if gain == MOST_GAIN:
        why = f"no more than {MOST_GAIN:g}; " + why.replace("the largest whose", "its")
    slow = f"b (1 + k) >= a k requires {least:.3g} {speed} (P13)"
    above = f"the recorded rms speed is {reach.rms_speed:.3g} {speed}; {slow}"
    reasons = (
        Reason("velocity_schedule.gain", gain, "1", why),
        Reason("velocity_schedule.scheduling_velocity", scheduling, speed, above),
        Reason("low_pass.bandwidth", bandwidth, "Hz", "assumed; a larger one allows less gain"),
    )
    return ProposedController(law, reasons), loop
