"""Friction budget: damps a command that supplied more energy than friction is sure to dissipate.

    E' = F_C abs(v) - F v,   F = input - alpha v
    E >= 0:  alpha = 0;      E < 0:  alpha v^2 = -r E, alpha at most the largest damping

This is a passivity controller without a force sensor. It is a stage behind a law that helps the
motion, such as `dahl`, and reads the force and the motion of that law. F_C is the friction that is
counted: never more than the lowest level that can occur (P52). So the friction budget bounds the
mean of the cancelled friction by F_C, whatever force the law before it commands. A law that is
bounded by F_C from the start needs the same number.

In the sampled law the energy of a force that is held over a sample is exact. A delay of the
computer between command and force is not counted.
"""

from sympy import Abs

from ..effects import Parameter
from . import passivity_controller
from ._controller import ControlLaw, ControllerState
from ._law import zero_rate


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
        "counted_level": Parameter("force", "F_C: friction that is counted"),
        **passivity_controller.PARAMETERS,
    },
    source="Hannaford, Ryu, IEEE Trans. Robotics Autom. 18 (2002) 1, friction counted (P52)",
)
