"""Energy limit: the largest force that cannot release more than is in an energy tank.

    output = max(input + E_0, 0)/d

Input is what has come into the tank less what has gone out of it, J, E_0 its reserve, d the largest
travel of a sample: a force of at most the output takes no more out before the next sample.
"""

from sympy import Max

from ..effects import Parameter
from ._controller import ControlLaw

#: m or rad; a travel has to be there, and an encoder tells none below
_SHORTEST = 1e-9


def law(now, p):
    return Max(now.input + p.reserve, 0) / p.travel


CONTROLLER = ControlLaw(
    law=law,
    parameters={
        "reserve": Parameter("energy", "E_0: what is in the tank at the start"),
        "travel": Parameter("position", "d: largest travel of a sample", lower=_SHORTEST),
    },
    source="energy tank in the sense of Franken et al., IEEE Trans. Robotics 27 (2011) 741",
)
