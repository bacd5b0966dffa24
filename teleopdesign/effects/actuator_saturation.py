"""Actuator saturation: the force that acts is limited.

    acting force = command, but no more than F_max either way

Supply voltage, current limits. Nothing is seen of it in records whose command stays below F_max.
"""

from sympy import Max, Min

from ._effect import Effect, Parameter


def law(now, p):
    return Max(-p.limit, Min(p.limit, now.command))


EFFECT = Effect(
    role="actuation",
    law=law,
    parameters={"limit": Parameter("force", "F_max: largest acting force", starts=(0.7, 1.2, 2.0))},
    absent={"limit": float("inf")},
    source="current limit of an amplifier",
)
