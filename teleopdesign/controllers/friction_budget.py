"""Friction budget: damps a command that has put more energy in than friction is sure to take out.

    E' = F_C abs(v) - F v,   F = input - alpha v
    E >= 0:  alpha = 0;      E < 0:  alpha v^2 = -r E, alpha at most the largest damping

The passivity controller without a force sensor: a stage behind a law that helps the motion, such as
`dahl`, whose force and motion it sees. Friction F_C is counted, never more than the lowest level
that can occur (P52): so it bounds the mean of what is cancelled by F_C, whatever the law before it
asks for, and needs the same number as a law that is bounded by F_C to begin with.

Sampled, the energy of a force held over a sample is exact; a delay of the computer between command
and force is not counted.
"""

from sympy import Abs

from ..effects import Parameter
from . import passivity_controller
from ._controller import ControlLaw, ControllerState
from ._memory import zero_rate


def _power(force, velocity, p):
    """Power that friction dissipates less power that the force supplies, W."""
    return p.counted_level * Abs(velocity) - force * velocity


def law(now, p):
    power = _power(now.input, now.velocity, p)
    return now.input - passivity_controller.damping(now, p, power) * now.velocity


def energy(now, p):
    return passivity_controller.recovery_rate(now, p, _power(law(now, p), now.velocity, p))


def energy_after(now, p):
    power = _power(now.held, now.travel_rate, p)
    return now.energy + now.period * passivity_controller.recovery_rate(now, p, power)


CONTROLLER = ControlLaw(
    law=law,
    takes="force",
    states={
        "energy": ControllerState("energy", energy, energy_after),
        "held": ControllerState("force", zero_rate, law),
    },
    parameters={
        "counted_level": Parameter("force", "F_C: friction that is counted on"),
        **passivity_controller.PARAMETERS,
    },
    source="Hannaford, Ryu, IEEE Trans. Robotics Autom. 18 (2002) 1, friction counted (P52)",
)
