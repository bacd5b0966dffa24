"""Actuator saturation: the force that acts is limited.

    acting force = command, but no more than F_max either way

Supply voltage, current limits. Nothing is seen of it in records whose command stays below F_max.
Friction that flattens with speed is mistaken for it. A force that was measured (`measured = true`
of the channel) has passed all limits.
"""

from sympy import Max, Min

from ._effect import Effect, FitSearch, Parameter

#: multiples of the rms force, from a command that is nearly always cut to one that seldom is
LIMITS = tuple(0.7 * 1.25**k for k in range(9))


def law(now, p):
    return Max(-p.limit, Min(p.limit, now.command))


EFFECT = Effect(
    role="actuation",
    energy="supplies",
    law=law,
    parameters={
        "limit": Parameter("force", "F_max: largest acting force", search=FitSearch(starts=LIMITS))
    },
    absent={"limit": float("inf")},
    source="current limit of an amplifier",
)
