"""Energy limit: the largest force that cannot release more energy than an energy tank holds.

    output = max(input + E_0, 0)/d

The input is the energy that came into the tank less the energy that went out, in J. E_0 is the
reserve of the tank, and d is the largest travel of a sample. A force of at most the output releases
no more energy than the tank holds before the next sample.
"""

from sympy import Max

from ..effects import Parameter
from ._controller import ControlLaw

#: m or rad: least travel, which must not be zero; no encoder resolves less
_SHORTEST = 1e-9


def law(now, p):
    return Max(now.input + p.reserve, 0) / p.travel


CONTROLLER = ControlLaw(
    law=law,
    parameters={
        "reserve": Parameter("energy", "E_0: energy in the tank at the start"),
        "travel": Parameter("position", "d: largest travel of a sample", lower=_SHORTEST),
    },
    source="energy tank in the sense of Franken et al., IEEE Trans. Robotics 27 (2011) 741",
)
