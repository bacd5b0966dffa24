"""Passivity controller: a damper that acts once more energy has come out of a port than went in.

    E' = -F v,   output = -alpha v
    E >= 0:  alpha = 0;      E < 0:  alpha v^2 = -r E, alpha at most the largest damping

The input is the measured force of the device ON the hand or the body that holds the device, R_M of
the haptic interface. The damper acts along the motion of the same port, so a law of one input knows
force and velocity of the port. E includes the energy that the device itself takes, also by friction
that no model has. E is kept at most at `budget`: energy that went in long ago permits no later
release. While E >= 0, the law does nothing at all.

In the sampled law energy is integrated by trapezia. The energy of the coming sample is predicted
with force and velocity of the last sample. With r far above the sampling rate a deficit is
recovered within one sample, as in Hannaford and Ryu. The kinetic energy of the device must first go
in through the port, so its return is no excess.
"""

from sympy import Max, Min, exp

from ..effects import Parameter
from ._controller import ControlLaw, ControllerState
from ._law import store_input, zero_rate

_STANDSTILL = 1e-30  # (m/s)^2: alpha stays finite there, and acts on no velocity


def _recovery_share(now, p):
    """Share of an energy deficit that is recovered within a sample, per second."""
    if now.period == 0:
        return p.recovery_rate
    return (1 - exp(-p.recovery_rate * now.period)) / now.period


def damping(now, p, power):
    """Damping alpha for the energy `now.energy`, to which the port adds this power, W."""
    ahead = now.energy + now.period * power
    needed = Max(-ahead, 0) * _recovery_share(now, p) / Max(now.velocity**2, _STANDSTILL)
    return Min(needed, p.largest_damping)


def recovery_rate(now, p, power):
    """Rate of an energy that returns to its budget no faster than a deficit is recovered, W."""
    return Min(power, _recovery_share(now, p) * (p.budget - now.energy))


def law(now, p):
    return -damping(now, p, -now.input * now.velocity) * now.velocity


def energy(now, p):
    return recovery_rate(now, p, -now.input * now.velocity)


def energy_after(now, p):
    power = -(now.input + now.last) / 2 * now.travel_rate
    return now.energy + now.period * recovery_rate(now, p, power)


PARAMETERS = {
    "budget": Parameter("energy", "largest energy that is kept for later"),
    "recovery_rate": Parameter("frequency", "r: rate at which a deficit is recovered, 1/s"),
    "largest_damping": Parameter("damping", "largest alpha"),
}
CONTROLLER = ControlLaw(
    law=law,
    takes="force",
    states={
        "energy": ControllerState("energy", energy, energy_after),
        "last": ControllerState("force", zero_rate, store_input),
    },
    parameters=PARAMETERS,
    source="Hannaford, Ryu, IEEE Trans. Robotics Autom. 18 (2002) 1 (P52)",
)
