"""Quadratic drag: a force with the square of velocity, against it.

    F = D v abs(v)

Turbulent air or oil, fans, orifices. Felt only at high speed; mistaken for `viscous` where the
speed varies little.
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
