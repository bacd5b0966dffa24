"""Cogging: a force that repeats along the travel.

    F = A sin(2 pi x / p + phi)

Causes are magnets against iron teeth, ball screws and the meshing of gears. Unlike
`position_dependent_friction`, cogging does not depend on the direction of motion. Unlike
`torque_ripple`, cogging does not depend on the command.
"""

from sympy import pi, sin

from ._effect import PERIOD, Effect, FitSearch, Parameter, positive_amplitude
from ._facts import repeats_within_travel


def law(now, p):
    return p.amplitude * sin(2 * pi * now.position / p.period + p.phase)


EFFECT = Effect(
    role="force",
    energy="stores",
    law=law,
    parameters={
        "amplitude": Parameter(
            "force", "A: amplitude", lower=-float("inf"), search=FitSearch(starts=(0.03,))
        ),
        "period": PERIOD,
        "phase": Parameter(
            "angle", "phi: phase at x = 0", lower=-float("inf"), search=FitSearch(starts=(0.0,))
        ),
    },
    absent={"amplitude": 0.0},
    canonical=positive_amplitude,
    plausible=repeats_within_travel,
    source="periodic detent force of a slotted machine, first harmonic",
)
