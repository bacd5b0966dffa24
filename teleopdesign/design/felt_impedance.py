"""The impedance that a hand feels of the designed device, predicted and simulated.

The first harmonic of the force error over the motion, Zhat_M, along sinusoids of the stated peak
speed, at the stated frequency and above: by describing functions, and by a simulation of all
identified effects with sampling and delay.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..base.errors import ModelError
from ..diagrams import Diagram, four_cases
from ..frequency import (
    ImpedanceMap,
    ParameterCovariance,
    measured_impedance,
    quasi_linear_impedance,
)
from ..realise.tips import led_motion
from ..simulate import Sampling
from .stated_motion import StatedMotion

#: multiples of the stated frequency that are computed, and their upper limit as a part of the
#: sample rate
MULTIPLES, MOST = (1.0, 2.0, 5.0, 10.0), 0.05


@dataclass(frozen=True)
class FeltImpedance:
    """Zhat_M of the four cases; None where it could not be computed.

    simulated: measured in simulation
    predicted: by describing functions, with continuous controllers, and the band of the estimates
    missing: the reason for each None
    """

    simulated: ImpedanceMap | None
    predicted: ImpedanceMap | None
    missing: tuple[str, ...]


def felt_impedance(
    hybrid: Diagram, motion: StatedMotion, sampling: Sampling, covariance: ParameterCovariance
) -> FeltImpedance:
    """Zhat_M of the device without and with compensation at the stated peak speed.

    hybrid: a device with C and H (either may be absent), without a hand
    covariance: of the device's estimates; without names no band is known
    """
    cases = four_cases(hybrid, every=True)
    wanted = motion.frequency * np.array(MULTIPLES)
    wanted = wanted[wanted <= max(MOST / sampling.period, motion.frequency)]
    # whole samples a cycle, and readings without steps: every cycle is like the one before
    frequency = 1 / (sampling.period * np.round(1 / (sampling.period * wanted)))
    smooth = replace(sampling, encoder_step=0.0)
    missing: list[str] = []

    def amplitude(f: np.ndarray) -> np.ndarray:
        return np.asarray(motion.amplitude * motion.frequency / f)

    simulated = predicted = None
    if led_motion(hybrid, "L") != "L":
        # friction that deflects by 1e-5 of the motion, behind a spring: millions of steps
        return FeltImpedance(None, None, ("through a transmission it takes too many steps",))
    try:
        simulated = measured_impedance(
            cases, amplitude=amplitude, frequency=frequency, computer=smooth
        )
    except ModelError as error:
        missing.append(f"simulation: {error}")
    try:
        predicted = quasi_linear_impedance(
            cases,
            amplitude=amplitude,
            frequency=frequency,
            covariance=covariance if covariance.names else None,
        )
    except ModelError as error:
        missing.append(f"describing functions: {error}")
    return FeltImpedance(simulated, predicted, tuple(missing))
