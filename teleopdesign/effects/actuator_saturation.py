"""Actuator saturation: the acting force has a largest value.

    acting force = command, but no more than F_max either way

Causes are the supply voltage and limits of the current. A record whose command stays below F_max
shows nothing of a saturation. Friction that flattens with speed looks like a saturation. A measured
force (`measured = true` of the channel) has already passed all limits.
"""

from sympy import Max, Min

from ._effect import Effect, FitSearch, Parameter

#: starting values of the limit, over the rms force: from a command that is almost always cut off to
#: a command that seldom is
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
