"""Stops: stiff springs beyond both ends of the travel.

    F = K (max(x - x_2, 0) + min(x - x_1, 0)),   x_1 < x_2

Examples are rubber buffers and the ends of a slot. A record shows an end only if the motion reaches
it. A force that begins gradually is `hardening_spring`; an environment that the model states is no
stop.
"""

from sympy import Max, Min

from ._effect import Effect, FitSearch, Parameter


def law(now, p):
    return p.stiffness * (Max(now.position - p.upper, 0) + Min(now.position - p.lower, 0))


def plausible(p, facts):
    if p.upper <= p.lower:
        return "its ends are in the wrong order: the effect imitates a spring"
    if not len(facts.places) or facts.places.min() < p.lower or facts.places.max() > p.upper:
        return None
    return "no motion reaches either end: the records show nothing of the effect"


EFFECT = Effect(
    role="force",
    energy="stores",
    law=law,
    parameters={
        "stiffness": Parameter("stiffness", "K: of the stops"),
        "lower": Parameter(
            "position",
            "x_1: end towards negative positions",
            lower=-float("inf"),
            search=FitSearch(starts=(-1.2,)),
        ),
        "upper": Parameter(
            "position",
            "x_2: end towards positive positions",
            lower=-float("inf"),
            search=FitSearch(starts=(1.2,)),
        ),
    },
    absent={"stiffness": 0.0},
    plausible=plausible,
    source="one-sided springs",
)
