"""Port energy: the energy that has gone through a port in one direction so far.

    dE/dt = max(s F v, 0),   output = E

The input is the commanded force F on the body at the port. v is the velocity of the motion along
which the force acts. s = 1 counts the energy that the force has supplied to the body, s = -1 the
energy that the force has taken. Each energy only grows. So a reading that arrives late, or is held
where one is lost, is never too large: for this reason a channel sends this energy, not the net
energy. In a computer the force is held from one sample to the next and acts along the travel
between them. So the energy is exact at each sample.
"""

from sympy import Max

from ..effects import Parameter
from ._controller import ControlLaw, ControllerState
from ._law import store_input, zero_rate


def law(now, p):
    return now.energy


def energy(now, p):
    return Max(p.sign * now.input * now.velocity, 0)


def energy_after(now, p):
    return now.energy + now.period * Max(p.sign * now.last * now.travel_rate, 0)


CONTROLLER = ControlLaw(
    law=law,
    takes="force",
    states={
        "energy": ControllerState("energy", energy, energy_after),
        "last": ControllerState("force", zero_rate, store_input),
    },
    parameters={
        "sign": Parameter(
            "dimensionless", "1: supplied to the body; -1: taken", lower=-1.0, upper=1.0
        )
    },
    source="Ryu, Artigas, Preusche, Mechatronics 20 (2010) 812: energies in and out, apart",
)
