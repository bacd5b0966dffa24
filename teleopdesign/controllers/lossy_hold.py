"""Lossy hold: where a sample is lost, the output is the last sample that arrived.

    output = input at a sample that arrives, else the output before;   of the first: 0

A share of the samples is lost, by a sequence that looks random and is the same in each run: x' = 4
x (1 - x) with x between 0 and 1. A sample is lost where x < sin^2(pi share/2). Behind a delay the
lossy hold makes delays that jitter. In continuous time nothing is lost.
"""

from sympy import Piecewise, pi, sin

from ..effects import Parameter
from ._controller import ControlLaw, ControllerState
from ._law import zero_rate


def law(now, p):
    if now.period == 0:
        return now.input
    arrives = p.seed + now.chance >= sin(pi * p.share / 2) ** 2
    return Piecewise((now.input, arrives), (now.held, True))


def chance(now, p):
    x = p.seed + now.chance
    return 4 * x * (1 - x) - p.seed


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
    source="zero-order hold of a lossy channel; Ulam, von Neumann (1947) for the sequence",
)
