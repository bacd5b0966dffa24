"""Torque ripple: the actuator's gain varies along the travel.

    acting force = command (1 + r sin(2 pi x / p + phi))

Causes are commutation and magnets of a motor, and eccentric capstans. Without a command torque
ripple makes no force, unlike `cogging`.
"""

from sympy import pi, sin

from ._effect import PERIOD, Effect, FitSearch, Parameter, positive_amplitude
from ._facts import repeats_within_travel


def law(now, p):
    return now.command * (1 + p.amplitude * sin(2 * pi * now.position / p.period + p.phase))


EFFECT = Effect(
    role="actuation",
    energy="supplies",
    law=law,
    parameters={
        "amplitude": Parameter(
            "dimensionless",
            "r: relative amplitude",
            lower=-1.0,
            upper=1.0,
            search=FitSearch(starts=(0.05,)),
        ),
        "period": PERIOD,
        "phase": Parameter(
            "angle", "phi: phase at x = 0", lower=-float("inf"), search=FitSearch(starts=(0.0,))
        ),
    },
    absent={"amplitude": 0.0},
    canonical=positive_amplitude,
    plausible=repeats_within_travel,
    source="torque constant of a commutated motor, first harmonic",
)
