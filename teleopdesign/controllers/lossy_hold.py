"""Lossy hold: where a sample is lost, the output is the last sample that arrived.

    output = input at a sample that arrives, else the output before;   of the first: 0

A share of the samples is lost, by a sequence that looks random and is the same in each run: whole
numbers x' = 16807 x mod (2^31 - 1), exact in floats. A sample is lost where x is below that share
of 2^31 - 1. The seed gives the first number. Behind a delay the lossy hold makes delays that
jitter. In continuous time nothing is lost.
"""

from sympy import Integer, Piecewise, floor

from ..effects import Parameter
from ._controller import ControlLaw, ControllerState
from ._law import zero_rate

_MANY, _FACTOR = Integer(2**31 - 1), Integer(16807)


def start(p):
    """The first number, from 1 on: the sequence of 0 would stay at 0."""
    return 1 + floor((_MANY - 2) * p.seed)


def law(now, p):
    if now.period == 0:
        return now.input
    arrives = start(p) + now.chance >= p.share * _MANY
    return Piecewise((now.input, arrives), (now.held, True))


def chance(now, p):
    """The next number, less the first one: a state begins at zero."""
    x = _FACTOR * (start(p) + now.chance)
    return x - _MANY * floor(x / _MANY) - start(p)


CONTROLLER = ControlLaw(
    law=law,
    states={
        "held": ControllerState("force", zero_rate, law),
        "chance": ControllerState("dimensionless", zero_rate, chance),
    },
    parameters={
        "share": Parameter("dimensionless", "share of the samples that are lost", upper=1.0),
        "seed": Parameter("dimensionless", "start of the sequence, 0 to 1", upper=1.0),
    },
    source="zero-order hold of a lossy channel; Park, Miller, Commun. ACM 31 (1988) 1192",
)
