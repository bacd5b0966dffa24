"""Quadratic drag: a force against the motion in proportion to the square of velocity.

    F = D v abs(v)

Causes are turbulent air or oil, fans and orifices. The force matters at high speed only. Where the
speed varies little, the force looks like `viscous`.
"""

from ._effect import Effect, Parameter


def law(now, p):
    return p.drag * now.velocity * abs(now.velocity)


EFFECT = Effect(
    role="force",
    energy="dissipates",
    law=law,
    parameters={"drag": Parameter("drag", "D: force per velocity squared")},
    absent={"drag": 0.0},
    source="drag equation of fluid mechanics",
)
