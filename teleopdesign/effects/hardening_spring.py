"""Hardening spring: a force with the cube of the way from where it is neutral.

    F = K_3 (x - x_0)^3

Cables and bushings that pull to both ends of their travel; x_0 where neither does. Mistaken for
`spring` where the travel is always the same.
"""

from ._effect import Effect, FitSearch, Parameter


def law(now, p):
    return p.stiffness * (now.position - p.neutral) ** 3


def plausible(p, facts):
    if not len(facts.places) or facts.places.min() <= p.neutral <= facts.places.max():
        return None
    return (
        f"a neutral place at {facts.text(p.neutral, 'position')} lies beyond all that was "
        "travelled: it stands for a spring and a constant force"
    )


EFFECT = Effect(
    role="force",
    energy="stores",
    law=law,
    parameters={
        "stiffness": Parameter("cubic_stiffness", "K_3: force per travel cubed"),
        "neutral": Parameter(
            "position",
            "x_0: where it pulls neither way",
            lower=-float("inf"),
            optional=True,
            search=FitSearch(starts=(-1.0, 0.0, 1.0)),
        ),
    },
    absent={"stiffness": 0.0},
    plausible=plausible,
    source="Duffing's spring without its linear part",
)
