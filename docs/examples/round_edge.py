"""Cancellation of Coulomb friction by a sign function with a round edge.

output = f_D v/sqrt(v_r^2 + v^2)
"""

import sympy as sp

from teleopdesign.controllers import ControlLaw
from teleopdesign.effects import Parameter


def law(now, p):
    return p.level * now.velocity / sp.sqrt(p.edge**2 + now.speed**2)


CONTROLLER = ControlLaw(
    law=law,
    linear=True,  # at a frozen speed
    bound="level",
    parameters={
        "level": Parameter("force", "f_D: largest force"),
        "edge": Parameter("velocity", "v_r: at this velocity, the force is 71 % of f_D"),
    },
)
