"""Hardening spring: a force in proportion to the cube of the distance from a neutral position.

    F = K_3 (x - x_0)^3

Examples are cables and bushings that pull at both ends of their travel. At x_0 they pull in neither
direction. Where the travel is always the same, the effect looks like `spring`.
"""

from ._effect import Effect, FitSearch, Parameter


def law(now, p):
    return p.stiffness * (now.position - p.neutral) ** 3


def plausible(p, facts):
    if not len(facts.places) or facts.places.min() <= p.neutral <= facts.places.max():
        return None
    return (
        f"a neutral position at {facts.text(p.neutral, 'position')} lies beyond all positions of "
        "the motion: the effect imitates a spring and a constant force"
    )


EFFECT = Effect(
    role="force",
    energy="stores",
    law=law,
    parameters={
        "stiffness": Parameter("cubic_stiffness", "K_3: force per cube of the distance"),
        "neutral": Parameter(
            "position",
            "x_0: neutral position, without force",
            lower=-float("inf"),
            optional=True,
            search=FitSearch(starts=(-1.0, 0.0, 1.0)),
        ),
    },
    absent={"stiffness": 0.0},
    plausible=plausible,
    source="Duffing's spring without its linear part",
)
