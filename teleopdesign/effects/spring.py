"""Spring: a force in proportion to position.

    F = K x

Cables, bushings, gravity near the bottom of a pendulum. Counted from the encoder's zero: elsewhere
a spring comes with a `bias`.
"""

from ._effect import Effect, Parameter


def law(now, p):
    return p.stiffness * now.position


EFFECT = Effect(
    role="force",
    energy="stores",
    law=law,
    linear=True,
    parameters={"stiffness": Parameter("stiffness", "K: force per travel")},
    absent={"stiffness": 0.0},
    source="Hooke's law",
)
