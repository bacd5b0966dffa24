"""Hardening spring: a force with the cube of position.

    F = K_3 x^3

Cables and bushings near the end of their travel. Mistaken for `spring` where the travel is always
the same.
"""

from ._effect import Effect, Parameter


def law(now, p):
    return p.stiffness * now.position**3


EFFECT = Effect(
    role="force",
    energy="stores",
    law=law,
    parameters={"stiffness": Parameter("cubic_stiffness", "K_3: force per travel cubed")},
    absent={"stiffness": 0.0},
    source="Duffing's spring without its linear part",
)
